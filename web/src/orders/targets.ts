import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../words/names";

/** The vehicles an order would go to, and the selected ones it cannot go to. */
export interface Targets {
  readonly serials: readonly string[];
  /** What the order names, in the same order as `serials`. */
  readonly labels: readonly string[];
  /** Selected vehicles whose app has not said which aircraft it is. */
  readonly unreachable: readonly string[];
}

export function targetsOf(selected: readonly VehicleView[]): Targets {
  const known = selected.filter((vehicle) => vehicle.serial !== null);
  return {
    serials: known.flatMap((vehicle) => (vehicle.serial === null ? [] : [vehicle.serial])),
    labels: known.map(vehicleLabel),
    unreachable: selected.filter((vehicle) => vehicle.serial === null).map(vehicleLabel),
  };
}

/** Changes whenever the order would go to other vehicles; empty when it would go to none. */
export function targetsKey(targets: Targets): string {
  return targets.serials.length === 0 ? "" : JSON.stringify(targets.serials);
}
