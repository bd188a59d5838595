import { describe, expect, it } from "vitest";
import { listNames, listSome, personName, phaseTone, plainWords, withoutNumbers } from "./names";
import {
  agedBy,
  formatAge,
  formatBytes,
  formatFraction,
  formatHeading,
  formatQuantity,
  groundSpeedMps,
  UNKNOWN,
  unknownReason,
} from "./quantities";

describe("ages", () => {
  it.each([
    [0, "0.0 s"],
    [0.24, "0.2 s"],
    [9.94, "9.9 s"],
    [9.96, "10 s"],
    [59.4, "59 s"],
    [59.6, "1 min 0 s"],
    [200, "3 min 20 s"],
    [3599.6, "1 h 0 min"],
    [7500, "2 h 5 min"],
    [-0.1, "0.0 s"],
    [null, UNKNOWN],
    [Number.NaN, UNKNOWN],
  ])("%s s is %s", (seconds, text) => expect(formatAge(seconds)).toBe(text));

  it("stay unknown when time is added", () => {
    expect(agedBy(null, 5)).toBeNull();
    expect(agedBy(0.5, 5)).toBe(5.5);
  });
});

describe("quantities", () => {
  it.each([
    [12.345, "m", 1, "12.3\u00a0m"],
    [-4.25, "m", 1, "\u22124.3\u00a0m"],
    [-0.01, "m/s", 1, "0.0\u00a0m/s"],
    [0, "m", 0, "0\u00a0m"],
    [null, "m", 1, UNKNOWN],
    [Number.POSITIVE_INFINITY, "m", 1, UNKNOWN],
  ])("%s %s with %i digits is %s", (value, unit, digits, text) => {
    expect(formatQuantity(value, unit, digits)).toBe(text);
  });

  it("round battery fractions down", () => {
    expect(formatFraction(0.299)).toBe("29\u00a0%");
    expect(formatFraction(0.29)).toBe("29\u00a0%");
    expect(formatFraction(1)).toBe("100\u00a0%");
    expect(formatFraction(null)).toBe(UNKNOWN);
  });

  it.each([
    [0, "000°"],
    [-90, "270°"],
    [359.7, "000°"],
    [180, "180°"],
    [null, UNKNOWN],
  ])("a heading of %s is %s", (degrees, text) => expect(formatHeading(degrees)).toBe(text));

  it("have no speed when a component is unknown", () => {
    expect(groundSpeedMps(3, 4)).toBe(5);
    expect(groundSpeedMps(null, 4)).toBeNull();
  });

  it("have different reasons for being unknown", () => {
    expect(unknownReason(null)).not.toBe(unknownReason(0.2));
  });

  it.each([
    [999, "999 B"],
    [1500, "1.5 kB"],
    [2_500_000, "2.5 MB"],
    [3e9, "3.00 GB"],
  ])("%i bytes are %s", (count, text) => expect(formatBytes(count)).toBe(text));
});

describe("names", () => {
  it("are joined as a list in a sentence", () => {
    expect(listNames([])).toBe("");
    expect(listNames(["a"])).toBe("a");
    expect(listNames(["a", "b"])).toBe("a and b");
    expect(listNames(["a", "b", "c"])).toBe("a, b and c");
  });

  it("of enum values are plain text", () =>
    expect(plainWords("AUTO_LANDING")).toBe("auto landing"));

  it("show only a confirmed command as good", () => {
    expect(phaseTone({ phase: "confirmed" })).toBe("good");
    expect(phaseTone({ phase: "acknowledged" })).toBe("underway");
    expect(phaseTone({ phase: "timed_out" })).toBe("bad");
  });
});

describe("what operators read", () => {
  it("names users, not addresses", () => {
    expect(personName("anna (192.168.1.4): survey west")).toBe("anna, survey west");
    expect(personName("root (this computer)")).toBe("root");
    expect(personName("station: fleet return")).toBe("station, fleet return");
  });

  it("has no numbers of the station's orders", () => {
    expect(withoutNumbers("Replaced by order -24")).toBe("Replaced by a newer order");
    expect(withoutNumbers("follows the takeoff of order 7: sent")).toBe(
      "follows the takeoff of an order: sent",
    );
  });

  it("lists a few names, and how many more", () => {
    expect(listSome(["a", "b"], 3)).toBe("a and b");
    expect(listSome(["a", "b", "c", "d", "e"], 3)).toBe("a, b, c and 2 more");
  });
});
