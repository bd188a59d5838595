import { afterEach, expect, test } from "vitest";
import { baseMap } from "../testing/fakeField";
import { coverageText, isIncomplete } from "./baseMaps";
import { chooseLengthUnit } from "./units";

afterEach(() => chooseLengthUnit("m"));

const at = (share: number) => baseMap({ covers: { zoom: 19, share, metres_per_pixel: 0.2222 } });

test.each([
  [1, "covers 100 % of the site to zoom 19 (0.22\u00a0m a pixel)"],
  [0.9994, "covers 99 % of the site to zoom 19 (0.22\u00a0m a pixel)"],
  [0.005, "covers less than 1 % of the site to zoom 19 (0.22\u00a0m a pixel)"],
  [0, "covers nothing of the site"],
])("a share of %d is never rounded up to all or down to nothing", (share, text) => {
  expect(coverageText(at(share))).toBe(text);
  expect(isIncomplete(at(share))).toBe(share < 1);
});

test("pixels have the chosen unit", () => {
  chooseLengthUnit("ft");
  expect(coverageText(at(1))).toBe("covers 100 % of the site to zoom 19 (0.73\u00a0ft a pixel)");
});

test("a map that is refused, or a site without a place, has its sentence", () => {
  expect(coverageText(baseMap({ problem: "expected tiles" }))).toBe("expected tiles");
  expect(isIncomplete(baseMap({ problem: "expected tiles" }))).toBe(true);
  expect(coverageText(baseMap({ covers: null }))).toContain("is not known");
  expect(isIncomplete(baseMap({ covers: null }))).toBe(false);
});
