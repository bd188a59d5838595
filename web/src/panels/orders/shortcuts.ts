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
  // While the event goes down: no element can keep a key from the page.
  page.addEventListener("keydown", onDown, { capture: true });
  page.addEventListener("keyup", onUp, { capture: true });
  page.addEventListener("blur", onBlur);
  return () => {
    page.removeEventListener("keydown", onDown, { capture: true });
    page.removeEventListener("keyup", onUp, { capture: true });
    page.removeEventListener("blur", onBlur);
  };
}

/** Input types into which text is typed; every other type takes no letters. */
const TEXT_TYPES = ["email", "password", "search", "tel", "text", "url"];

/** Whether the event is input to a field in which letters are typed. */
export function isTyping(event: KeyboardEvent): boolean {
  const target = event.target;
  if (!(target instanceof HTMLElement)) return false;
  if (target.isContentEditable) return true;
  if (target instanceof HTMLTextAreaElement) return !isFixed(target);
  if (!(target instanceof HTMLInputElement) || isEditingNumber(event)) return false;
  return TEXT_TYPES.includes(target.type) && !isFixed(target);
}

/** Whether the event is input to a field for a number, in which a letter means nothing. */
export function isEditingNumber(event: KeyboardEvent): boolean {
  const field = event.target;
  if (!(field instanceof HTMLInputElement)) return false;
  return field.type === "number" || ["decimal", "numeric"].includes(field.inputMode);
}

function isFixed(field: HTMLInputElement | HTMLTextAreaElement): boolean {
  return field.readOnly || field.disabled;
}
