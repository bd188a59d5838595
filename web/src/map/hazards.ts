import { reachM, stalenessNow } from "../fleet/vehicleStatus";
import type { HazardView, VehicleView } from "../protocol";
import { agedBy, groundSpeedMps } from "../text/quantities";
import type { Point } from "./features";
import { type LonLat, metresPerDegree } from "./localGrid";
import { positionOf } from "./scene";

/** Largest radius drawn. */
const WIDEST_M = 2000;

/** Area a lost vehicle may be in: a circle, and the corridor to its home. */
export interface HazardShape {
  readonly centre: LonLat;
  readonly radius_m: number;
  /** From the last position to home; empty if the vehicle stays there or home is unknown. */
  readonly corridor: readonly Point[];
  readonly corridorHalfWidth_m: number;
}

/**
 * The hazard area of a vehicle. The station reports it for lost vehicles until it is cleared; when the
 * state itself is old on this page, the page computes one.
 */
export function hazardOf(vehicle: VehicleView, behindS: number): HazardShape | null {
  if (vehicle.hazard !== null) return ofStation(vehicle.hazard, behindS);
  const wasConnected = vehicle.staleness === "live" || vehicle.staleness === "late";
  const isLate = wasConnected && stalenessNow(vehicle, behindS) !== "live";
  return isLate ? ofPage(vehicle, behindS) : null;
}

function ofStation(hazard: HazardView, behindS: number): HazardShape {
  const grown_m = hazard.radius_m + hazard.growth_mps * behindS;
  return {
    centre: { lon: hazard.longitude_deg, lat: hazard.latitude_deg },
    radius_m: Math.min(grown_m, Math.max(hazard.largest_radius_m, hazard.radius_m)),
    corridor: hazard.corridor.map(([lon, lat]): Point => [lon, lat]),
    corridorHalfWidth_m: hazard.corridor_half_width_m,
  };
}

function ofPage(vehicle: VehicleView, behindS: number): HazardShape | null {
  const centre = positionOf(vehicle);
  const ageS = agedBy(vehicle.position.age_s, behindS);
  if (centre === null || ageS === null) return null;
  const { north_mps, east_mps } = vehicle.velocity_ned;
  // With unknown speed assume 15 m/s, the most DJI missions allow.
  const speedMps = groundSpeedMps(north_mps, east_mps) ?? 15;
  const radius_m = Math.min(WIDEST_M, reachM(ageS, speedMps, vehicle.is_flying.value !== false));
  return { centre, radius_m, corridor: [], corridorHalfWidth_m: 0 };
}

/** The band of width 2 `half_m` around a line, as a closed ring. */
export function band(from: Point, to: Point, half_m: number): Point[] {
  const per = metresPerDegree(from[1]);
  const east_m = (to[0] - from[0]) * per.lon;
  const north_m = (to[1] - from[1]) * per.lat;
  const length_m = Math.hypot(east_m, north_m);
  if (length_m === 0) return [];
  const lon = ((-north_m / length_m) * half_m) / per.lon;
  const lat = ((east_m / length_m) * half_m) / per.lat;
  const start: Point = [from[0] + lon, from[1] + lat];
  return [
    start,
    [to[0] + lon, to[1] + lat],
    [to[0] - lon, to[1] - lat],
    [from[0] - lon, from[1] - lat],
    start,
  ];
}
