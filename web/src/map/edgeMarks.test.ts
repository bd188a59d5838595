import { describe, expect, it } from "vitest";
import { edgeMarksOf } from "./edgeMarks";

const WINDOW = { left: 0, top: 0, right: 1000, bottom: 800 };
const PANEL = { left: 700, top: 100, right: 1000, bottom: 800 };
const ROOM = { left: 0, top: 100, right: 700, bottom: 800 };
const SEEN = { window: WINDOW, covers: [PANEL], room: ROOM };
const spot = (key: number, x_px: number, y_px: number) => ({
  key,
  x_px,
  y_px,
  badge: `${key}`,
  name: `Drone ${key}`,
});

describe("marks at the map's edge", () => {
  it("stand for vehicles beyond the window and under a panel, towards them", () => {
    const marks = edgeMarksOf([spot(1, 300, 300), spot(2, 900, 450), spot(3, 350, 5000)], SEEN);
    expect(marks.map(({ spots }) => spots.map(({ key }) => key))).toEqual([[2], [3]]);
    const [right, below] = marks;
    expect(right?.x_px).toBeCloseTo(678);
    expect(right?.y_px).toBeCloseTo(450);
    expect(right?.towards_deg).toBeCloseTo(90);
    expect(below?.y_px).toBeCloseTo(778);
    expect(Math.abs(below?.towards_deg ?? 0)).toBeGreaterThan(170);
  });

  it("are one where they would hide each other", () => {
    const marks = edgeMarksOf([spot(1, 5000, 450), spot(2, 5000, 460), spot(3, -900, 450)], SEEN);
    expect(marks.map(({ spots }) => spots.length)).toEqual([2, 1]);
  });

  it("are left out where there is hardly a map", () => {
    const room = { ...ROOM, bottom: 180 };
    expect(edgeMarksOf([spot(1, 5000, 450)], { ...SEEN, room })).toEqual([]);
  });
});
