import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";

/** An order with its own button, and how it is confirmed. */
export interface OrderKind {
  readonly kind: "hover" | "land" | "return_home";
  /** How long the button must be held, milliseconds; 0 for one press. */
  readonly hold_ms: number;
  /** Key to hold together with Shift, for as long as the button. */
  readonly key: string;
}

/**
 * Hover brings a vehicle to rest, which is safe and can be taken back: one press, since seconds count.
 * Landing and return move it where it cannot stop at once: 1.5 s, longer than an accidental touch.
 */
export const ORDER_KINDS: readonly OrderKind[] = [
  { kind: "hover", hold_ms: 0, key: "H" },
  { kind: "return_home", hold_ms: 1500, key: "R" },
  { kind: "land", hold_ms: 1500, key: "L" },
];

/** The selected vehicles an order can be sent to, and those it cannot. */
export interface Targets {
  readonly serials: readonly string[];
  /** Vehicle labels, in the order of `serials`. */
  readonly labels: readonly string[];
  /** Labels of selected vehicles whose serial number is not known yet. */
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

/** A key that changes with the target vehicles; empty without any. */
export function targetsKey(targets: Targets): string {
  return targets.serials.length === 0 ? "" : JSON.stringify(targets.serials);
}
