import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";

/** The orders with buttons of their own, and how each is confirmed. */
export interface OrderKind {
  readonly kind: "hover" | "land" | "return_home";
  readonly label: string;
  /** Completes "Keep holding to ...", before the vehicles' names. */
  readonly verb: string;
  /** What one must know of it before. */
  readonly note: string;
  /** How long the button is held. */
  readonly hold_ms: number;
  /** With Shift, held as long as the button. */
  readonly key: string;
}

/**
 * All three are confirmed by the same gesture, so that no hurry has to remember which is which. Hover
 * is the safe one and asks for 0.4 s: longer than a brush of the hand or a double press, shorter
 * than a thought. A second press instead could be a double press by mistake. Landing and return
 * ask for 1.5 s.
 */
export const ORDER_KINDS: readonly OrderKind[] = [
  {
    kind: "hover",
    label: "Hover",
    verb: "hover",
    note: "Stops and holds its position.",
    hold_ms: 400,
    key: "H",
  },
  {
    kind: "return_home",
    label: "Return home",
    verb: "climb to the aircraft's own go-home height and return home",
    note: "First climbs to the aircraft's own go-home height.",
    hold_ms: 1500,
    key: "R",
  },
  {
    kind: "land",
    label: "Land",
    verb: "land",
    note: "Lands where it is.",
    hold_ms: 1500,
    key: "L",
  },
];

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
