import { describe, expect, it } from "vitest";
import { FakeClock } from "../testing/fakeClock";
import { StreamLag } from "./streamLag";

const SECOND_NS = 1e9;

describe("the stream's lag", () => {
  it("is unknown before the first message", () => {
    expect(new StreamLag().behindS(new FakeClock().now())).toBeNull();
  });

  it("grows with the time since the newest message", () => {
    const clock = new FakeClock();
    const lag = new StreamLag();
    lag.restart(5 * SECOND_NS, clock.now());
    clock.advance(700);
    expect(lag.behindS(clock.now())).toBeCloseTo(0.7);
  });

  it("includes a message's delay on the network", () => {
    const clock = new FakeClock();
    const lag = new StreamLag();
    lag.restart(5 * SECOND_NS, clock.now());
    clock.advance(3000);
    // Created 0.1 s after the first, but received 3 s after it.
    lag.record(5.1 * SECOND_NS, clock.now());
    expect(lag.behindS(clock.now())).toBeCloseTo(2.9);
  });

  it("grows while the computer sleeps and its monotonic clock stops", () => {
    const clock = new FakeClock();
    const lag = new StreamLag();
    lag.restart(0, clock.now());
    clock.sleep(60_000);
    expect(lag.behindS(clock.now())).toBeCloseTo(60);
  });

  it("resets when the station restarts", () => {
    const clock = new FakeClock();
    const lag = new StreamLag();
    lag.restart(9000 * SECOND_NS, clock.now());
    clock.advance(1000);
    lag.restart(0, clock.now());
    expect(lag.behindS(clock.now())).toBe(0);
  });

  it("forgets transit times older than a minute, so that clocks may drift", () => {
    const clock = new FakeClock();
    const lag = new StreamLag();
    lag.restart(0, clock.now());
    // A local clock 0.1 % too fast, for ten minutes at one message a second.
    for (let second = 1; second <= 600; second += 1) {
      clock.advance(1001);
      lag.record(second * SECOND_NS, clock.now());
    }
    expect(lag.behindS(clock.now())).toBeLessThan(0.07);
  });
});
