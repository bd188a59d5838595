import { describe, expect, it } from "vitest";
import { type Frame, type LabelSpot, placeFrames, placeLabels, SIDES, type Side } from "./labels";
import { isInSight } from "./uncovered";

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

  it("are not cut by the window's edge, and stand under no panel or button", () => {
    const seen = {
      window: { left: 0, top: 0, right: 400, bottom: 800 },
      covers: [{ left: 340, top: 300, right: 390, bottom: 344 }],
    };
    const sideOf = (x: number, y: number, before = new Map<number, Side>()) =>
      placeLabels([at(1, x, y)], [at(1, x, y)], before, [], (frame) => isInSight(frame, seen)).get(
        1,
      );
    expect(sideOf(200, 400)).toBe("right");
    expect(sideOf(390, 400)).toBe("left");
    expect(sideOf(30, 400, new Map([[1, "left"]]))).toBe("right");
    expect(sideOf(300, 320)).toBe("left");
    expect(sideOf(300, 280)).toBe("right");
    expect(sideOf(365, 322)).toBe("below");
    expect(sideOf(-30, 400)).toBeUndefined();
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

describe("labels of areas", () => {
  const frame = (left: number, top: number): Frame => ({
    left,
    top,
    right: left + 80,
    bottom: top + 20,
  });
  const overlaps = (a: Frame, b: Frame) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

  it("take their next place where a label of a lower rank has the first", () => {
    const boundary = { key: "boundary", rank: 3, places: [frame(0, 0), frame(0, 200)] };
    const height = { key: "height", rank: 2, places: [frame(30, 10), frame(30, 60)] };
    const wanted = [boundary, height].map((label) => ({
      ...label,
      places: label.places.map((one, index) => [index, one] as const),
    }));
    expect(placeFrames(wanted)).toEqual(
      new Map([
        ["height", 0],
        ["boundary", 1],
      ]),
    );
  });

  it("never cover each other, and one is excluded only where each of its places is taken", () => {
    for (let seed = 1; seed <= 50; seed += 1) {
      const random = sequence(seed);
      const wanted = [...Array(12).keys()].map((key) => ({
        key,
        rank: Math.floor(random() * 4),
        places: [0, 1, 2].map(() => {
          const one = frame(random() * 300, random() * 300);
          return [one, one] as const;
        }),
      }));
      const placed = placeFrames(wanted);
      const frames = [...placed.values()];
      for (const [index, one] of frames.entries())
        expect(frames.slice(index + 1).some((other) => overlaps(one, other))).toBe(false);
      for (const { key, rank, places } of wanted.filter(({ key }) => !placed.has(key))) {
        const before = wanted.filter((other) => other.rank <= rank && other.key !== key);
        const taken = before.flatMap((other) => placed.get(other.key) ?? []);
        for (const [place] of places)
          expect(taken.some((other) => overlaps(place, other))).toBe(true);
      }
    }
  });
});

/** Numbers from 0 to 1, the same for the same seed. */
function sequence(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647;
  };
}
