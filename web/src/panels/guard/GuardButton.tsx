import { createEffect } from "solid-js";
import { useStation } from "../../console";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import type { Role } from "../../protocol";
import { text } from "../../text/catalogue";
import "./guard.css";

/** Hold time for actions that cannot be reversed at once. */
export const GUARD_MS = 1500;
/** Hold time for reversible actions: longer than an accidental touch. */
export const BRIEF_MS = 400;

/** A button that acts after being held for its time while its subject stays the same. */
export function GuardButton(props: {
  label: string;
  /** What the label excludes, such as the vehicle's name; follows it in the accessible name. */
  of?: string;
  hold_ms: number;
  /** Changes whenever the button's action changes; empty disables it. */
  subject: string;
  class?: string;
  /** The role that the action needs. */
  needs?: Role;
  onConfirm: () => void;
}) {
  const { clock, lacks, isReplay } = useStation();
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
  const hint = () => {
    if (lack() !== null)
      return isReplay()
        ? text.guard.replay
        : text.guard.needs(text.roles[props.needs ?? "operator"]);
    return holdHint(props.hold_ms);
  };
  return (
    <button
      type="button"
      class={`button guard ${props.class ?? ""}`}
      classList={{ "is-holding": timer.kind() === "holding" }}
      aria-disabled={isDisabled()}
      aria-label={buttonName(props.label, hint(), props.of)}
      title={lack() ?? undefined}
      aria-description={lack() ?? undefined}
      style={{ "--held": timer.progress() }}
      {...holdHandlers(timer, isDisabled)}
    >
      {props.label} <small class="guard-hint">{hint()}</small>
    </button>
  );
}

/** How a button is confirmed: `hold 1.5 s`; null when a press is enough. */
export function holdHint(hold_ms: number): string | null {
  if (hold_ms === 0) return null;
  return hold_ms < 1000 ? text.guard.holdBriefly : text.guard.hold(`${hold_ms / 1000} s`);
}

/**
 * An accessible name that begins with what the button shows, so that speaking that presses it: `Land, hold 1.5 s:
 * 2 Birch`.
 */
export function buttonName(label: string, hint: string | null, of?: string): string {
  const shown = hint === null ? label : `${label}, ${hint}`;
  return of === undefined ? shown : `${shown}: ${of}`;
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
