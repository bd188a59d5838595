import type { SurveyingView, SurveyView, VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { agedBy, formatAge, formatQuantity, groundSpeedMps } from "../text/quantities";
import { formatHeight } from "../text/units";
import type { FleetView } from "./fleetView";
import { vehicleStatus } from "./vehicleStatus";

const { names } = text.activity;

/** Whether a survey of a phase has begun and is not over. */
const IS_ACTIVE: Readonly<Record<SurveyView["phase"], boolean>> = {
  planning: false,
  refused: false,
  created: false,
  running: true,
  paused: true,
  aborted: false,
  done: false,
};

/** The surveys that are running or paused. */
export function activeSurveys(surveys: readonly SurveyView[]): readonly SurveyView[] {
  return surveys.filter(({ phase }) => IS_ACTIVE[phase]);
}

/** A vehicle's part in a survey that is running or paused; null without one. */
export function surveyPart(
  surveys: FleetView["surveys"],
  serial: string | null,
): SurveyingView | null {
  const parts = activeSurveys(surveys).flatMap(({ vehicles }) => vehicles);
  return parts.find((part) => part.serial === serial) ?? null;
}

/** What a vehicle is doing, in a line: `Surveying · 60 m · 8.0 m/s`, `Contact lost · 12 s`. */
export function doing(vehicle: VehicleView, part: SurveyingView | null, behindS: number): string {
  const { activity } = vehicleStatus(vehicle, behindS);
  switch (activity) {
    case "Contact lost":
      return `${names[activity]} · ${formatAge(agedBy(vehicle.telemetry_age_s, behindS))}`;
    case "Unidentified":
      return text.activity.waitingForSerial;
    case "On the ground":
      if (vehicle.is_stopped) return text.activity.onGroundStopped;
      return part?.takes_off_automatically === true ? text.activity.mayTakeOff : names[activity];
    case "Unknown":
      return text.activity.unknown;
    case "Landing":
    case "Returning":
      return [names[activity], ...figures(vehicle)].join(" · ");
    case "Flying":
      return [flight(vehicle, part), ...figures(vehicle)].join(" · ");
  }
}

function flight(vehicle: VehicleView, part: SurveyingView | null): string {
  if (vehicle.is_stopped) return text.activity.allStop;
  if (part?.is_flying_rows === true) return text.activity.surveying;
  if (vehicle.steering !== null && !vehicle.steering.has_arrived) return text.activity.toTarget;
  return isStill(vehicle) ? text.activity.holding : names.Flying;
}

/** Slower than this a vehicle holds its place in wind. */
const STILL_MPS = 0.8;

function isStill({ velocity_ned: { north_mps, east_mps, down_mps } }: VehicleView): boolean {
  const speed = groundSpeedMps(north_mps, east_mps);
  return speed !== null && Math.hypot(speed, down_mps ?? 0) < STILL_MPS;
}

/** Height and, while it moves, speed. */
function figures(vehicle: VehicleView): string[] {
  const { north_mps, east_mps } = vehicle.velocity_ned;
  const height = formatHeight(vehicle.height_above_takeoff_m.value);
  const speed = formatQuantity(groundSpeedMps(north_mps, east_mps), "m/s", 0);
  return isStill(vehicle) ? [height] : [height, speed];
}
