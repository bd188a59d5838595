import type { CameraClockView, PhotoJobView, PhotoStepView } from "../protocol";
import { text } from "./catalogue";
import { formatFraction, formatQuantity } from "./quantities";
import { formatArea } from "./survey";

/** Seconds to add to a camera's clock, with their sign: `−5 h 00 min 37.6 s`. */
export function offsetText(offset_s: number): string {
  const tenths = Math.round(Math.abs(offset_s) * 10);
  const hours = Math.floor(tenths / 36_000);
  const minutes = Math.floor((tenths % 36_000) / 60 / 10);
  const seconds = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
  const sign = offset_s < 0 ? "−" : "+";
  return `${sign}${hours} h ${String(minutes).padStart(2, "0")} min ${seconds} s`;
}

/** A camera and its clock, as name and value. */
export function clockLine(clock: CameraClockView): readonly [string, string] {
  const offset = offsetText(clock.offset_s);
  const known = clock.is_stated ? text.photos.stated(offset) : text.photos.reported(offset);
  const found = text.photos.offset(offset, formatQuantity(2 * clock.sigma_s, "s"));
  return [
    text.photos.clock(clock.camera, clock.vehicle, clock.photos),
    clock.is_stated || clock.is_reported ? known : found,
  ];
}

/** How much of a mosaic is in sun. */
export function mosaicText(mosaic: NonNullable<PhotoJobView["mosaic"]>): string {
  const { sun_m2, shade_m2, unknown_m2, missing_m2, resolution_m } = mosaic;
  const all_m2 = sun_m2 + shade_m2 + unknown_m2 + missing_m2;
  const share = formatFraction(all_m2 > 0 ? sun_m2 / all_m2 : null);
  return text.photos.mosaicShare(
    share,
    formatArea(all_m2),
    formatQuantity(100 * resolution_m, "cm", 0),
  );
}

/** What a step does, or how it ended. */
export function stepState(step: PhotoStepView, job: PhotoJobView): string {
  if (step.state !== "running" || job.doing === "") return text.photos.states[step.state];
  return job.share === null ? job.doing : text.photos.doing(job.doing, formatFraction(job.share));
}

/** A sentence of a command, whose options are fields of the panel. */
export function inPanelWords(sentence: string): string {
  const words = sentence
    .replace("--clock-offset", text.photos.ofCamera(text.photos.clockOffset))
    .replace("--field", text.photos.ofCamera(text.photos.field));
  return words.charAt(0).toUpperCase() + words.slice(1);
}
