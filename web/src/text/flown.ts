import type { FlownRegionView } from "../protocol";
import { text } from "./catalogue";
import { formatDay } from "./replay";
import { ANY_LIGHT, formatArea, sharePercent } from "./survey";

/** Which imaged cells a survey leaves out: those since it was begun, those since a day, or none. */
export type LeftOut = "begun" | "none" | { readonly since: string };

/** Most days that a line names. */
const NAMED_DAYS = 3;
/** A region with less left than this is complete, as for the station. */
const COMPLETE_SHARE = 0.01;

/** How much a survey would fly of a region. */
export function left_m2(region: FlownRegionView, leftOut: LeftOut): number {
  if (leftOut === "begun") return region.left_m2;
  if (leftOut === "none") return region.reached_m2;
  const isAnyLight = region.planner === ANY_LIGHT;
  const done_m2 = region.days
    .filter(({ day }) => day >= leftOut.since)
    .reduce((sum, day) => sum + (isAnyLight ? day.imaged_m2 : day.in_sun_m2), 0);
  return Math.max(0, region.reached_m2 - done_m2);
}

/** Whether a part of it was flown, and not all: then it can be resumed. */
export function isUnfinished(region: FlownRegionView): boolean {
  const { left_m2: left, reached_m2: reached } = region;
  return left < reached && left > COMPLETE_SHARE * reached;
}

/** How much is left, in per cent and hectares. */
export function leftText(region: FlownRegionView, leftOut: LeftOut): string {
  const left = left_m2(region, leftOut);
  if (left <= COMPLETE_SHARE * region.reached_m2) return text.flown.complete;
  // Rounded up: what reads 0 % is flown.
  const percent = 100 - sharePercent(region.reached_m2 - left, region.reached_m2);
  return text.flown.left(percent, formatArea(left));
}

/** On which days it was flown, and how much each time. */
export function flownText(region: FlownRegionView, today: string): string {
  const named = region.days
    .slice(0, NAMED_DAYS)
    .map(({ day, imaged_m2 }) => text.flown.day(dayText(day, today), formatArea(imaged_m2)));
  const more = region.days.length - named.length;
  return text.flown.days(more > 0 ? [...named, text.flown.older(more)] : named);
}

/** A day of the station's calendar, `2026-05-01`. */
export function dayText(day: string, today: string): string {
  return day === today ? text.flown.today : formatDay(new Date(`${day}T12:00`).getTime());
}
