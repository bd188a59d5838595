import type { Severity, Staleness, VehicleView } from "../protocol";
import { plainWords } from "../text/names";
import { agedBy } from "../text/quantities";

/**
 * What tells vehicles on the page apart: the station's number, which stays for its life. Those that
 * have not said who they are have none yet (0) and go by their link, as a negative number.
 */
export function vehicleKey(vehicle: Pick<VehicleView, "number" | "link_id">): number {
  return vehicle.number > 0 ? vehicle.number : -(vehicle.link_id ?? 0);
}

/** What a vehicle's badge shows. */
export function badgeText(vehicle: Pick<VehicleView, "number">): string {
  return vehicle.number > 0 ? String(vehicle.number) : "?";
}

/** Whether what flies is real: `mixed` is a danger and is shown as one. */
export type Simulation = "none" | "all" | "mixed";

export function simulation(vehicles: readonly Pick<VehicleView, "is_simulated">[]): Simulation {
  const simulated = vehicles.filter((vehicle) => vehicle.is_simulated).length;
  if (simulated === 0) return "none";
  return simulated === vehicles.length ? "all" : "mixed";
}

const ORDER: readonly Staleness[] = ["live", "late", "lost", "silent"];

/** The station's own tiers (newest telemetry under 1 s, 3 s, 10 s, older or never). */
export function stalenessOfAge(ageS: number | null): Staleness {
  if (ageS === null || ageS >= 10) return "silent";
  if (ageS >= 3) return "lost";
  if (ageS >= 1) return "late";
  return "live";
}

/** A vehicle's staleness at present: what the station said or worse, as its news grows old here. */
export function stalenessNow(
  vehicle: Pick<VehicleView, "staleness" | "telemetry_age_s">,
  behindS: number,
): Staleness {
  const here = stalenessOfAge(agedBy(vehicle.telemetry_age_s, behindS));
  return ORDER.indexOf(here) > ORDER.indexOf(vehicle.staleness) ? here : vehicle.staleness;
}

/** Position error to begin with, and the fastest and hardest a DJI aircraft flies on its own. */
const START_M = 3;
const FASTEST_MPS = 15;
const ACCELERATION_MPS2 = 2;

/**
 * How far a vehicle may be from where it was last seen, in metres: on with its speed, gathering more,
 * never faster than the fastest. On the ground it stays where it was.
 */
export function reachM(ageS: number, speedMps: number, isFlying: boolean): number {
  if (!isFlying) return START_M;
  const gathering = speedMps * ageS + 0.5 * ACCELERATION_MPS2 * ageS * ageS;
  return START_M + Math.min(gathering, Math.max(FASTEST_MPS, speedMps) * ageS);
}

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
