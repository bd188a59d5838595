import type { SurveyView } from "../protocol";
import { formatQuantity } from "./quantities";

/** A phase as it is read after the survey's name. */
export const PHASES: Readonly<Record<SurveyView["phase"], string>> = {
  planning: "is being planned",
  refused: "cannot be flown",
  created: "is planned, and waits to be started",
  running: "is being flown",
  paused: "is paused",
  aborted: "is aborted",
  done: "is done",
};

/** The survey that the map shows: one that flies, else one that may, else the newest with rows. */
export function shownSurvey(surveys: readonly SurveyView[]): SurveyView | null {
  const withRows = surveys.filter(({ cells }) => cells !== null);
  const inPhase = (phase: SurveyView["phase"]) => withRows.find((survey) => survey.phase === phase);
  return inPhase("running") ?? inPhase("paused") ?? inPhase("created") ?? withRows[0] ?? null;
}

const HECTARE_M2 = 10_000;

export function formatArea(area_m2: number): string {
  return formatQuantity(area_m2 / HECTARE_M2, "ha", 2);
}

/** A share of the region in whole per cent, rounded down: nothing is shown as more than it is. */
export function sharePercent(area_m2: number, region_m2: number): number {
  return region_m2 > 0 ? Math.floor((100 * area_m2) / region_m2 + 1e-6) : 0;
}
