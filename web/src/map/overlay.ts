import { type Accessor, createSignal } from "solid-js";

/** What lies over the ground image: one at a time, so that each can be read. */
export type OverlayKind = "none" | "shade" | "forecast" | "cells";

/** Which overlay the map shows, and for which lead. */
export interface Overlay {
  readonly kind: Accessor<OverlayKind>;
  /** How far ahead the forecast is shown, seconds from its shade map. */
  readonly lead_s: Accessor<number>;
  show(kind: OverlayKind): void;
  lookAhead(lead_s: number): void;
}

/** Until somebody chooses, a survey that is flown shows its cells: they are what is flown for. */
export function createOverlay(isSurveyFlown: Accessor<boolean> = () => false): Overlay {
  const [chosen, show] = createSignal<OverlayKind | null>(null);
  const [lead_s, lookAhead] = createSignal(0);
  return {
    kind: () => chosen() ?? (isSurveyFlown() ? "cells" : "none"),
    lead_s,
    show: (kind) => {
      show(kind);
    },
    lookAhead,
  };
}
