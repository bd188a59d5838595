import { afterEach, describe, expect, it } from "vitest";
import {
  chooseLengthUnit,
  createLengthField,
  formatHeight,
  formatLength,
  inLengthUnit,
  keepLengthUnit,
  LENGTH_UNITS,
  type LengthUnit,
  lengthText,
  lengthUnit,
  metresOf,
  withLengthUnit,
} from "./units";

afterEach(() => chooseLengthUnit("m"));

const UNITS = Object.keys(LENGTH_UNITS) as LengthUnit[];
/** Lengths over all magnitudes and both signs, the same in each run. */
const LENGTHS_M = Array.from({ length: 2000 }, (_, index) => {
  const sign = index % 2 === 0 ? 1 : -1;
  return sign * 10 ** ((index % 700) / 140 - 1) * (1 + (index % 13) / 13);
});

describe.each(UNITS)("in %s", (unit) => {
  it("a shown length read back is within half of the shown step", () => {
    chooseLengthUnit(unit);
    for (const digits of [0, 1, 2])
      for (const length_m of LENGTHS_M) {
        const shown = Number(
          formatLength(length_m, digits).split("\u00a0")[0]?.replace("\u2212", "-"),
        );
        const half_m = metresOf(1000, unit) / 1000 / 10 ** digits / 2;
        // A millimetre is the least that is sent.
        expect(Math.abs(metresOf(shown) - length_m)).toBeLessThanOrEqual(half_m + 0.0005 + 1e-9);
      }
  });

  it("a field offers and sends the same length, and keeps it when the unit changes", () => {
    chooseLengthUnit(unit);
    const half_m = metresOf(1, unit) / 2;
    for (const length_m of LENGTHS_M) {
      const field = createLengthField(length_m);
      const sent_m = field.metres();
      expect(Math.abs((sent_m ?? Number.NaN) - length_m)).toBeLessThanOrEqual(half_m + 0.001);
      for (const other of UNITS) {
        chooseLengthUnit(other);
        expect(field.metres()).toBe(sent_m);
        const half_other_m = metresOf(1, other) / 2;
        const shown_m = metresOf(Number(field.text()));
        expect(Math.abs(shown_m - (sent_m ?? Number.NaN))).toBeLessThanOrEqual(
          half_other_m + 0.001,
        );
      }
      chooseLengthUnit(unit);
    }
  });

  it("a field's exact text read back is the same text", () => {
    chooseLengthUnit(unit);
    for (const length_m of LENGTHS_M) {
      const sent_m = metresOf(Number(lengthText(length_m)));
      expect(Math.abs(sent_m - length_m)).toBeLessThanOrEqual(0.0025);
      expect(lengthText(sent_m)).toBe(lengthText(length_m));
    }
  });

  it("a number is the same after both conversions", () => {
    chooseLengthUnit(unit);
    for (const length_m of LENGTHS_M)
      expect(Math.abs(metresOf(inLengthUnit(length_m)) - length_m)).toBeLessThanOrEqual(0.00051);
  });
});

describe("a length", () => {
  it.each([
    ["m", 40, "40\u00a0m", "40\u00a0m\u00a0ATO"],
    ["ft", 40, "131\u00a0ft", "131\u00a0ft\u00a0ATO"],
    ["ft", 0, "0\u00a0ft", "0\u00a0ft\u00a0ATO"],
    ["ft", null, "—", "—"],
  ] as const)("in %s of %s is %s", (unit, length_m, length, height) => {
    chooseLengthUnit(unit);
    expect([formatLength(length_m), formatHeight(length_m)]).toEqual([length, height]);
  });

  it("typed in metres is no other length in feet", () => {
    const field = createLengthField(30);
    field.type("40,5");
    chooseLengthUnit("ft");
    expect([field.text(), field.metres()]).toEqual(["133", 40.5]);
    field.type("100");
    expect(field.metres()).toBe(30.48);
    field.type("1o0");
    expect(field.metres()).toBeNull();
    chooseLengthUnit("m");
    expect([field.text(), field.metres()]).toEqual(["1o0", null]);
    field.set(null);
    expect([field.text(), field.metres()]).toEqual(["", null]);
  });
});

it("the unit is kept in this browser; an unknown one is metres", () => {
  const stored = new Map<string, string>();
  const storage = {
    getItem: (key: string) => stored.get(key) ?? null,
    setItem: (key: string, value: string) => stored.set(key, value),
  };
  keepLengthUnit(storage);
  expect(lengthUnit()).toBe("m");
  chooseLengthUnit("ft");
  keepLengthUnit(storage);
  expect(lengthUnit()).toBe("ft");
  stored.set("recon.lengthUnit", "furlongs");
  keepLengthUnit(storage);
  expect(lengthUnit()).toBe("m");
});

describe("a sentence of the station", () => {
  it.each([
    ["expected 10 to 120 m, got 150", "expected 10 to 120 m (394 ft), got 150"],
    [
      "Alder is 12.5 m above Birch, at 45\u00a0m",
      "Alder is 12.5 m (41 ft) above Birch, at 45\u00a0m (148 ft)",
    ],
    ["sinks below -3 m", "sinks below -3 m (−10 ft)"],
    ["at 8 m/s over 20 m2, 5 min, 3 missions", "at 8 m/s over 20 m2, 5 min, 3 missions"],
  ])("has feet behind its metres, and nothing replaced: %s", (written, shown) => {
    expect(withLengthUnit(written)).toBe(written);
    chooseLengthUnit("ft");
    expect(withLengthUnit(written).replaceAll("\u00a0ft", " ft")).toBe(shown);
  });
});
