import { type Accessor, createSignal, onCleanup } from "solid-js";
import type { Clock } from "../source/clock";
import { type Hold, type HoldEvent, holdProgress, IDLE, stepHold } from "./hold";

/** How often a held button is looked at; also how smoothly its bar grows. */
const TICK_MS = 50;

/** Drives the hold machine with a clock. */
export interface HoldTimer {
  readonly kind: Accessor<Hold["kind"]>;
  /** 0 to 1. */
  readonly progress: Accessor<number>;
  press(): void;
  release(): void;
  cancel(): void;
}

/**
 * Makes a timer that calls `confirm` once when the hold is through. `targets` is read at the press and
 * at every tick.
 */
export function createHoldTimer(
  clock: Clock,
  duration_ms: number,
  targets: () => string,
  confirm: () => void,
): HoldTimer {
  let hold: Hold = IDLE;
  let cancelTick = () => {};
  const [kind, setKind] = createSignal<Hold["kind"]>("idle");
  const [progress, setProgress] = createSignal(0);
  const step = (event: HoldEvent) => {
    const now_ms = clock.now().monotonicMs;
    const before = hold;
    hold = stepHold(hold, event, now_ms);
    setKind(hold.kind);
    setProgress(holdProgress(hold));
    cancelTick();
    if (hold.kind === "holding") cancelTick = clock.after(TICK_MS, tick);
    if (hold.kind === "done" && before.kind !== "done") confirm();
  };
  const tick = () => step({ kind: "tick", targets: targets() });
  onCleanup(() => cancelTick());
  return {
    kind,
    progress,
    press: () => step({ kind: "press", duration_ms, targets: targets() }),
    release: () => step({ kind: "release" }),
    cancel: () => step({ kind: "cancel" }),
  };
}
