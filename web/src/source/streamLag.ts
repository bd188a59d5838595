import type { Instant } from "./clock";

/** Window for the smallest clock offset; a longer one would accumulate clock drift. */
const WINDOW_MS = 60_000;
/** The window moves in steps of this, so memory is bounded at any message rate. */
const BUCKET_MS = 5_000;

interface Bucket {
  readonly startMs: number;
  readonly leastOffsetMs: number;
}

/**
 * How far the newest message lags behind the station's present time.
 *
 * The lag is the time since the message arrived, or its delay on the network if that is larger. The
 * delay is the offset between local and station time above the smallest offset in the window.
 */
export class StreamLag {
  private newest: { readonly stationMs: number; readonly receivedAt: Instant } | null = null;
  private buckets: Bucket[] = [];

  /** Records a message created at `stationTimeNs` and received at `receivedAt`. */
  record(stationTimeNs: number, receivedAt: Instant): void {
    const stationMs = stationTimeNs / 1e6;
    this.newest = { stationMs, receivedAt };
    this.updateWindow(receivedAt.monotonicMs - stationMs, receivedAt.monotonicMs);
  }

  /** Seconds to add to every age of the newest message; null before the first one. */
  behindS(now: Instant): number | null {
    if (this.newest === null) return null;
    const { stationMs, receivedAt } = this.newest;
    const leastOffsetMs = Math.min(...this.buckets.map((bucket) => bucket.leastOffsetMs));
    const sinceReceivedMs = Math.max(
      now.monotonicMs - receivedAt.monotonicMs,
      // The monotonic clock may stop while the computer sleeps.
      now.wallMs - receivedAt.wallMs,
    );
    const sinceCreatedMs = now.monotonicMs - stationMs - leastOffsetMs;
    return Math.max(0, sinceReceivedMs, sinceCreatedMs) / 1000;
  }

  /** Resets with the first message of a new connection: the station may have restarted. */
  restart(stationTimeNs: number, receivedAt: Instant): void {
    this.buckets = [];
    this.record(stationTimeNs, receivedAt);
  }

  private updateWindow(offsetMs: number, nowMs: number): void {
    const last = this.buckets.at(-1);
    if (last !== undefined && nowMs - last.startMs < BUCKET_MS) {
      this.buckets[this.buckets.length - 1] = {
        startMs: last.startMs,
        leastOffsetMs: Math.min(last.leastOffsetMs, offsetMs),
      };
    } else {
      this.buckets.push({ startMs: nowMs, leastOffsetMs: offsetMs });
    }
    this.buckets = this.buckets.filter((bucket) => nowMs - bucket.startMs < WINDOW_MS);
  }
}
