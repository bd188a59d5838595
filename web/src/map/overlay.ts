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

export function createOverlay(): Overlay {
  const [kind, show] = createSignal<OverlayKind>("none");
  const [lead_s, lookAhead] = createSignal(0);
  return { kind, lead_s, show, lookAhead };
}
