import { type Accessor, createComputed, createSignal } from "solid-js";
import type { StationState } from "../protocol";
import type { StationSource } from "../source/stationSource";
import { text } from "../text/catalogue";
import { formatAge } from "../text/quantities";

/** A frame announced in a state; ages count to the moment the state was created. */
export interface AnnouncedFrame {
  readonly id: number;
  readonly captured_age_s: number;
  readonly captured_sigma_s: number;
}

/** When a frame was captured. */
export interface Capture {
  /** Age at the time of the newest state, seconds. */
  readonly age_s: number;
  readonly sigma_s: number;
}

/** Information about the displayed picture. */
export interface FrameInfo {
  /** Null when the picture came without its frame number. */
  readonly id: number | null;
  /** Null while no state has announced this frame. */
  readonly capture: Capture | null;
  /** How long before the newest state a newer frame was announced; null without a newer frame. */
  readonly superseded_for_s: number | null;
}

interface Announcement {
  readonly id: number;
  captured_at_s: number;
  sigma_s: number;
  superseded_at_s: number | null;
}

interface CurrentPicture {
  readonly id: number | null;
  /** This frame's announcement by the same run of the station. */
  announced: Announcement | null;
  isOfThisRun: boolean;
  superseded_at_s: number | null;
}

/** Number of announcements kept for pictures that are still loading. */
const MAX_ANNOUNCEMENTS = 32;
/** A larger change of the reported start time means that the station has restarted. */
const SAME_START_S = 1;

/**
 * Keeps the announcement of the displayed picture, whatever its age: the caption must never describe a
 * newer frame whose picture did not load.
 */
export class DisplayedFrame {
  private readonly announced = new Map<number, Announcement>();
  private newest: Announcement | null = null;
  private shown: CurrentPicture | null = null;
  private now_s = 0;
  private started_s: number | null = null;
  private runs = 0;

  /** Number of station restarts seen; frame numbers start over with each run. */
  get run(): number {
    return this.runs;
  }

  /** Processes a state and the frame it announces, if any. */
  receive(state: Pick<StationState, "time_ns" | "station">, frame: AnnouncedFrame | null): void {
    this.now_s = state.time_ns / 1e9;
    this.checkRestart(this.now_s - state.station.uptime_s);
    if (frame !== null) this.announce(frame);
    if (this.shown !== null) this.matchAnnouncement(this.shown);
  }

  /** The picture of frame `id` is now displayed. */
  show(id: number | null): void {
    this.shown = { id, announced: null, isOfThisRun: true, superseded_at_s: null };
    this.matchAnnouncement(this.shown);
  }

  /** No picture is displayed now. */
  clear(): void {
    this.shown = null;
  }

  /** Information about the displayed picture; null without one. */
  info(): FrameInfo | null {
    const shown = this.shown;
    if (shown === null) return null;
    const { announced } = shown;
    const superseded_at_s = announced?.superseded_at_s ?? shown.superseded_at_s;
    return {
      id: shown.id,
      capture:
        announced === null
          ? null
          : { age_s: this.now_s - announced.captured_at_s, sigma_s: announced.sigma_s },
      superseded_for_s: superseded_at_s === null ? null : this.now_s - superseded_at_s,
    };
  }

  private checkRestart(started_s: number): void {
    const before_s = this.started_s;
    this.started_s = started_s;
    if (before_s === null || Math.abs(started_s - before_s) < SAME_START_S) return;
    this.runs += 1;
    this.announced.clear();
    this.newest = null;
    // The same number now means a different frame, and the two clocks may differ.
    if (this.shown !== null) {
      this.shown = { ...this.shown, announced: null, isOfThisRun: false, superseded_at_s: null };
    }
  }

  private announce(frame: AnnouncedFrame): void {
    const captured_at_s = this.now_s - frame.captured_age_s;
    const sigma_s = frame.captured_sigma_s;
    if (this.newest?.id === frame.id) {
      Object.assign(this.newest, { captured_at_s, sigma_s });
      return;
    }
    if (this.newest !== null) this.newest.superseded_at_s = this.now_s;
    this.newest = { id: frame.id, captured_at_s, sigma_s, superseded_at_s: null };
    this.announced.set(frame.id, this.newest);
    for (const known of this.announced.keys()) {
      if (this.announced.size <= MAX_ANNOUNCEMENTS) break;
      this.announced.delete(known);
    }
  }

  private matchAnnouncement(shown: CurrentPicture): void {
    const { id, isOfThisRun } = shown;
    if (id !== null && isOfThisRun) shown.announced ??= this.announced.get(id) ?? null;
    if (shown.announced !== null || this.newest === null) return;
    // A picture can be newer than the newest state, but only within one run.
    const isAhead = id !== null && isOfThisRun && id > this.newest.id;
    if (!isAhead) shown.superseded_at_s ??= this.now_s;
  }
}

/** A `DisplayedFrame` as signals for a component. */
export interface DisplayedFrameSignal {
  readonly info: Accessor<FrameInfo | null>;
  /** Changes when the station has restarted. */
  readonly run: Accessor<number>;
  show(id: number | null): void;
  clear(): void;
}

/** Tracks the displayed frame; `announced` picks the relevant frame from each state. */
export function createDisplayedFrame(
  source: Pick<StationSource, "state">,
  announced: (state: StationState) => AnnouncedFrame | null,
): DisplayedFrameSignal {
  const frame = new DisplayedFrame();
  const [info, setInfo] = createSignal<FrameInfo | null>(null);
  const [run, setRun] = createSignal(0);
  createComputed(() => {
    const state = source.state();
    if (state === null) return;
    frame.receive(state, announced(state));
    setRun(frame.run);
    setInfo(frame.info());
  });
  return {
    info,
    run,
    show: (id) => {
      frame.show(id);
      setInfo(frame.info());
    },
    clear: () => {
      frame.clear();
      setInfo(null);
    },
  };
}

/** A newer picture may take this long to load before the caption mentions it. */
const LOADING_S = 2;

/** Caption of the displayed picture: `frame 12, taken 0.8 s ago ± 0.2 s`. */
export function frameCaption(frame: FrameInfo, behindS: number): string {
  const { id, capture } = frame;
  const { frames } = text;
  if (capture === null)
    return id === null ? frames.unnumberedOfUnknownTime : frames.frameOfUnknownTime(id);
  const age = formatAge(capture.age_s + behindS);
  const sigma = `${capture.sigma_s.toFixed(1)} s`;
  return id === null ? frames.unnumbered(age, sigma) : frames.frame(id, age, sigma);
}

/** Whether a newer frame was announced a while ago but its picture is not displayed. */
export function isSuperseded(frame: FrameInfo, behindS: number): boolean {
  return frame.superseded_for_s !== null && frame.superseded_for_s + behindS > LOADING_S;
}
