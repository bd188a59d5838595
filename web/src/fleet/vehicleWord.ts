import type { Severity, VehicleView } from "../protocol";
import { plainWords } from "../words/names";
import { stalenessNow } from "./staleness";

export type VehicleWord =
  | "No contact"
  | "Unidentified"
  | "Landing"
  | "Returning"
  | "Flying"
  | "On ground"
  | "Unknown";

/** What a vehicle is doing, in one word and how grave that is (null: as it should be). */
export interface VehicleCondition {
  readonly word: VehicleWord;
  readonly severity: Severity | null;
}

const LANDING_MODES = ["auto landing", "confirm landing"];
const RETURN_MODES = ["go home"];

function mode(vehicle: Pick<VehicleView, "flight_mode">): string {
  return plainWords(vehicle.flight_mode.value ?? "");
}

export function isLanding(vehicle: Pick<VehicleView, "flight_mode" | "is_flying">): boolean {
  return vehicle.is_flying.value === true && LANDING_MODES.includes(mode(vehicle));
}

/** The word for a vehicle; `behindS` is how old the station's news is here. */
export function vehicleCondition(vehicle: VehicleView, behindS: number): VehicleCondition {
  const staleness = stalenessNow(vehicle, behindS);
  if (staleness === "lost" || staleness === "silent") {
    const isAloft = vehicle.is_flying.value !== false;
    return { word: "No contact", severity: isAloft ? "critical" : "warning" };
  }
  if (vehicle.serial === null) return { word: "Unidentified", severity: "warning" };
  const isConflicting = vehicle.conflict_link_ids.length > 0;
  const severity = isConflicting ? "error" : staleness === "late" ? "warning" : null;
  return { word: doing(vehicle), severity };
}

function doing(vehicle: VehicleView): VehicleWord {
  if (vehicle.is_flying.value === null) return "Unknown";
  if (!vehicle.is_flying.value) return "On ground";
  if (isLanding(vehicle)) return "Landing";
  if (RETURN_MODES.includes(mode(vehicle))) return "Returning";
  return "Flying";
}
