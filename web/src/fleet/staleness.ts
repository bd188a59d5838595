import type { Staleness, VehicleView } from "../protocol";
import { agedBy } from "../words/age";

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
