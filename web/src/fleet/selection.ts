import { type Accessor, createSignal } from "solid-js";
import type { VehicleView } from "../protocol";
import { vehicleKey } from "./vehicleStatus";

/** The selected vehicles by `vehicleKey`, in order of selection. Only the operator selects. */
export interface Selection {
  readonly keys: Accessor<readonly number[]>;
  has(key: number): boolean;
  /** Selects only this vehicle. */
  only(key: number): void;
  toggle(key: number): void;
  all(keys: readonly number[]): void;
  clear(): void;
  /** Removes vehicles that are not in `present`. */
  keep(present: readonly number[]): void;
}

export function createSelection(): Selection {
  const [keys, setKeys] = createSignal<readonly number[]>([]);
  const without = (key: number) => keys().filter((other) => other !== key);
  const has = (key: number) => keys().includes(key);
  return {
    keys,
    has,
    only: (key) => setKeys([key]),
    toggle: (key) => setKeys(has(key) ? without(key) : [...keys(), key]),
    all: (all) => setKeys([...all]),
    clear: () => setKeys([]),
    keep: (present) => {
      const kept = keys().filter((key) => present.includes(key));
      if (kept.length !== keys().length) setKeys(kept);
    },
  };
}

/** The selected vehicles in the fleet's order. */
export function selectedVehicles(
  vehicles: readonly VehicleView[],
  selection: Selection,
): VehicleView[] {
  return vehicles.filter((vehicle) => selection.has(vehicleKey(vehicle)));
}
