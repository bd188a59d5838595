import { describe, expect, it } from "vitest";
import { type LabelSpot, placeLabels, SIDES } from "./labels";

const at = (key: number, x_px: number, y_px: number, rank = key): LabelSpot => ({
  key,
  x_px,
  y_px,
  text: "30 m",
  rank,
});

describe("labels", () => {
  it("stand to the right of a symbol that is alone", () => {
    const alone = [at(1, 0, 0)];
    expect(placeLabels(alone, alone, new Map())).toEqual(new Map([[1, "right"]]));
  });

  it("cover no other vehicle's symbol", () => {
    const two = [at(1, 0, 0), at(2, 40, 0)];
    expect(placeLabels(two, two, new Map()).get(1)).toBe("left");
  });

  it("give way to those of a lower rank, and are dropped without room", () => {
    const crowd = [...Array(30).keys()].map((n) => at(n + 1, (n % 6) * 20, Math.floor(n / 6) * 20));
    const last = { ...at(13, 40, 40, 0) };
    const sides = placeLabels([...crowd.filter(({ key }) => key !== 13), last], [last], new Map());
    expect(sides.get(13)).toBe("right");
    expect(sides.size).toBeLessThan(30);
  });

  it("cover no target's label", () => {
    const alone = [at(1, 0, 0)];
    const target = { x_px: 40, y_px: 34, text: "1 Birch flying here" };
    expect(placeLabels(alone, alone, new Map(), [target]).get(1)).toBe("below");
    const low = { ...target, y_px: 80 };
    expect(placeLabels(alone, alone, new Map([[1, "below"]]), [low]).get(1)).toBe("right");
  });

  it("keep their side while it is free", () => {
    const alone = [at(1, 0, 0)];
    for (const side of SIDES) {
      expect(placeLabels(alone, alone, new Map([[1, side]])).get(1)).toBe(side);
    }
    const beside = [at(1, 0, 0), at(2, -40, 0)];
    expect(placeLabels(beside, beside, new Map([[1, "left"]])).get(1)).toBe("right");
  });
});
