import type { HoldTimer } from "../../orders/holdToConfirm";

/** A key that, held with Shift, holds an order's button. */
export interface HeldKey {
  readonly key: string;
  readonly timer: Pick<HoldTimer, "press" | "release" | "cancel">;
}

/**
 * Makes Shift and a key act like holding the button; releasing either or leaving the page cancels.
 * Returns a function that removes the listeners.
 */
export function holdByKey(page: Window, keys: readonly HeldKey[]): () => void {
  const onDown = (event: KeyboardEvent) => {
    if (event.key === "Escape") for (const { timer } of keys) timer.cancel();
    const isPlainShift = event.shiftKey && !event.ctrlKey && !event.altKey && !event.metaKey;
    if (!isPlainShift || event.repeat || isTyping(event)) return;
    keys.find(({ key }) => event.code === `Key${key}`)?.timer.press();
  };
  const onUp = (event: KeyboardEvent) => {
    for (const { key, timer } of keys) {
      if (event.key === "Shift" || event.code === `Key${key}`) timer.release();
    }
  };
  const onBlur = () => {
    for (const { timer } of keys) timer.cancel();
  };
  page.addEventListener("keydown", onDown);
  page.addEventListener("keyup", onUp);
  page.addEventListener("blur", onBlur);
  return () => {
    page.removeEventListener("keydown", onDown);
    page.removeEventListener("keyup", onUp);
    page.removeEventListener("blur", onBlur);
  };
}

/** Input types into which no letters are typed. */
const NO_LETTERS = [
  "button",
  "checkbox",
  "color",
  "file",
  "number",
  "radio",
  "range",
  "reset",
  "submit",
];

/** Whether the event is input to a field in which letters are typed. */
export function isTyping(event: KeyboardEvent): boolean {
  const target = event.target;
  if (!(target instanceof HTMLElement)) return false;
  if (target.isContentEditable || target instanceof HTMLTextAreaElement) return true;
  return target instanceof HTMLInputElement && !NO_LETTERS.includes(target.type);
}

/** Whether the event is input to a number field. */
export function isEditingNumber(event: KeyboardEvent): boolean {
  return event.target instanceof HTMLInputElement && event.target.type === "number";
}
