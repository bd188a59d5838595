import type { Severity, Staleness, VehicleView } from "../protocol";
import { plainWords } from "../text/names";
import { agedBy } from "../text/quantities";

/**
 * Identifies a vehicle on the page: the station's number, which never changes. An unidentified vehicle
 * has none (0) and is keyed by its link, as a negative number.
 */
export function vehicleKey(vehicle: Pick<VehicleView, "number" | "link_id">): number {
  return vehicle.number > 0 ? vehicle.number : -(vehicle.link_id ?? 0);
}

/** Text of a vehicle's badge. */
export function badgeText(vehicle: Pick<VehicleView, "number">): string {
  return vehicle.number > 0 ? String(vehicle.number) : "?";
}

/** Which vehicles are simulated; `mixed` is dangerous and shown as such. */
export type Simulation = "none" | "all" | "mixed";

export function simulation(vehicles: readonly Pick<VehicleView, "is_simulated">[]): Simulation {
  const simulated = vehicles.filter((vehicle) => vehicle.is_simulated).length;
  if (simulated === 0) return "none";
  return simulated === vehicles.length ? "all" : "mixed";
}

/** 0 for the newest telemetry. */
const STALENESS_RANKS: Readonly<Record<Staleness, number>> = {
  live: 0,
  late: 1,
  lost: 2,
  silent: 3,
};

/** The station's staleness tiers: telemetry younger than 1 s, 3 s, 10 s; older or never received. */
export function stalenessOfAge(ageS: number | null): Staleness {
  if (ageS === null || ageS >= 10) return "silent";
  if (ageS >= 3) return "lost";
  if (ageS >= 1) return "late";
  return "live";
}

/** A vehicle's current staleness: the station's value, or worse as the state ages on this page. */
export function stalenessNow(
  vehicle: Pick<VehicleView, "staleness" | "telemetry_age_s">,
  behindS: number,
): Staleness {
  const here = stalenessOfAge(agedBy(vehicle.telemetry_age_s, behindS));
  return STALENESS_RANKS[here] > STALENESS_RANKS[vehicle.staleness] ? here : vehicle.staleness;
}

/** Initial position error, and the highest speed and acceleration of a DJI aircraft on a mission. */
const START_M = 3;
const FASTEST_MPS = 15;
const ACCELERATION_MPS2 = 2;

/**
 * How far a vehicle may be from its last position, metres: it keeps its speed, accelerates, and never
 * exceeds the highest speed. On the ground it does not move.
 */
export function reachM(ageS: number, speedMps: number, isFlying: boolean): number {
  if (!isFlying) return START_M;
  const accelerated_m = speedMps * ageS + 0.5 * ACCELERATION_MPS2 * ageS * ageS;
  return START_M + Math.min(accelerated_m, Math.max(FASTEST_MPS, speedMps) * ageS);
}

export type VehicleActivity =
  | "Contact lost"
  | "Unidentified"
  | "Landing"
  | "Returning"
  | "Flying"
  | "On the ground"
  | "Unknown";

/** What a vehicle is doing, and the severity of that (null: normal). */
export interface VehicleStatus {
  readonly activity: VehicleActivity;
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

/** A vehicle's status; `behindS` is the age of the newest state on this page, seconds. */
export function vehicleStatus(vehicle: VehicleView, behindS: number): VehicleStatus {
  const staleness = stalenessNow(vehicle, behindS);
  if (staleness === "lost" || staleness === "silent") {
    const mayBeFlying = vehicle.is_flying.value !== false;
    return { activity: "Contact lost", severity: mayBeFlying ? "critical" : "warning" };
  }
  if (vehicle.serial === null) return { activity: "Unidentified", severity: "warning" };
  const isConflicting = vehicle.conflict_link_ids.length > 0;
  const severity = isConflicting ? "error" : staleness === "late" ? "warning" : null;
  return { activity: activityOf(vehicle), severity };
}

function activityOf(vehicle: VehicleView): VehicleActivity {
  if (vehicle.is_flying.value === null) return "Unknown";
  if (!vehicle.is_flying.value) return "On the ground";
  if (isLanding(vehicle)) return "Landing";
  if (RETURN_MODES.includes(mode(vehicle))) return "Returning";
  return "Flying";
}

/** Whether a vehicle flies as far as anyone can tell now: one whose contact is lost is counted apart. */
export function isFlyingNow(vehicle: VehicleView, behindS: number): boolean {
  const isHeard = vehicleStatus(vehicle, behindS).activity !== "Contact lost";
  return isHeard && vehicle.is_flying.value === true;
}
