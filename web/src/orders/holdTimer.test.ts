import { createRoot } from "solid-js";
import { describe, expect, it, vi } from "vitest";
import { FakeClock } from "../testing/fakeClock";
import { createHoldTimer } from "./holdTimer";

function setUp(duration_ms: number) {
  const clock = new FakeClock();
  const confirm = vi.fn();
  let targets = '["A"]';
  const { timer, dispose } = createRoot((dispose) => ({
    timer: createHoldTimer(clock, duration_ms, () => targets, confirm),
    dispose,
  }));
  const choose = (other: string) => {
    targets = other;
  };
  return { clock, confirm, timer, choose, dispose };
}

describe("the hold timer", () => {
  it("confirms once when its time is through", () => {
    const { clock, confirm, timer } = setUp(1500);
    timer.press();
    clock.advance(1499);
    expect(confirm).not.toHaveBeenCalled();
    clock.advance(60);
    expect(confirm).toHaveBeenCalledTimes(1);
    clock.advance(5000);
    expect(confirm).toHaveBeenCalledTimes(1);
  });

  it("shows its progress", () => {
    const { clock, timer } = setUp(1000);
    timer.press();
    clock.advance(500);
    expect(timer.progress()).toBeCloseTo(0.5);
    timer.release();
    expect(timer.progress()).toBe(0);
  });

  it("hears a release that waited while the page hung", () => {
    const { clock, confirm, timer } = setUp(1500);
    timer.press();
    clock.advance(1000);
    clock.stall(5000);
    clock.advance(0);
    timer.release();
    clock.advance(5000);
    expect(confirm).not.toHaveBeenCalled();
  });

  it("stops at a release, a cancel and another selection", () => {
    for (const stop of [
      (set: ReturnType<typeof setUp>) => set.timer.release(),
      (set: ReturnType<typeof setUp>) => set.timer.cancel(),
      (set: ReturnType<typeof setUp>) => set.choose('["B"]'),
    ]) {
      const set = setUp(1500);
      set.timer.press();
      set.clock.advance(1000);
      stop(set);
      set.clock.advance(3000);
      expect(set.confirm).not.toHaveBeenCalled();
      expect(set.clock.pending).toBe(0);
    }
  });

  it("leaves no timer behind", () => {
    const { clock, timer, dispose } = setUp(1500);
    timer.press();
    dispose();
    expect(clock.pending).toBe(0);
  });
});
