import { type Accessor, createComputed, createSignal } from "solid-js";
import type { StationState } from "../protocol";
import type { StationSource } from "../source/stationSource";
import { type AnnouncedFrame, FrameOnScreen, type ShownFrame } from "./frameOnScreen";

/** `FrameOnScreen` for a part of the page. */
export interface FrameTracker {
  readonly facts: Accessor<ShownFrame | null>;
  /** Changes when the station was started anew. */
  readonly run: Accessor<number>;
  show(id: number | null): void;
  clear(): void;
}

/** Follows the source's states; `announced` finds in each the frame this part of the page shows. */
export function createFrameOnScreen(
  source: Pick<StationSource, "state">,
  announced: (state: StationState) => AnnouncedFrame | null,
): FrameTracker {
  const frame = new FrameOnScreen();
  const [facts, setFacts] = createSignal<ShownFrame | null>(null);
  const [run, setRun] = createSignal(0);
  createComputed(() => {
    const state = source.state();
    if (state === null) return;
    frame.hear(state, announced(state));
    setRun(frame.run);
    setFacts(frame.facts());
  });
  return {
    facts,
    run,
    show: (id) => {
      frame.show(id);
      setFacts(frame.facts());
    },
    clear: () => {
      frame.clear();
      setFacts(null);
    },
  };
}
