/** The console's time source. Everything that waits or measures takes a `Clock`; tests pass a fake. */

/** One moment on both local clocks, in milliseconds. Only differences are meaningful. */
export interface Instant {
  /** Never jumps, but may stop while the computer sleeps. */
  readonly monotonicMs: number;
  /** Runs while the computer sleeps, but may be set. */
  readonly wallMs: number;
}

export interface Clock {
  now(): Instant;
  /** Runs `action` once after `delayMs`; the returned function cancels it. */
  after(delayMs: number, action: () => void): () => void;
}

export const browserClock: Clock = {
  now: () => ({ monotonicMs: performance.now(), wallMs: Date.now() }),
  after: (delayMs, action) => {
    const timer = setTimeout(action, delayMs);
    return () => clearTimeout(timer);
  },
};
