/**
 * Hold to confirm: a pure machine. An order goes out only when the button was held, without a break,
 * for its whole time, on the same vehicles as when it was pressed.
 */

/** If the page stood still for longer than this while a button was held, a release may have been missed. */
export const STALL_MS = 400;

export type Hold =
  | { readonly kind: "idle" }
  | {
      readonly kind: "holding";
      readonly since_ms: number;
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
        since_ms: now_ms,
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
  const hasChanged = targets !== hold.targets;
  const hasStalled = now_ms - hold.seen_ms > STALL_MS;
  if (hasChanged || hasStalled) return IDLE;
  if (now_ms - hold.since_ms >= hold.duration_ms) return { kind: "done" };
  return { ...hold, seen_ms: now_ms };
}

/** How much of the time is through, 0 to 1. */
export function holdProgress(hold: Hold, now_ms: number): number {
  if (hold.kind === "idle") return 0;
  if (hold.kind === "done") return 1;
  return Math.min(1, Math.max(0, (now_ms - hold.since_ms) / hold.duration_ms));
}
