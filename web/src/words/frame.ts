import type { ShownFrame } from "../fleet/frameOnScreen";
import { formatAge } from "./age";

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
