import type { SurveyEstimateView, SurveyView } from "../protocol";
import { text } from "./catalogue";
import { personName } from "./names";
import { formatQuantity, UNKNOWN } from "./quantities";
import { formatLength, withLengthUnit } from "./units";

/** A survey's status as text; one whose drones have all stopped is not running. */
export function surveyStatus({ phase, vehicles }: SurveyView): string {
  const isStopped = phase === "running" && !vehicles.some((vehicle) => vehicle.is_flying_rows);
  return isStopped ? text.surveys.stopped : text.surveys.phases[phase];
}

/** About how long a running survey still takes, from how fast it has imaged so far; null if unknown. */
export function timeLeft({ phase, planner, figures, age_s, vehicles }: SurveyView): string | null {
  const isFlown = phase === "running" && vehicles.some((vehicle) => vehicle.is_flying_rows);
  if (!isFlown || figures === null || age_s < LEAST_AGE_S) return null;
  const [done_m2, left_m2] =
    planner === ANY_LIGHT ? imagedAndLeft(figures) : imagedInSunAndLeft(figures);
  if (done_m2 < LEAST_SHARE * figures.region_m2 || left_m2 <= 0) return null;
  const left_s = (left_m2 / done_m2) * age_s;
  return left_s < 60 ? text.surveys.underMinute : text.surveys.minutesLeft(Math.round(left_s / 60));
}

type Figures = NonNullable<SurveyView["figures"]>;

function imagedAndLeft({ region_m2, not_yet_m2 }: Figures): [number, number] {
  return [region_m2 - not_yet_m2, not_yet_m2];
}

/** Ground outside all shade maps is imaged once, in whatever light. */
function imagedInSunAndLeft({ reached_m2, in_sun_m2, not_shown_m2 }: Figures): [number, number] {
  const done_m2 = in_sun_m2 + not_shown_m2;
  return [done_m2, reached_m2 - done_m2];
}

/** The planner that flies all rows in whatever light; the others fly again what is in shade. */
export const ANY_LIGHT = "lawnmower_once";

/** Before that a rate means nothing. */
const LEAST_AGE_S = 60;
const LEAST_SHARE = 0.1;

/** The survey shown on the map: a running one, else paused, else planned, else the newest with rows. */
export function shownSurvey(surveys: readonly SurveyView[]): SurveyView | null {
  const withRows = surveys.filter(({ cells }) => cells !== null);
  const inPhase = (phase: SurveyView["phase"]) => withRows.find((survey) => survey.phase === phase);
  return inPhase("running") ?? inPhase("paused") ?? inPhase("created") ?? withRows[0] ?? null;
}

/** What a drone does whose mission was stopped by an order, as `person` reads it; null for another reason. */
export function stoppedText(reason: string, person: string | null): string | null {
  const [, order, by] = /^mission stopped: (.*\bby )?(.*)$/.exec(withLengthUnit(reason)) ?? [];
  if (by === undefined) return null;
  const name = personName(by);
  return text.surveys.stoppedBy(order ?? "", name === person ? text.surveys.you : name);
}

const HECTARE_M2 = 10_000;

export function formatArea(area_m2: number): string {
  return formatQuantity(area_m2 / HECTARE_M2, "ha", 1);
}

/** A share of the region in whole per cent, rounded down so that coverage never reads too high. */
export function sharePercent(area_m2: number, region_m2: number): number {
  return region_m2 > 0 ? Math.floor((100 * area_m2) / region_m2 + 1e-6) : 0;
}

/** What a survey will take, as name and value. */
export function estimateFacts(found: SurveyEstimateView): (readonly [string, string])[] {
  const cm = found.gsd_m === null ? null : 100 * found.gsd_m;
  const speed = `${formatQuantity(found.speed_limit_mps, "m/s")}: ${found.speed_limited_by}`;
  return [
    [text.estimate.time, minutes(found.time_s)],
    [text.estimate.inAir, minutes(found.flown_s)],
    [text.estimate.photosOnRows, count(found.photos)],
    [text.estimate.photos, count(found.photos_in_all)],
    [text.estimate.batteries, count(found.batteries)],
    ...aboveGround(found),
    [text.estimate.pixel, formatQuantity(cm, "cm")],
    [text.estimate.fastest, speed],
  ];
}

/** The same of a form, in a line. */
export function draftFacts(found: SurveyEstimateView, drones: number): string {
  return text.estimate.draft({
    drones: Math.max(1, drones),
    time: minutes(found.time_s),
    batteries: found.batteries,
    photos: found.photos_in_all,
  });
}

/** How high rows are above the ground over the region, where the ground is known. */
function aboveGround(found: SurveyEstimateView): (readonly [string, string])[] {
  const { least_height_above_ground_m: least_m, most_height_above_ground_m: most_m } = found;
  if (least_m === null || most_m === null) return [];
  const [least, most] = [formatLength(least_m), formatLength(most_m)];
  const range = least === most ? least : text.estimate.range(least, most);
  return [[text.estimate.aboveGround, range]];
}

/** The height of a survey, or of a flown region, with its reference. */
export function surveyHeight(
  survey: Pick<SurveyView, "height_above_ground_m" | "height_above_takeoff_m">,
): string {
  const { height_above_ground_m: ground_m, height_above_takeoff_m: takeoff_m } = survey;
  return ground_m === null
    ? text.surveys.aboveTakeoff(formatLength(takeoff_m))
    : text.surveys.aboveGround(formatLength(ground_m));
}

/** Whole minutes, rounded up: a battery never lasts longer than it reads. */
function minutes(seconds: number | null): string {
  return seconds === null ? UNKNOWN : `${Math.ceil(seconds / 60)}\u00a0min`;
}

function count(value: number | null): string {
  return value === null ? UNKNOWN : `${value}`;
}
