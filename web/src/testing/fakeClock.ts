import type { Clock, Instant } from "../source/clock";

interface Timer {
  readonly at_ms: number;
  readonly action: () => void;
}

/** A clock that advances only when the test moves it. */
export class FakeClock implements Clock {
  private monotonicMs = 1000;
  private wallMs = 1_700_000_000_000;
  private timers: Timer[] = [];

  now(): Instant {
    return { monotonicMs: this.monotonicMs, wallMs: this.wallMs };
  }

  after(delayMs: number, action: () => void): () => void {
    const entry = { at_ms: this.monotonicMs + delayMs, action };
    this.timers.push(entry);
    return () => {
      this.timers = this.timers.filter((other) => other !== entry);
    };
  }

  /** Advances time and runs due timers in order. */
  advance(ms: number): void {
    const end_ms = this.monotonicMs + ms;
    for (;;) {
      const due = this.timers
        .filter((entry) => entry.at_ms <= end_ms)
        .sort((a, b) => a.at_ms - b.at_ms)[0];
      if (due === undefined) break;
      this.timers = this.timers.filter((entry) => entry !== due);
      this.move(Math.max(0, due.at_ms - this.monotonicMs));
      due.action();
    }
    this.move(Math.max(0, end_ms - this.monotonicMs));
  }

  /** The computer sleeps: only the wall clock advances. */
  sleep(ms: number): void {
    this.wallMs += ms;
  }

  /** The page hangs: time advances without running timers. */
  stall(ms: number): void {
    this.move(ms);
  }

  get pending(): number {
    return this.timers.length;
  }

  private move(ms: number): void {
    this.monotonicMs += ms;
    this.wallMs += ms;
  }
}
