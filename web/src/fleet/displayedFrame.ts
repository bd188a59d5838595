import { type Accessor, createComputed, createSignal } from "solid-js";
import type { StationState } from "../protocol";
import type { StationSource } from "../source/stationSource";
import { formatAge } from "../text/quantities";

/** A frame as a state announces it. Its age is that at the moment the state was made. */
export interface AnnouncedFrame {
  readonly id: number;
  readonly captured_age_s: number;
  readonly captured_sigma_s: number;
}

/** When a picture was taken. */
export interface Capture {
  /** Age in the newest state, seconds: one that grows from state to state. */
  readonly age_s: number;
  readonly sigma_s: number;
}

/** What is known of the picture that is on the screen. */
export interface ShownFrame {
  /** Null when the picture came without its frame's number. */
  readonly id: number | null;
  /** Null when no state has announced this very frame (yet). */
  readonly capture: Capture | null;
  /** For how long a newer frame had been announced when the newest state was made; null when none is. */
  readonly overtaken_for_s: number | null;
}

interface Heard {
  readonly id: number;
  captured_at_s: number;
  sigma_s: number;
  overtaken_at_s: number | null;
}

interface OnScreen {
  readonly id: number | null;
  /** What was announced of this very frame, by the same run of the station. */
  heard: Heard | null;
  isOfThisRun: boolean;
  overtaken_at_s: number | null;
}

/** Announcements are remembered for so many frames, for pictures that are still on the way. */
const REMEMBERED = 32;
/** A station's start, as its states tell it, does not move by more while it runs. */
const SAME_START_S = 1;

/**
 * Keeps what the station announced of the picture on the screen, however old that picture is by now:
 * its caption must never be that of a newer one which did not load.
 */
export class FrameOnScreen {
  private readonly heard = new Map<number, Heard>();
  private newest: Heard | null = null;
  private shown: OnScreen | null = null;
  private now_s = 0;
  private started_s: number | null = null;
  private runs = 0;

  /** Which run of the station the newest state is of; frame numbers start anew with each. */
  get run(): number {
    return this.runs;
  }

  /** Takes in a state and the frame it announces, if it does. */
  hear(state: Pick<StationState, "time_ns" | "station">, frame: AnnouncedFrame | null): void {
    this.now_s = state.time_ns / 1e9;
    this.noticeRestart(this.now_s - state.station.uptime_s);
    if (frame !== null) this.announce(frame);
    if (this.shown !== null) this.follow(this.shown);
  }

  /** The picture of frame `id` is on the screen from now on. */
  show(id: number | null): void {
    this.shown = { id, heard: null, isOfThisRun: true, overtaken_at_s: null };
    this.follow(this.shown);
  }

  /** Nothing is on the screen any more. */
  clear(): void {
    this.shown = null;
  }

  /** What is known of the picture on the screen; null while there is none. */
  facts(): ShownFrame | null {
    const shown = this.shown;
    if (shown === null) return null;
    const { heard } = shown;
    const overtaken_at_s = heard?.overtaken_at_s ?? shown.overtaken_at_s;
    return {
      id: shown.id,
      capture:
        heard === null ? null : { age_s: this.now_s - heard.captured_at_s, sigma_s: heard.sigma_s },
      overtaken_for_s: overtaken_at_s === null ? null : this.now_s - overtaken_at_s,
    };
  }

  private noticeRestart(started_s: number): void {
    const before_s = this.started_s;
    this.started_s = started_s;
    if (before_s === null || Math.abs(started_s - before_s) < SAME_START_S) return;
    this.runs += 1;
    this.heard.clear();
    this.newest = null;
    // The same number now means another frame, and the two clocks need not agree.
    if (this.shown !== null) {
      this.shown = { ...this.shown, heard: null, isOfThisRun: false, overtaken_at_s: null };
    }
  }

  private announce(frame: AnnouncedFrame): void {
    const captured_at_s = this.now_s - frame.captured_age_s;
    const sigma_s = frame.captured_sigma_s;
    if (this.newest?.id === frame.id) {
      Object.assign(this.newest, { captured_at_s, sigma_s });
      return;
    }
    if (this.newest !== null) this.newest.overtaken_at_s = this.now_s;
    this.newest = { id: frame.id, captured_at_s, sigma_s, overtaken_at_s: null };
    this.heard.set(frame.id, this.newest);
    for (const known of this.heard.keys()) {
      if (this.heard.size <= REMEMBERED) break;
      this.heard.delete(known);
    }
  }

  private follow(shown: OnScreen): void {
    const { id, isOfThisRun } = shown;
    if (id !== null && isOfThisRun) shown.heard ??= this.heard.get(id) ?? null;
    if (shown.heard !== null || this.newest === null) return;
    // A picture can be ahead of the states, but only of the same run.
    const isAhead = id !== null && isOfThisRun && id > this.newest.id;
    if (!isAhead) shown.overtaken_at_s ??= this.now_s;
  }
}

/** `FrameOnScreen` for a part of the page. */
export interface FrameTracker {
  readonly facts: Accessor<ShownFrame | null>;
  /** Changes when the station was started anew. */
  readonly run: Accessor<number>;
  show(id: number | null): void;
  clear(): void;
}

/** Follows the source's states; `announced` finds in each the frame this part of the page shows. */
export function createFrameOnScreen(
  source: Pick<StationSource, "state">,
  announced: (state: StationState) => AnnouncedFrame | null,
): FrameTracker {
  const frame = new FrameOnScreen();
  const [facts, setFacts] = createSignal<ShownFrame | null>(null);
  const [run, setRun] = createSignal(0);
  createComputed(() => {
    const state = source.state();
    if (state === null) return;
    frame.hear(state, announced(state));
    setRun(frame.run);
    setFacts(frame.facts());
  });
  return {
    facts,
    run,
    show: (id) => {
      frame.show(id);
      setFacts(frame.facts());
    },
    clear: () => {
      frame.clear();
      setFacts(null);
    },
  };
}

/** So long a newer picture may be on its way before its absence is told. */
const NEWER_AFTER_S = 2;

/** The picture on the screen in words: `frame 12, taken 0.8 s ago ± 0.2 s`. */
export function frameCaption(frame: ShownFrame, behindS: number): string {
  const name = frame.id === null ? "frame without a number" : `frame ${frame.id}`;
  const { capture } = frame;
  if (capture === null) return `${name}, time taken unknown`;
  return `${name}, taken ${formatAge(capture.age_s + behindS)} ago ± ${capture.sigma_s.toFixed(1)} s`;
}

/** Whether a newer frame was announced a while ago and its picture is not on the screen. */
export function lacksNewer(frame: ShownFrame, behindS: number): boolean {
  return frame.overtaken_for_s !== null && frame.overtaken_for_s + behindS > NEWER_AFTER_S;
}
