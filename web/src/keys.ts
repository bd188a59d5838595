import { isEditingNumber, isTyping } from "./panels/orders/shortcuts";

/** Actions bound to keys. */
export interface KeyActions {
  selectOnly(number: number): void;
  toggle(number: number): void;
  selectAll(): void;
  clear(): void;
  fit(): void;
  flyHere(): void;
  drawMission(): void;
  details(): void;
  drawZone(): void;
  undo(): void;
  redo(): void;
  toggleTheme(): void;
  help(): void;
}

/** Runs the action of a key press; returns false for a key without one. */
export function actOnKey(event: KeyboardEvent, actions: KeyActions): boolean {
  const action = actionOf(event, actions);
  if (action === null) return false;
  event.preventDefault();
  action();
  return true;
}

/**
 * All stop works whatever has the focus. Only where letters are typed Shift+S types an S, and Alt is
 * added: a chord with a modifier more is the usual way past a text field. Listen for it in the capture
 * phase, which no element can end.
 */
export function isAllStop(event: KeyboardEvent): boolean {
  const isS = event.code === "KeyS" || event.key.toLowerCase() === "s";
  if (!isS || !event.shiftKey || event.ctrlKey || event.metaKey || event.repeat) return false;
  return event.altKey || !isTyping(event);
}

function actionOf(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  if (isTyping(event) || event.altKey) return null;
  // A number field keeps its digits, its arrows and Ctrl+A; a letter in it is a slip of the hand.
  if (isEditingNumber(event)) return event.key === "Escape" ? actions.clear : null;
  if (event.ctrlKey || event.metaKey) {
    return modifiedAction(event, actions);
  }
  // Ignore key repeat.
  if (event.repeat) return null;
  if (event.key === "?") return actions.help;
  const number = digitOf(event.code);
  if (number !== null) {
    return () => (event.shiftKey ? actions.toggle(number) : actions.selectOnly(number));
  }
  if (event.shiftKey) return null;
  return plainAction(event, actions);
}

function modifiedAction(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  // The letters, not their places: Z and Y change places between keyboards.
  const key = event.key.toLowerCase();
  if (key === "z") return event.shiftKey ? actions.redo : actions.undo;
  if (key === "y" && !event.shiftKey) return actions.redo;
  return event.code === "KeyA" && !event.shiftKey ? actions.selectAll : null;
}

function plainAction(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  switch (event.key.toLowerCase()) {
    case "escape":
      return actions.clear;
    case "f":
      return actions.fit;
    case "g":
      return actions.flyHere;
    case "m":
      return actions.drawMission;
    case "d":
      return actions.details;
    case "z":
      return actions.drawZone;
    case "t":
      return actions.toggleTheme;
    default:
      return null;
  }
}

function digitOf(code: string): number | null {
  const match = /^(?:Digit|Numpad)([1-9])$/.exec(code);
  return match?.[1] === undefined ? null : Number(match[1]);
}
