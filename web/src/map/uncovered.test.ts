import { expect, it } from "vitest";
import { paddingOf } from "./uncovered";

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
