import { type Accessor, createSignal, onCleanup } from "solid-js";
import type { Clock } from "../source/clock";

/**
 * Hold to confirm: a pure machine. An order goes out only when the button was held, without a break,
 * for its whole time, on the same vehicles as when it was pressed.
 */

/**
 * The most that one look at the button counts for. While a busy page stands still, a release may wait
 * unseen; that time does not count, and the release is heard before the rest of the hold is through.
 */
export const MOST_COUNTED_MS = 100;

export type Hold =
  | { readonly kind: "idle" }
  | {
      readonly kind: "holding";
      /** Time that was seen to be held. */
      readonly held_ms: number;
      readonly seen_ms: number;
      readonly duration_ms: number;
      readonly targets: string;
    }
  | { readonly kind: "done" };

export type HoldEvent =
  /** `targets` names the vehicles in any way that changes when they do. */
  | { readonly kind: "press"; readonly duration_ms: number; readonly targets: string }
  | { readonly kind: "release" }
  | { readonly kind: "cancel" }
  | { readonly kind: "tick"; readonly targets: string };

export const IDLE: Hold = { kind: "idle" };

/** One step. The order is given exactly when the kind becomes `done`; after that only a release starts over. */
export function stepHold(hold: Hold, event: HoldEvent, now_ms: number): Hold {
  switch (event.kind) {
    case "press":
      if (hold.kind !== "idle" || event.targets === "") return hold;
      return {
        kind: "holding",
        held_ms: 0,
        seen_ms: now_ms,
        duration_ms: event.duration_ms,
        targets: event.targets,
      };
    case "release":
    case "cancel":
      return IDLE;
    case "tick":
      return hold.kind === "holding" ? heldOn(hold, event.targets, now_ms) : hold;
  }
}

function heldOn(hold: Hold & { kind: "holding" }, targets: string, now_ms: number): Hold {
  if (targets !== hold.targets) return IDLE;
  const held_ms = hold.held_ms + Math.min(MOST_COUNTED_MS, now_ms - hold.seen_ms);
  if (held_ms >= hold.duration_ms) return { kind: "done" };
  return { ...hold, held_ms, seen_ms: now_ms };
}

/** How much of the time is through, 0 to 1. */
export function holdProgress(hold: Hold): number {
  if (hold.kind === "idle") return 0;
  return hold.kind === "done" ? 1 : Math.min(1, hold.held_ms / hold.duration_ms);
}

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
