import { createEffect } from "solid-js";
import { useConsole } from "../../console";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import type { Role } from "../../source/roles";
import "./guard.css";

/** Hold time for actions that cannot be reversed at once. */
export const GUARD_MS = 1500;
/** Hold time for reversible actions: longer than an accidental touch. */
export const BRIEF_MS = 400;

/** A button that acts after being held for its time while its subject stays the same. */
export function GuardButton(props: {
  label: string;
  /** Accessible name in place of the label, such as with the vehicle's name; the hold time is appended. */
  name?: string;
  hold_ms: number;
  /** Changes whenever the button's action changes; empty disables it. */
  subject: string;
  class?: string;
  /** The role that the action needs. */
  needs?: Role;
  onConfirm: () => void;
}) {
  const { clock, lacks, isReplay } = useConsole();
  const lack = () => lacks(props.needs ?? "operator");
  const timer = createHoldTimer(
    clock,
    // The hold time never changes during the button's life.
    (() => props.hold_ms)(),
    () => props.subject,
    () => props.onConfirm(),
  );
  const isDisabled = () => props.subject === "" || lack() !== null;
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
      title={lack() ?? undefined}
      aria-description={lack() ?? undefined}
      style={{ "--held": timer.progress() }}
      {...holdHandlers(timer, isDisabled)}
    >
      {props.label}
      <small class="guard-hint" aria-hidden="true">
        {lack() !== null
          ? isReplay()
            ? "replay"
            : `needs ${props.needs ?? "operator"}`
          : seconds() < 1
            ? "hold briefly"
            : `hold ${seconds()} s`}
      </small>
    </button>
  );
}

const HOLD_KEYS = [" ", "Enter"];

/** Event handlers for hold to confirm, by pointer or keyboard; sliding off or Esc cancels. */
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
