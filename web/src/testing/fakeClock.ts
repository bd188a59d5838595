import type { Clock, Instant } from "../source/clock";

interface Waiting {
  readonly at_ms: number;
  readonly action: () => void;
}

/** A clock that stands still until a test moves it. */
export class FakeClock implements Clock {
  private monotonicMs = 1000;
  private wallMs = 1_700_000_000_000;
  private waiting: Waiting[] = [];

  now(): Instant {
    return { monotonicMs: this.monotonicMs, wallMs: this.wallMs };
  }

  after(delayMs: number, action: () => void): () => void {
    const entry = { at_ms: this.monotonicMs + delayMs, action };
    this.waiting.push(entry);
    return () => {
      this.waiting = this.waiting.filter((other) => other !== entry);
    };
  }

  /** Lets time pass, running what falls due on the way, in order. */
  advance(ms: number): void {
    const end_ms = this.monotonicMs + ms;
    for (;;) {
      const due = this.waiting
        .filter((entry) => entry.at_ms <= end_ms)
        .sort((a, b) => a.at_ms - b.at_ms)[0];
      if (due === undefined) break;
      this.waiting = this.waiting.filter((entry) => entry !== due);
      this.move(Math.max(0, due.at_ms - this.monotonicMs));
      due.action();
    }
    this.move(Math.max(0, end_ms - this.monotonicMs));
  }

  /** The computer sleeps: only the wall clock goes on. */
  sleep(ms: number): void {
    this.wallMs += ms;
  }

  /** The page hangs: time passes and nothing runs until it is through. */
  stall(ms: number): void {
    this.move(ms);
  }

  get pending(): number {
    return this.waiting.length;
  }

  private move(ms: number): void {
    this.monotonicMs += ms;
    this.wallMs += ms;
  }
}
