import { isTyping } from "./panels/orders/shortcuts";

/** The page's keys as the help shows them. */
export const SHORTCUTS: readonly { readonly keys: string; readonly does: string }[] = [
  { keys: "Shift + S", does: "ALL STOP: everything that flies holds, at once" },
  { keys: "Shift + H, held", does: "Hover the selected vehicles (0.4 s)" },
  { keys: "Shift + R, held", does: "Return the selected vehicles home (1.5 s)" },
  { keys: "Shift + L, held", does: "Land the selected vehicles (1.5 s)" },
  { keys: "1 to 9", does: "Select that vehicle alone" },
  { keys: "Shift + 1 to 9", does: "Add that vehicle, or take it out" },
  { keys: "Ctrl + A", does: "Select all vehicles" },
  { keys: "G", does: "Fly here: say on the map where the one selected vehicle is to fly" },
  {
    keys: "Esc",
    does: "Clear the target, leave fly here, select none; while holding, give no order",
  },
  { keys: "F", does: "Fit everything into the map" },
  { keys: "T", does: "High contrast for bright sun, and back" },
  { keys: "?", does: "This help" },
];

/** What keys can do to the page. */
export interface KeyActions {
  allStop(): void;
  selectOnly(number: number): void;
  toggle(number: number): void;
  selectAll(): void;
  clear(): void;
  fit(): void;
  flyHere(): void;
  toggleTheme(): void;
  help(): void;
}

/** Acts on one key press; says whether the key was one of the page's. */
export function actOnKey(event: KeyboardEvent, actions: KeyActions): boolean {
  if (isTyping(event) || event.altKey) return false;
  const action = actionOf(event, actions);
  if (action === null) return false;
  event.preventDefault();
  action();
  return true;
}

function actionOf(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  if (event.ctrlKey || event.metaKey) {
    return event.code === "KeyA" && !event.shiftKey ? actions.selectAll : null;
  }
  // A held key must not repeat what it did.
  if (event.repeat) return null;
  if (event.key === "?") return actions.help;
  const number = digitOf(event.code);
  if (number !== null) {
    return () => (event.shiftKey ? actions.toggle(number) : actions.selectOnly(number));
  }
  if (event.shiftKey) return event.code === "KeyS" ? actions.allStop : null;
  return plainAction(event, actions);
}

function plainAction(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  switch (event.key.toLowerCase()) {
    case "escape":
      return actions.clear;
    case "f":
      return actions.fit;
    case "g":
      return actions.flyHere;
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
