import { type Accessor, createSignal, onCleanup } from "solid-js";
import type { Clock } from "../source/clock";

/**
 * Hold to confirm, as a pure state machine.
 *
 *   idle --press--> holding --held for duration_ms--> done
 *   idle --press of an order that needs one press only--> done
 *   holding, done --release or cancel--> idle
 *   holding --the target vehicles changed--> idle
 *
 * The order is sent on entering `done`, once. A press is ignored outside `idle`, so key repeats and
 * double presses change nothing. Time is counted in ticks of at most `MAX_TICK_MS`: when the page
 * stalls, a release may be waiting in the event queue, and the stalled time must not confirm the order.
 */

/** Longest time one tick may add to a hold, milliseconds. */
export const MAX_TICK_MS = 100;

export type Hold =
  | { readonly kind: "idle" }
  | {
      readonly kind: "holding";
      /** Time held so far. */
      readonly held_ms: number;
      readonly last_tick_ms: number;
      readonly duration_ms: number;
      readonly targets: string;
    }
  | { readonly kind: "done" };

export type HoldEvent =
  /** `targets` identifies the target vehicles; it changes when they do and is empty without any. */
  | { readonly kind: "press"; readonly duration_ms: number; readonly targets: string }
  | { readonly kind: "release" }
  | { readonly kind: "cancel" }
  | { readonly kind: "tick"; readonly targets: string };

export const IDLE: Hold = { kind: "idle" };

/** Returns the state after `event`; the caller sends the order when it becomes `done`. */
export function stepHold(hold: Hold, event: HoldEvent, now_ms: number): Hold {
  switch (event.kind) {
    case "press":
      if (hold.kind !== "idle" || event.targets === "") return hold;
      if (event.duration_ms <= 0) return { kind: "done" };
      return {
        kind: "holding",
        held_ms: 0,
        last_tick_ms: now_ms,
        duration_ms: event.duration_ms,
        targets: event.targets,
      };
    case "release":
    case "cancel":
      return IDLE;
    case "tick":
      return hold.kind === "holding" ? addHeldTime(hold, event.targets, now_ms) : hold;
  }
}

function addHeldTime(hold: Hold & { kind: "holding" }, targets: string, now_ms: number): Hold {
  if (targets !== hold.targets) return IDLE;
  const held_ms = hold.held_ms + Math.min(MAX_TICK_MS, now_ms - hold.last_tick_ms);
  if (held_ms >= hold.duration_ms) return { kind: "done" };
  return { ...hold, held_ms, last_tick_ms: now_ms };
}

/** The held share of the duration, 0 to 1. */
export function holdProgress(hold: Hold): number {
  if (hold.kind === "idle") return 0;
  return hold.kind === "done" ? 1 : Math.min(1, hold.held_ms / hold.duration_ms);
}

/** Tick interval while a button is held; also the update rate of its progress bar. */
const TICK_MS = 50;

/** The hold state machine driven by a clock. */
export interface HoldTimer {
  readonly kind: Accessor<Hold["kind"]>;
  /** 0 to 1. */
  readonly progress: Accessor<number>;
  press(): void;
  release(): void;
  cancel(): void;
}

/**
 * Creates a timer that calls `confirm` once when the hold completes. `targets` is read at the press and
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
