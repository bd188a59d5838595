import { createEffect } from "solid-js";
import { useConsole } from "../../console";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import "./guard.css";

/** How long a button is held for what cannot be taken back at once. */
export const GUARD_MS = 1500;
/** How long for what can: longer than a brush of the hand, shorter than a thought. */
export const BRIEF_MS = 400;

/** A button that acts when it was held for its time on one and the same subject. */
export function GuardButton(props: {
  label: string;
  /** Read in place of the label, such as with the vehicle's name; how long to hold is added. */
  name?: string;
  hold_ms: number;
  /** Changes whenever the button would do something else; empty when it can do nothing now. */
  subject: string;
  class?: string;
  onConfirm: () => void;
}) {
  const { clock } = useConsole();
  const timer = createHoldTimer(
    clock,
    // A button's time is fixed where it is written; it never changes while it stands.
    (() => props.hold_ms)(),
    () => props.subject,
    () => props.onConfirm(),
  );
  const isDisabled = () => props.subject === "";
  createEffect(() => {
    if (isDisabled()) timer.cancel();
  });
  const seconds = () => props.hold_ms / 1000;
  return (
    <button
      type="button"
      class={`button guard ${props.class ?? ""}`}
      classList={{ "is-holding": timer.kind() === "holding" }}
      aria-disabled={isDisabled()}
      aria-label={`${props.name ?? props.label}: hold for ${seconds()} seconds`}
      style={{ "--held": timer.progress() }}
      {...holdHandlers(timer, isDisabled)}
    >
      {props.label}
      <small class="guard-hint">{seconds() < 1 ? "hold briefly" : `hold ${seconds()} s`}</small>
    </button>
  );
}

const HOLD_KEYS = [" ", "Enter"];

/** What makes a button act only when it is held, by pointer or keyboard; sliding off or Esc ends it. */
export function holdHandlers(timer: HoldTimer, isDisabled: () => boolean) {
  return {
    onPointerDown: (event: PointerEvent) => {
      if (event.button === 0 && !isDisabled()) timer.press();
    },
    onPointerUp: () => timer.release(),
    onPointerLeave: () => timer.cancel(),
    onPointerCancel: () => timer.cancel(),
    onContextMenu: (event: Event) => event.preventDefault(),
    onKeyDown: (event: KeyboardEvent) => {
      if (event.key === "Escape") timer.cancel();
      if (!HOLD_KEYS.includes(event.key)) return;
      event.preventDefault();
      if (!event.repeat && !isDisabled()) timer.press();
    },
    onKeyUp: (event: KeyboardEvent) => {
      if (HOLD_KEYS.includes(event.key)) timer.release();
    },
    onBlur: () => timer.cancel(),
  };
}
