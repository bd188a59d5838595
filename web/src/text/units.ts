import { type Accessor, createSignal } from "solid-js";
import { text } from "./catalogue";
import { formatQuantity } from "./quantities";

/**
 * Heights and distances are shown and typed in metres or feet, as chosen in this browser. Values of the program and of
 * the station are always metres: this is the one place that converts.
 */
export type LengthUnit = "m" | "ft";

export const LENGTH_UNITS: Readonly<Record<LengthUnit, string>> = text.menu.lengthUnits;

/** The international foot, exact. */
const METRES: Readonly<Record<LengthUnit, number>> = { m: 1, ft: 0.3048 };

const STORED_AS = "recon.lengthUnit";

const [unit, setUnit] = createSignal<LengthUnit>("m");

/** The unit of everything on the page that is a height or a distance. */
export const lengthUnit: Accessor<LengthUnit> = unit;

let kept: Pick<Storage, "setItem"> | null = null;

/** Takes the unit stored in this browser, and stores further choices there. */
export function keepLengthUnit(storage: Pick<Storage, "getItem" | "setItem">): void {
  kept = storage;
  setUnit(storage.getItem(STORED_AS) === "ft" ? "ft" : "m");
}

export function chooseLengthUnit(next: LengthUnit): void {
  setUnit(next);
  kept?.setItem(STORED_AS, next);
}

/** A length in metres as a number of the chosen unit. */
export function inLengthUnit(length_m: number): number {
  return length_m / METRES[unit()];
}

/** Metres of a number in the chosen unit, to the millimetre. */
export function metresOf(value: number, of: LengthUnit = unit()): number {
  return Math.round(value * METRES[of] * 1000) / 1000;
}

/** A height or distance with its unit, `40 m` or `131 ft`; a dash when unknown. */
export function formatLength(length_m: number | null, digits = 0): string {
  return formatQuantity(length_m === null ? null : inLengthUnit(length_m), unit(), digits);
}

/** A number of metres in a sentence of the station: `30 m`, `-2.5 m`; no speed, no area. */
const METRES_IN_SENTENCE = /(-?\d+(?:\.\d+)?)[ \u00a0]m(?![\w/²³])/g;

/**
 * A sentence of the station, which is in metres; each length is followed by feet if these are chosen. Nothing of the
 * sentence is replaced: what the station wrote stays true, also `10 to 120 m`.
 */
export function withLengthUnit(sentence: string): string {
  if (unit() === "m") return sentence;
  return sentence.replace(
    METRES_IN_SENTENCE,
    (metres, number: string) => `${metres} (${formatLength(Number(number))})`,
  );
}

/** A vehicle's height with its datum, short: `40 m ATO`, above takeoff. */
export function formatHeight(height_above_takeoff_m: number | null): string {
  const height = formatLength(height_above_takeoff_m);
  return height_above_takeoff_m === null ? height : `${height}\u00a0ATO`;
}

/**
 * A length as the text of a field, to a millimetre or a hundredth of a foot: millimetres are sent, so a thousandth of a
 * foot would not be the one that was typed.
 */
export function lengthText(length_m: number): string {
  return String(Number(inLengthUnit(length_m).toFixed(unit() === "m" ? 3 : 2)));
}

/** The number in a field, with a decimal point or comma; null when it is not a number. */
export function numberIn(text: string): number | null {
  const plain = text.trim().replace(",", ".");
  const value = Number(plain);
  return plain === "" || !Number.isFinite(value) ? null : value;
}

/** A field for a height or a distance. What was typed keeps the unit in which it was typed. */
export interface LengthField {
  /** As typed; converted when the unit was changed since. */
  readonly text: Accessor<string>;
  /** Null while it is not a number. */
  readonly metres: Accessor<number | null>;
  type(text: string): void;
  /** Sets it to a rounded length; null empties it. */
  set(length_m: number | null): void;
}

export function createLengthField(first_m: number | null): LengthField {
  const rounded = (length_m: number | null) =>
    length_m === null ? "" : String(Math.round(inLengthUnit(length_m)));
  const [typed, setTyped] = createSignal({ text: rounded(first_m), unit: unit() });
  const metres = () => {
    const value = numberIn(typed().text);
    return value === null ? null : metresOf(value, typed().unit);
  };
  return {
    text: () => {
      const { text, unit: was } = typed();
      return was === unit() || metres() === null ? text : rounded(metres());
    },
    metres,
    type: (text) => setTyped({ text, unit: unit() }),
    set: (length_m) => setTyped({ text: rounded(length_m), unit: unit() }),
  };
}
