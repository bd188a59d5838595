import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { vehicle } from "../testing/fakeState";
import { type Band, createSelectionBand, keysIn } from "./selectionBand";

const container = document.createElement("div");
const canvas = document.createElement("canvas");
container.append(canvas);
const still: boolean[] = [];
const map = {
  getCanvasContainer: () => container,
  dragPan: { disable: () => still.push(true), enable: () => still.push(false) },
  boxZoom: { disable: () => {} },
} as unknown as Parameters<typeof createSelectionBand>[0];

let isTool = false;
let bands: Band[] = [];
let remove = () => {};
beforeEach(() => {
  [isTool, bands] = [false, []];
  still.length = 0;
  document.body.append(container);
  remove = createSelectionBand(
    map,
    () => isTool,
    (band) => bands.push(band),
  );
});
afterEach(() => remove());

function drag(to: readonly [number, number], init: PointerEventInit = {}, target = canvas) {
  const event = (type: string, x: number, y: number) =>
    target.dispatchEvent(
      new PointerEvent(type, { bubbles: true, button: 0, clientX: x, clientY: y, ...init }),
    );
  event("pointerdown", 100, 100);
  event("pointermove", to[0], to[1]);
  event("pointerup", to[0], to[1]);
}

describe("a drag over the map", () => {
  it("selects with Shift, in any direction, while the map stands still", () => {
    drag([40, 180], { shiftKey: true });
    expect(bands).toEqual([{ left: 40, top: 100, right: 100, bottom: 180 }]);
    expect(still).toEqual([true, false]);
  });

  it("moves the map without Shift, and selects with the tool", () => {
    drag([40, 180]);
    expect(bands).toEqual([]);
    expect(still).toEqual([]);
    isTool = true;
    drag([40, 180]);
    expect(bands).toHaveLength(1);
  });

  it("of a few pixels is a press", () => {
    drag([103, 104], { shiftKey: true });
    expect(bands).toEqual([]);
    expect(still).toEqual([true, false]);
  });
});

it("the vehicles in a box are those whose place is in it", () => {
  const at = { project: ([lon]: [number, number]) => ({ x: lon, y: 50 }) } as never;
  const placed = (key: number, longitude_deg: number | null) =>
    vehicle(key, { position: { latitude_deg: 1, longitude_deg, age_s: 0 } });
  const fleet = [placed(1, 10), placed(2, 60), placed(3, null)];
  expect(keysIn({ left: 0, top: 0, right: 20, bottom: 90 }, fleet, at)).toEqual([1]);
});
