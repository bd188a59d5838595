import { expect, it, vi } from "vitest";
import { createNumberEntry } from "./numberEntry";
import { FakeClock } from "./testing/fakeClock";

function entry(...known: number[]) {
  const clock = new FakeClock();
  const enter = vi.fn();
  const typed = createNumberEntry(clock, (number) => known.includes(number), enter);
  const press = (key: string, init: KeyboardEventInit = {}) => {
    const code = /\d/.test(key) ? `Digit${key}` : key;
    const event = new KeyboardEvent("keydown", { key, code, bubbles: true, ...init });
    (document.activeElement ?? document.body).dispatchEvent(event);
    return typed.take(event);
  };
  return { clock, enter, press, number: typed.number };
}

it("any number is typed and entered, alone or added", () => {
  const { press, enter, number } = entry(1, 7, 17, 120);
  press("1");
  expect(number()).toBeNull();
  press("7");
  expect(number()).toBe(17);
  expect(press("Enter")).toBe(true);
  for (const key of "120") press(key);
  press("Enter", { shiftKey: true });
  expect(enter.mock.calls).toEqual([
    [17, false],
    [120, true],
  ]);
});

it("Enter keeps its own meaning without a number of two digits that a vehicle has", () => {
  const { press, enter } = entry(1, 17);
  press("1");
  expect(press("Enter")).toBe(false);
  press("1");
  press("8");
  expect(press("Enter")).toBe(false);
  press("1");
  press("f");
  press("7");
  expect(press("Enter")).toBe(false);
  expect(enter).not.toHaveBeenCalled();
});

it("a number is forgotten after a pause, and not taken from a field", () => {
  const { press, clock, enter } = entry(17);
  press("1");
  clock.advance(2001);
  press("7");
  expect(press("Enter")).toBe(false);
  const field = document.createElement("input");
  document.body.append(field);
  field.focus();
  press("1");
  press("7");
  expect(press("Enter")).toBe(false);
  field.remove();
  expect(enter).not.toHaveBeenCalled();
});
