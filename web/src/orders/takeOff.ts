import { positionOf } from "../map/scene";
import type { NamedOrder, VehicleView } from "../protocol";

/** A vehicle climbs this high over its place, metres above takeoff, and holds there. */
export const TAKEOFF_HEIGHT_M = 30;
const CLIMB_MPS = 3;

/**
 * The takeoff of a vehicle that stands on the ground; null for any other. A model that flies missions climbs over its
 * place by one; any other takes off by a hover, to the height of its app.
 */
export function takeoffOrder(vehicle: VehicleView): NamedOrder | null {
  const { serial, is_flying, flies_missions } = vehicle;
  const here = positionOf(vehicle);
  if (serial === null || is_flying.value !== false || here === null) return null;
  if (!flies_missions) return { serials: [serial], order: { kind: "hover" }, takeoff: true };
  const at = (height_above_takeoff_m: number) => ({
    latitude_deg: here.lat,
    longitude_deg: here.lon,
    height_above_takeoff_m,
    speed_mps: CLIMB_MPS,
    corner_radius_m: 0.2,
  });
  const waypoints = [at(TAKEOFF_HEIGHT_M / 2), at(TAKEOFF_HEIGHT_M)];
  return {
    serials: [serial],
    order: { kind: "mission", waypoints, land_at_end: false, curved: false },
    takeoff: true,
  };
}
