import { type Accessor, createEffect, createMemo, createSignal, on } from "solid-js";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { LonLat } from "../map/localGrid";
import { positionOf } from "../map/scene";
import type { NamedOrder, Order, VehicleView } from "../protocol";
import type { Clock } from "../source/clock";
import type { OrderRequests } from "../source/orderRequests";
import { text } from "../text/catalogue";
import { vehicleLabel } from "../text/names";
import { createLengthField, type LengthField, numberIn } from "../text/units";
import { courseOf } from "./course";
import { currentHeight_m } from "./flyHere";
import type { OrderApi } from "./orderApi";
import { createOrderCheck, type OrderCheck } from "./orderCheck";

const SPEED_MPS = 5;
/** As small as DJI takes: the vehicle passes close by each point. */
const CORNER_RADIUS_M = 0.2;
/** A mission of one point is none to DJI. */
export const LEAST_POINTS = 2;

/** A point of a mission being drawn. */
export interface MissionPoint {
  readonly id: number;
  readonly at: LonLat;
  /** Above takeoff. */
  readonly height: LengthField;
}

/** How long a mission is, from where its vehicle is. */
export interface MissionFigures {
  readonly distance_m: number;
  /** At its speed, without braking. */
  readonly time_s: number;
}

/** A mission being drawn for the one selected vehicle: presses on the map add points. */
export interface MissionDraft {
  readonly isOn: Accessor<boolean>;
  /** The selected vehicle; null unless exactly one identified vehicle is selected. */
  readonly vehicle: Accessor<VehicleView | null>;
  /** Why no mission can be drawn now; null: one can. */
  readonly lack: Accessor<string | null>;
  readonly points: Accessor<readonly MissionPoint[]>;
  /** The id of the selected point: the next one is added behind it. */
  readonly selected: Accessor<number | null>;
  /** As typed: metres per second. */
  readonly speed: Accessor<string>;
  readonly landsAtEnd: Accessor<boolean>;
  /** Whether the vehicle takes off for it. */
  readonly isTakeoff: Accessor<boolean>;
  readonly figures: Accessor<MissionFigures | null>;
  /** The safety gate's current result. */
  readonly check: Accessor<OrderCheck>;
  /** The number of the point that a refusal names; null without one. */
  readonly refusedPoint: Accessor<number | null>;
  /** Changes with every part of the order; empty while the gate does not allow it. */
  readonly subject: Accessor<string>;
  toggle(): void;
  leave(): void;
  /** Deselects the point, else leaves the mode; the points stay. Returns false when the mode was off. */
  clear(): boolean;
  /** Adds a point behind the selected one, at its height. */
  aim(at: LonLat): void;
  move(id: number, at: LonLat): void;
  remove(id: number): void;
  select(id: number | null): void;
  /** Removes all points. */
  discard(): void;
  setSpeed(text: string): void;
  setLandsAtEnd(lands: boolean): void;
  /** Sends the mission; once it is accepted its points are removed. */
  confirm(): Promise<void>;
}

export function createMissionDraft(
  vehicle: Accessor<VehicleView | null>,
  orders: Pick<OrderRequests, "check">,
  orderApi: Pick<OrderApi, "order">,
  clock: Clock,
): MissionDraft {
  const [isOn, setOn] = createSignal(false);
  const points = createPoints(() => currentHeight_m(vehicle()));
  const [speed, setSpeed] = createSignal(String(SPEED_MPS));
  const [landsAtEnd, setLandsAtEnd] = createSignal(false);
  const key = createMemo(() => vehicle() && vehicleKey(vehicle() as VehicleView));
  const lack = createMemo(() => lackOf(vehicle()));
  const isTakeoff = createMemo(() => vehicle()?.is_flying.value === false);
  const named = createMemo<NamedOrder | null>(() => {
    const serial = vehicle()?.serial ?? null;
    const order = missionOrder(points.all(), numberIn(speed()), landsAtEnd());
    if (!isOn() || serial === null || order === null) return null;
    return { serials: [serial], order, ...(isTakeoff() && { takeoff: true }) };
  });
  const check = createOrderCheck(orders, clock, named);
  const leave = () => setOn(false);
  // What was drawn for one vehicle stays on the page, and is checked anew for another.
  createEffect(on(key, leave, { defer: true }));
  return {
    isOn,
    vehicle,
    lack,
    points: points.all,
    selected: points.selected,
    speed,
    landsAtEnd,
    isTakeoff,
    figures: createMemo(() => figuresOf(vehicle(), points.all(), numberIn(speed()))),
    check,
    refusedPoint: createMemo(() => refusedPoint(check())),
    subject: createMemo(() => (check().kind === "allowed" ? JSON.stringify(named()) : "")),
    toggle: () => {
      setOn(!isOn() && lack() === null);
      const standing = isOn() && isTakeoff() ? vehicle() : null;
      const here = standing && positionOf(standing);
      // A takeoff climbs straight up before anything else.
      if (here !== null && points.all().length === 0) points.add(here);
    },
    leave,
    clear: () => {
      if (!isOn()) return false;
      if (points.selected() === null) leave();
      else points.select(null);
      return true;
    },
    aim: (at) => isOn() && points.add(at),
    move: points.move,
    remove: points.remove,
    select: points.select,
    discard: points.discard,
    setSpeed,
    setLandsAtEnd,
    confirm: async () => {
      const [ready, addressed] = [named(), vehicle()];
      if (ready === null || addressed === null) return;
      // What the station refuses stays on the map, to be changed.
      if (!(await orderApi.order(ready, [vehicleLabel(addressed)]))) return;
      points.discard();
      leave();
    },
  };
}

/** The points in the order in which they are flown. */
function createPoints(firstHeight_m: () => number | null) {
  const [all, setAll] = createSignal<readonly MissionPoint[]>([]);
  const [selected, select] = createSignal<number | null>(null);
  let newest = 0;
  const index = () => all().findIndex(({ id }) => id === selected());
  return {
    all,
    selected,
    select,
    add: (at: LonLat) => {
      const behind = index() === -1 ? all().length : index() + 1;
      const height_m = all()[behind - 1]?.height.metres() ?? firstHeight_m();
      newest += 1;
      const point = { id: newest, at, height: createLengthField(height_m) };
      setAll([...all().slice(0, behind), point, ...all().slice(behind)]);
      select(point.id);
    },
    move: (id: number, at: LonLat) =>
      setAll(all().map((point) => (point.id === id ? { ...point, at } : point))),
    remove: (id: number) => {
      setAll(all().filter((point) => point.id !== id));
      if (selected() === id) select(null);
    },
    discard: () => {
      setAll([]);
      select(null);
    },
  };
}

function lackOf(vehicle: VehicleView | null): string | null {
  if (vehicle === null) return text.mission.selectOne;
  return vehicle.flies_missions ? null : text.mission.fliesNone(vehicleLabel(vehicle));
}

/** The order; null while a part is missing or not a number. */
function missionOrder(
  points: readonly MissionPoint[],
  speed_mps: number | null,
  land_at_end: boolean,
): Order | null {
  if (points.length < LEAST_POINTS || speed_mps === null || speed_mps <= 0) return null;
  const waypoints = points.flatMap(({ at, height }) => {
    const height_above_takeoff_m = height.metres();
    if (height_above_takeoff_m === null) return [];
    const place = { latitude_deg: at.lat, longitude_deg: at.lon };
    return [{ ...place, height_above_takeoff_m, speed_mps, corner_radius_m: CORNER_RADIUS_M }];
  });
  if (waypoints.length < points.length) return null;
  return { kind: "mission", waypoints, land_at_end, curved: false };
}

function figuresOf(
  vehicle: VehicleView | null,
  points: readonly MissionPoint[],
  speed_mps: number | null,
): MissionFigures | null {
  const here = vehicle === null ? null : positionOf(vehicle);
  if (vehicle === null || here === null || speed_mps === null || speed_mps <= 0) return null;
  let [at, height_m] = [here, vehicle.height_above_takeoff_m.value ?? 0];
  const total = { distance_m: 0, time_s: 0 };
  for (const point of points) {
    const to_m = point.height.metres() ?? height_m;
    const { distance_m, time_s } = courseOf(at, point.at, to_m - height_m, speed_mps);
    total.distance_m += distance_m;
    total.time_s += time_s;
    [at, height_m] = [point.at, to_m];
  }
  return points.length === 0 ? null : total;
}

/** The gate names points by their number: `Waypoint 2: ...`, `between waypoints 2 and 3`, `leg 2 to 3`. */
function refusedPoint(check: OrderCheck): number | null {
  const number =
    check.kind === "refused" ? /(?:waypoints?|leg) (\d+)/i.exec(check.text)?.[1] : undefined;
  return number === undefined ? null : Number(number);
}
