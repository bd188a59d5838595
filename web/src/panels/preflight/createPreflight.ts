import { type Accessor, createSignal, onCleanup } from "solid-js";
import type { PreflightView } from "../../protocol";
import type { Clock } from "../../source/clock";
import type { Outcome, StationSource } from "../../source/stationSource";

/** The checklist is worked out anew by the station each time it is asked. */
const ASK_EVERY_MS = 2000;

/** A vehicle's checklist, kept fresh for as long as it is looked at. */
export interface Preflight {
  /** The newest answer; null before the first. */
  readonly answer: Accessor<Outcome<PreflightView> | null>;
  ask(): Promise<void>;
}

export function createPreflight(
  source: Pick<StationSource, "preflight">,
  clock: Clock,
  serial: string,
): Preflight {
  const [answer, setAnswer] = createSignal<Outcome<PreflightView> | null>(null);
  let newest = 0;
  let isGone = false;
  let cancel = () => {};
  const ask = async () => {
    newest += 1;
    const own = newest;
    const outcome = await source.preflight(serial);
    if (isGone || own !== newest) return;
    setAnswer(outcome);
    cancel();
    cancel = clock.after(ASK_EVERY_MS, () => void ask());
  };
  void ask();
  onCleanup(() => {
    isGone = true;
    cancel();
  });
  return { answer, ask };
}
