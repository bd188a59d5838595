import { type Accessor, createEffect, createMemo, createSignal, on, onCleanup } from "solid-js";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { LonLat } from "../map/localGrid";
import { positionOf } from "../map/scene";
import type { Order, VehicleView } from "../protocol";
import type { Clock } from "../source/clock";
import type { StationSource } from "../source/stationSource";
import { vehicleLabel } from "../text/names";
import { type Course, courseOf } from "./course";
import type { Desk } from "./orderApi";
import { createJudgement, type Judgement } from "./orderCheck";

/** The way one flies when nothing else is said: brisk, and stopped within a few metres. */
const SPEED_MPS = 5;
/** Of a nudge, which is for inching. */
const NUDGE_MPS = 2;

/** By how much a nudge moves; what is left out stays. */
export type NudgeBy = Partial<Record<"north_m" | "east_m" | "up_m" | "turn_deg", number>>;

/** The mode in which a press on the map says where the one selected vehicle is to fly. */
export interface FlyHere {
  readonly isOn: Accessor<boolean>;
  /** Whom it is about; null while not exactly one vehicle that is known is selected. */
  readonly vehicle: Accessor<VehicleView | null>;
  readonly target: Accessor<LonLat | null>;
  /** As typed, metres above takeoff and metres per second. */
  readonly height: Accessor<string>;
  readonly speed: Accessor<string>;
  readonly course: Accessor<Course | null>;
  /** What the gate says to it now. */
  readonly judgement: Accessor<Judgement>;
  /** Changes with everything that would be ordered; empty while the gate does not allow it. */
  readonly subject: Accessor<string>;
  toggle(): void;
  /** Takes one step back: the target first, then the mode. False when there was nothing to take back. */
  clear(): boolean;
  aim(at: LonLat): void;
  setHeight(text: string): void;
  setSpeed(text: string): void;
  confirm(): void;
  nudge(by: NudgeBy): void;
}

export function createFlyHere(
  vehicle: Accessor<VehicleView | null>,
  source: Pick<StationSource, "check">,
  desk: Pick<Desk, "order">,
  clock: Clock,
): FlyHere {
  const [isOn, setOn] = createSignal(false);
  const [target, setTarget] = createSignal<LonLat | null>(null);
  const [height, setHeight] = createSignal("");
  const [speed, setSpeed] = createSignal(String(SPEED_MPS));
  const key = createMemo(() => {
    const one = vehicle();
    return one === null ? null : vehicleKey(one);
  });
  const order = createMemo(() => gotoOrder(target(), height(), speed()));
  const serial = createMemo(() => vehicle()?.serial ?? null);
  const named = createMemo(() => {
    const [to, what] = [serial(), order()];
    return !isOn() || to === null || what === null ? null : { serials: [to], order: what };
  });
  const judgement = createJudgement(source, clock, named);
  const labels = () => {
    const one = vehicle();
    return one === null ? [] : [vehicleLabel(one)];
  };
  const leave = () => {
    setTarget(null);
    setOn(false);
  };
  // What was meant for one vehicle must not go to another.
  createEffect(on(key, leave, { defer: true }));
  onCleanup(leave);
  return {
    isOn,
    vehicle,
    target,
    height,
    speed,
    course: createMemo(() => courseTo(vehicle(), target(), order())),
    judgement,
    subject: createMemo(() => (judgement().kind === "allowed" ? JSON.stringify(named()) : "")),
    toggle: () => {
      const one = vehicle();
      if (isOn()) leave();
      else if (one !== null) {
        setHeight(heightNow(one));
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
    setHeight,
    setSpeed,
    confirm: () => {
      const given = named();
      if (given === null) return;
      void desk.order(given, labels());
      setTarget(null);
    },
    nudge: (by) => {
      const to = serial();
      if (to === null) return;
      void desk.order({ serials: [to], order: nudgeOrder(by) }, labels());
    },
  };
}

function heightNow(vehicle: VehicleView): string {
  const { value } = vehicle.height_above_takeoff_m;
  return value === null ? "" : String(Math.round(value));
}

/** The order as it stands; null while a part of it is missing or is no number. */
function gotoOrder(target: LonLat | null, height: string, speed: string) {
  const [height_m, speed_mps] = [numberIn(height), numberIn(speed)];
  if (target === null || height_m === null || speed_mps === null || speed_mps <= 0) return null;
  return {
    kind: "goto",
    latitude_deg: target.lat,
    longitude_deg: target.lon,
    height_above_takeoff_m: height_m,
    speed_mps,
  } as const satisfies Order;
}

/** The number in a field, with a point or a comma; null when it holds none. */
export function numberIn(text: string): number | null {
  const plain = text.trim().replace(",", ".");
  const value = Number(plain);
  return plain === "" || !Number.isFinite(value) ? null : value;
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
