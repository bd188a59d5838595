/** Time as the console knows it. Everything that waits or measures takes a `Clock`, so tests bring their own. */

/** One moment on both local clocks, in milliseconds. Only differences mean something. */
export interface Instant {
  /** Never jumps, but may stand still while the computer sleeps. */
  readonly monotonicMs: number;
  /** Goes on while the computer sleeps, but may be set. */
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
