import { type Accessor, createSignal } from "solid-js";
import { isEditingNumber, isTyping } from "./panels/orders/shortcuts";
import type { Clock } from "./source/clock";

/** Between two digits of one number. */
const PAUSE_MS = 2000;
/** More digits than any number has are the last of them. */
const MOST = 1000;

/** A number of two or more digits that is being typed, for vehicles beyond 9. */
export interface NumberEntry {
  /** The number so far, if a vehicle has it; null without one. */
  readonly number: Accessor<number | null>;
  /** Takes a key press before anything else does; returns true if it was Enter behind a number. */
  take(event: KeyboardEvent): boolean;
}

/** `enter` gets the number, and whether the vehicle is added to the selection (Shift). */
export function createNumberEntry(
  clock: Clock,
  isKnown: (number: number) => boolean,
  enter: (number: number, isAdded: boolean) => void,
): NumberEntry {
  const [typed, setTyped] = createSignal("");
  let forget = () => {};
  const number = () => (typed().length > 1 && isKnown(Number(typed())) ? Number(typed()) : null);
  const set = (digits: string) => {
    forget();
    setTyped(digits);
    if (digits !== "") forget = clock.after(PAUSE_MS, () => setTyped(""));
  };
  return {
    number,
    take: (event) => {
      if (event.key === "Shift" || event.repeat) return false;
      const found = number();
      const digit = /^(?:Digit|Numpad)(\d)$/.exec(event.code)?.[1];
      const isPlain = !event.ctrlKey && !event.altKey && !event.metaKey;
      const isElsewhere = isTyping(event) || isEditingNumber(event) || !isPlain;
      const isEnter = event.key === "Enter" && found !== null && !isElsewhere;
      if (digit === undefined || isElsewhere) set("");
      else set(String(Number(typed() + digit) % MOST));
      if (isEnter) enter(found, event.shiftKey);
      return isEnter;
    },
  };
}
