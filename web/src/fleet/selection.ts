import { type Accessor, createSignal } from "solid-js";
import type { VehicleView } from "../protocol";

/** Which vehicles are selected, by number, in the order they were. Nothing is ever selected by itself. */
export interface Selection {
  readonly numbers: Accessor<readonly number[]>;
  has(number: number): boolean;
  /** Selects this one and no other. */
  only(number: number): void;
  toggle(number: number): void;
  all(numbers: readonly number[]): void;
  clear(): void;
  /** Drops those that are not among `present`. */
  keep(present: readonly number[]): void;
}

export function createSelection(): Selection {
  const [numbers, setNumbers] = createSignal<readonly number[]>([]);
  const without = (number: number) => numbers().filter((other) => other !== number);
  const has = (number: number) => numbers().includes(number);
  return {
    numbers,
    has,
    only: (number) => setNumbers([number]),
    toggle: (number) => setNumbers(has(number) ? without(number) : [...numbers(), number]),
    all: (all) => setNumbers([...all]),
    clear: () => setNumbers([]),
    keep: (present) => {
      const kept = numbers().filter((number) => present.includes(number));
      if (kept.length !== numbers().length) setNumbers(kept);
    },
  };
}

/** The selected vehicles in the fleet's order. */
export function selectedVehicles(
  vehicles: readonly VehicleView[],
  selection: Selection,
): VehicleView[] {
  return vehicles.filter((vehicle) => selection.has(vehicle.number));
}
