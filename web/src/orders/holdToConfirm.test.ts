import { createRoot } from "solid-js";
import { describe, expect, it, vi } from "vitest";
import { FakeClock } from "../testing/fakeClock";
import {
  createHoldTimer,
  type Hold,
  type HoldEvent,
  holdProgress,
  IDLE,
  MAX_TICK_MS,
  stepHold,
} from "./holdToConfirm";

const PRESS: HoldEvent = { kind: "press", duration_ms: 1500, targets: '["A"]' };
const TICK: HoldEvent = { kind: "tick", targets: '["A"]' };

/** Runs events given as [time, event]. */
function run(events: readonly (readonly [number, HoldEvent])[]): Hold {
  return events.reduce((hold, [now_ms, event]) => stepHold(hold, event, now_ms), IDLE);
}

/** Ticks every 50 ms from `from_ms` through `to_ms`. */
function ticks(from_ms: number, to_ms: number): [number, HoldEvent][] {
  const count = Math.floor((to_ms - from_ms) / 50) + 1;
  return Array.from({ length: count }, (_, index) => [from_ms + 50 * index, TICK]);
}

describe("hold to confirm", () => {
  it("confirms after the full time and not before", () => {
    expect(run([[0, PRESS], ...ticks(50, 1450)]).kind).toBe("holding");
    expect(run([[0, PRESS], ...ticks(50, 1500)]).kind).toBe("done");
  });

  it("sends no order when released early", () => {
    const released = run([[0, PRESS], ...ticks(50, 1400), [1410, { kind: "release" }]]);
    expect(released).toEqual(IDLE);
    expect(stepHold(released, TICK, 1600)).toEqual(IDLE);
  });

  it("sends no order when the vehicles change", () => {
    const other: HoldEvent = { kind: "tick", targets: '["A","B"]' };
    expect(run([[0, PRESS], ...ticks(50, 500), [550, other], ...ticks(600, 3000)])).toEqual(IDLE);
  });

  it("does not count time in which the page hung, since a release may be queued", () => {
    const stalled = run([[0, PRESS], ...ticks(50, 1000), [9000, TICK]]);
    expect(stalled).toMatchObject({ kind: "holding", held_ms: 1000 + MAX_TICK_MS });
    expect(stepHold(stalled, { kind: "release" }, 9001)).toEqual(IDLE);
  });

  it("does not start without vehicles", () => {
    expect(run([[0, { kind: "press", duration_ms: 400, targets: "" }]])).toEqual(IDLE);
  });

  it("confirms once, however long it is held", () => {
    const done = run([[0, PRESS], ...ticks(50, 1500)]);
    expect(stepHold(done, TICK, 5000)).toBe(done);
    expect(stepHold(done, PRESS, 5000)).toBe(done);
    expect(stepHold(done, { kind: "release" }, 5000)).toEqual(IDLE);
  });

  it("does not restart on a second press", () => {
    const hold = run([[0, PRESS], ...ticks(50, 1000), [1020, PRESS], ...ticks(1050, 1500)]);
    expect(hold.kind).toBe("done");
  });

  it("reports its progress", () => {
    expect(holdProgress(IDLE)).toBe(0);
    expect(holdProgress(run([[0, PRESS], ...ticks(50, 750)]))).toBeCloseTo(0.5);
    expect(holdProgress({ kind: "done" })).toBe(1);
  });
});

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
  it("confirms once when its time is over", () => {
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

  it("processes a release that was queued while the page hung", () => {
    const { clock, confirm, timer } = setUp(1500);
    timer.press();
    clock.advance(1000);
    clock.stall(5000);
    clock.advance(0);
    timer.release();
    clock.advance(5000);
    expect(confirm).not.toHaveBeenCalled();
  });

  it("stops at a release, a cancel and a changed selection", () => {
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

  it("leaves no timer running", () => {
    const { clock, timer, dispose } = setUp(1500);
    timer.press();
    dispose();
    expect(clock.pending).toBe(0);
  });
});
