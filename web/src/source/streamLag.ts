import type { Instant } from "./clock";

/** The smallest transit time is looked for in so much of the past: longer would let clock drift pile up. */
const WINDOW_MS = 60_000;
/** The window moves in steps of this, so that memory stays small at any message rate. */
const BUCKET_MS = 5_000;

interface Bucket {
  readonly startMs: number;
  readonly least: number;
}

/**
 * How far the newest message is behind the station's present.
 *
 * Two things make it late: the time since it came in, and the time it was held up on the way. The
 * second shows as a larger difference between local and station time than the least one seen.
 */
export class StreamLag {
  private newest: { readonly stationMs: number; readonly heard: Instant } | null = null;
  private buckets: Bucket[] = [];

  /** Takes note of a message made at `stationTimeNs` and received at `heard`. */
  hear(stationTimeNs: number, heard: Instant): void {
    const stationMs = stationTimeNs / 1e6;
    this.newest = { stationMs, heard };
    this.note(heard.monotonicMs - stationMs, heard.monotonicMs);
  }

  /** Seconds to add to every age of the newest message; null before the first one. */
  behindS(now: Instant): number | null {
    if (this.newest === null) return null;
    const { stationMs, heard } = this.newest;
    const least = Math.min(...this.buckets.map((bucket) => bucket.least));
    const sinceHeardMs = Math.max(
      now.monotonicMs - heard.monotonicMs,
      // A computer that slept stops the first clock, not this one.
      now.wallMs - heard.wallMs,
    );
    const sinceMadeMs = now.monotonicMs - stationMs - least;
    return Math.max(0, sinceHeardMs, sinceMadeMs) / 1000;
  }

  /** Starts over with the first message of a new connection: the station may have been restarted. */
  restart(stationTimeNs: number, heard: Instant): void {
    this.buckets = [];
    this.hear(stationTimeNs, heard);
  }

  private note(difference: number, nowMs: number): void {
    const last = this.buckets.at(-1);
    if (last !== undefined && nowMs - last.startMs < BUCKET_MS) {
      this.buckets[this.buckets.length - 1] = {
        startMs: last.startMs,
        least: Math.min(last.least, difference),
      };
    } else {
      this.buckets.push({ startMs: nowMs, least: difference });
    }
    this.buckets = this.buckets.filter((bucket) => nowMs - bucket.startMs < WINDOW_MS);
  }
}
