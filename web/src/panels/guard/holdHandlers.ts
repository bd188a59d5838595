import type { HoldTimer } from "../../orders/holdTimer";

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
