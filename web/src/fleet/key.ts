import type { VehicleView } from "../protocol";

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
