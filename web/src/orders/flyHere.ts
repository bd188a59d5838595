import { type Accessor, createEffect, createMemo, createSignal, on, onCleanup } from "solid-js";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { LonLat } from "../map/localGrid";
import { positionOf } from "../map/scene";
import type { Order, VehicleView } from "../protocol";
import type { Clock } from "../source/clock";
import type { OrderRequests } from "../source/orderRequests";
import { vehicleLabel } from "../text/names";
import { createLengthField, type LengthField, numberIn } from "../text/units";
import { type Course, courseOf } from "./course";
import type { OrderApi } from "./orderApi";
import { createOrderCheck, type OrderCheck } from "./orderCheck";

/** Default speed: the vehicle stops within a few metres. */
const SPEED_MPS = 5;
/** Speed of a nudge. */
const NUDGE_MPS = 2;

/** How far a nudge moves; omitted axes do not move. */
export type NudgeBy = Partial<Record<"north_m" | "east_m" | "up_m" | "turn_deg", number>>;

/** Fly-here mode: a press on the map sets the target of the one selected vehicle. */
export interface FlyHere {
  readonly isOn: Accessor<boolean>;
  /** The selected vehicle; null unless exactly one identified vehicle is selected. */
  readonly vehicle: Accessor<VehicleView | null>;
  readonly target: Accessor<LonLat | null>;
  /** Above takeoff. */
  readonly height: LengthField;
  /** As typed: metres per second. */
  readonly speed: Accessor<string>;
  readonly course: Accessor<Course | null>;
  /** The safety gate's current result. */
  readonly check: Accessor<OrderCheck>;
  /** Changes with every part of the order; empty while the gate does not allow it. */
  readonly subject: Accessor<string>;
  toggle(): void;
  /** Clears the target, else leaves the mode. Returns false when neither was set. */
  clear(): boolean;
  aim(at: LonLat): void;
  setSpeed(text: string): void;
  confirm(): void;
  nudge(by: NudgeBy): void;
}

export function createFlyHere(
  vehicle: Accessor<VehicleView | null>,
  orders: Pick<OrderRequests, "check">,
  orderApi: Pick<OrderApi, "order">,
  clock: Clock,
): FlyHere {
  const [isOn, setOn] = createSignal(false);
  const [target, setTarget] = createSignal<LonLat | null>(null);
  const height = createLengthField(null);
  const [speed, setSpeed] = createSignal(String(SPEED_MPS));
  const key = createMemo(() => {
    const selected = vehicle();
    return selected === null ? null : vehicleKey(selected);
  });
  const order = createMemo(() => gotoOrder(target(), height.metres(), speed()));
  const serial = createMemo(() => vehicle()?.serial ?? null);
  const named = createMemo(() => {
    const [target_serial, body] = [serial(), order()];
    return !isOn() || target_serial === null || body === null
      ? null
      : { serials: [target_serial], order: body };
  });
  const check = createOrderCheck(orders, clock, named);
  const labels = () => {
    const selected = vehicle();
    return selected === null ? [] : [vehicleLabel(selected)];
  };
  const leave = () => {
    setTarget(null);
    setOn(false);
  };
  // A target set for one vehicle must not be sent to another.
  createEffect(on(key, leave, { defer: true }));
  onCleanup(leave);
  return {
    isOn,
    vehicle,
    target,
    height,
    speed,
    course: createMemo(() => courseTo(vehicle(), target(), order())),
    check,
    subject: createMemo(() => (check().kind === "allowed" ? JSON.stringify(named()) : "")),
    toggle: () => {
      const selected = vehicle();
      if (isOn()) leave();
      else if (selected !== null) {
        height.set(currentHeight_m(selected));
        setOn(true);
      }
    },
    clear: () => {
      if (!isOn()) return false;
      if (target() === null) setOn(false);
      else setTarget(null);
      return true;
    },
    aim: (at) => isOn() && setTarget(at),
    setSpeed,
    confirm: () => {
      const ready = named();
      if (ready === null) return;
      void orderApi.order(ready, labels());
      setTarget(null);
    },
    nudge: (by) => {
      const to = serial();
      if (to === null) return;
      void orderApi.order({ serials: [to], order: nudgeOrder(by) }, labels());
    },
  };
}

/** Offered to a vehicle that is not in the air, or lower than anyone flies on purpose. */
const USUAL_HEIGHT_M = 30;
const LEAST_HEIGHT_M = 5;

/** The present height in flight; a usual one for a vehicle on the ground; null while unknown. */
export function currentHeight_m(vehicle: VehicleView | null): number | null {
  const value = vehicle?.height_above_takeoff_m.value ?? null;
  if (vehicle === null || value === null) return null;
  const isLow = vehicle.is_flying.value === false || value < LEAST_HEIGHT_M;
  return isLow ? USUAL_HEIGHT_M : value;
}

/** The order from the form; null while a part is missing or not a number. */
function gotoOrder(target: LonLat | null, height_m: number | null, speed: string) {
  const speed_mps = numberIn(speed);
  if (target === null || height_m === null || speed_mps === null || speed_mps <= 0) return null;
  return {
    kind: "goto",
    latitude_deg: target.lat,
    longitude_deg: target.lon,
    height_above_takeoff_m: height_m,
    speed_mps,
  } as const satisfies Order;
}

function courseTo(
  vehicle: VehicleView | null,
  target: LonLat | null,
  order: ReturnType<typeof gotoOrder>,
): Course | null {
  const here = vehicle === null ? null : positionOf(vehicle);
  if (vehicle === null || here === null || target === null || order === null) return null;
  const climb_m = order.height_above_takeoff_m - (vehicle.height_above_takeoff_m.value ?? 0);
  return courseOf(here, target, climb_m, order.speed_mps);
}

function nudgeOrder(by: NudgeBy): Order {
  const still = { north_m: 0, east_m: 0, up_m: 0, turn_deg: 0 };
  return { kind: "nudge", ...still, ...by, speed_mps: NUDGE_MPS };
}
