import { afterEach, expect, it, vi } from "vitest";
import { onCoversChange, paddingOf } from "./uncovered";

afterEach(() => vi.unstubAllGlobals());

const element = (left: number, top: number, width: number, height: number) => ({
  getBoundingClientRect: () => new DOMRect(left, top, width, height),
});

it("what is fitted leaves room for a notice, unless there is little height", () => {
  const map = element(0, 0, 1440, 900);
  expect(paddingOf(map, element(340, 120, 700, 600))).toEqual({
    left: 364,
    top: 208,
    right: 424,
    bottom: 204,
  });
  expect(paddingOf(map, element(340, 120, 700, 400)).top).toBe(144);
});

it("is told when panels, tools or notes take room, until the map is removed", () => {
  const observed: string[] = [];
  let grew = () => {};
  let isOver = false;
  class Observer {
    constructor(changed: () => void) {
      grew = changed;
    }
    observe(part: Element) {
      observed.push(part.className);
    }
    disconnect() {
      isOver = true;
    }
  }
  vi.stubGlobal("ResizeObserver", Observer);
  document.body.innerHTML =
    '<div class="map-free"><i class="map-tools"></i><i class="map-notes"></i></div>';
  let remove = () => {};
  const map = { once: (_: string, then: () => void) => (remove = then) };
  let calls = 0;
  onCoversChange(map as never, () => calls++);
  expect(observed).toEqual(["map-free", "map-tools", "map-notes"]);
  grew();
  expect(calls).toBe(1);
  remove();
  expect(isOver).toBe(true);
});
