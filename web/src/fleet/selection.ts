import { type Accessor, createSignal } from "solid-js";
import type { VehicleView } from "../protocol";
import { vehicleKey } from "./vehicleStatus";

/** Which vehicles are selected, by `vehicleKey`, in the order they were. Nothing is ever selected by itself. */
export interface Selection {
  readonly keys: Accessor<readonly number[]>;
  has(key: number): boolean;
  /** Selects this one and no other. */
  only(key: number): void;
  toggle(key: number): void;
  all(keys: readonly number[]): void;
  clear(): void;
  /** Drops those that are not among `present`. */
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
