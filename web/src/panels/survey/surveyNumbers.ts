import type { SurveyCameraView } from "../../protocol";

/**
 * How high and how fast a camera is flown for a pixel size and an overlap: as the station plans
 * (`guidance/survey/imaging.py`), which checks whatever is sent.
 */

/** Angles of a photo, and its pixels across the flight; null: not known. */
export type Lens = Pick<SurveyCameraView, "across_deg" | "along_deg"> & {
  readonly across_px: number | null;
};

/** A common 4:3 survey camera that is not in the table. */
export const OTHER: Lens = { across_deg: 66, along_deg: 52, across_px: null };

/** How far a drone may be off its place, to either side. */
const PLACE_SLACK_M = 3;
const MOST_BLUR_PX = 0.5;
const EXPOSURE_S = 1 / 1000;
const SLOWEST_MPS = 1;
/** What any aircraft flies at most, if the site allows it. */
export const FASTEST_MPS = 15;

/** The size of a pixel on the ground, metres; null without known pixels. */
export function pixelAt(lens: Lens, height_m: number): number | null {
  return lens.across_px === null ? null : side(lens.across_deg, height_m) / lens.across_px;
}

/** The height that gives a pixel size; null without known pixels. */
export function heightFor(lens: Lens, pixel_m: number): number | null {
  const oneUp_m = pixelAt(lens, 1);
  return oneUp_m === null ? null : pixel_m / oneUp_m;
}

/** What a speed depends on; with `stops` rows have waypoints within, as over uneven ground. */
export interface Flown {
  readonly height_m: number;
  readonly frontOverlap: number;
  readonly fastest_mps: number;
  readonly stops: boolean;
}

/** The highest speed with a photo every `interval_s`, rounded down to a tenth, metres per second. */
export function mostSpeed(lens: Lens, interval_s: number, flown: Flown): number {
  const along_m = side(lens.along_deg, flown.height_m);
  const seen_m = along_m - 2 * PLACE_SLACK_M;
  const photo_m = Math.min(along_m * (1 - flown.frontOverlap), flown.stops ? seen_m / 2 : seen_m);
  const pixel_m = pixelAt(lens, flown.height_m);
  const sharp_mps = pixel_m === null ? FASTEST_MPS : (MOST_BLUR_PX * pixel_m) / EXPOSURE_S;
  const most_mps = Math.min(photo_m / interval_s, sharp_mps, flown.fastest_mps);
  return Math.max(SLOWEST_MPS, Math.floor(10 * most_mps + 1e-9) / 10);
}

/** The setting of a timer that allows the highest speed, and of those the longest: fewer photos. */
export function bestInterval(lens: Lens, timer_s: readonly number[], flown: Flown): number {
  const speeds = timer_s.map((each) => mostSpeed(lens, each, flown));
  return timer_s[speeds.lastIndexOf(Math.max(...speeds))] ?? 2;
}

function side(angle_deg: number, height_m: number): number {
  return 2 * height_m * Math.tan((angle_deg * Math.PI) / 360);
}
