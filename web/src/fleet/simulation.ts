import type { VehicleView } from "../protocol";

/** Whether what flies is real: `mixed` is a danger and is shown as one. */
export type Simulation = "none" | "all" | "mixed";

export function simulation(vehicles: readonly Pick<VehicleView, "is_simulated">[]): Simulation {
  const simulated = vehicles.filter((vehicle) => vehicle.is_simulated).length;
  if (simulated === 0) return "none";
  return simulated === vehicles.length ? "all" : "mixed";
}
