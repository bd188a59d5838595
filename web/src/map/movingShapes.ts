import { stalenessNow } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import type { Colours } from "./colours";
import type { Point } from "./features";
import { band, type HazardShape, hazardOf } from "./hazards";
import { circle } from "./localGrid";
import { positionOf, type Scene } from "./scene";

/** A line, or the area inside a ring, with its look. */
export interface Shape {
  readonly points: readonly Point[];
  readonly colour: string;
  readonly opacity: number;
  /** Width of the line; null for an area. */
  readonly width_px: number | null;
  /** Lengths of dashes and gaps; empty for a solid line. */
  readonly dash_px: readonly number[];
}

/** What moves with the vehicles, from bottom to top: hazard areas, tracks, paths of steered vehicles and of fly-here. */
export function movingShapes(scene: Scene, colours: Colours): Shape[] {
  const { vehicles } = scene.state;
  const trails = vehicles.flatMap((vehicle) => trailOf(vehicle, scene.behindS, colours) ?? []);
  return [
    ...vehicles
      .flatMap((vehicle) => hazardOf(vehicle, scene.behindS) ?? [])
      .flatMap((hazard) => hazardShapes(hazard, colours.stale)),
    ...trails.map(({ points }) => line(points, colours.casing, 5, [], 0.55)),
    ...trails,
    ...vehicles.flatMap((vehicle) => steeredWay(vehicle, colours) ?? []),
    ...plannedWay(scene, colours),
  ];
}

/** Everything that changes the shapes' appearance but the vehicles' motion. */
export function looksOf({ state, behindS, plannedTarget }: Scene): string {
  const vehicles = state.vehicles.map((vehicle) => [
    vehicle.number,
    vehicle.is_simulated,
    stalenessNow(vehicle, behindS) === "live",
    vehicle.track.length > 0,
    vehicle.hazard === null,
    vehicle.steering?.longitude_deg,
    vehicle.steering?.latitude_deg,
  ]);
  return JSON.stringify([vehicles, plannedTarget?.at]);
}

function line(
  points: readonly Point[],
  colour: string,
  width_px: number,
  dash_px: readonly number[] = [],
  opacity = 1,
): Shape {
  return { points, colour, opacity, width_px, dash_px };
}

/** A vehicle's track in its colour, dashed if simulated. */
function trailOf(vehicle: VehicleView, behindS: number, colours: Colours): Shape | null {
  const here = positionOf(vehicle);
  const points: Point[] = vehicle.track.map(([lon, lat]) => [lon, lat]);
  if (here !== null) points.push([here.lon, here.lat]);
  if (points.length < 2) return null;
  const isLive = stalenessNow(vehicle, behindS) === "live";
  const colour = isLive ? colours.vehicle(vehicle.number) : colours.stale;
  return line(points, colour, 2.5, vehicle.is_simulated ? [5, 4] : []);
}

/** Where a lost vehicle may be: a growing circle, and the corridor to its home. */
function hazardShapes(hazard: HazardShape, colour: string): Shape[] {
  const rings = [circle(hazard.centre, hazard.radius_m)];
  const [from, to] = hazard.corridor;
  const corridor =
    from === undefined || to === undefined ? [] : band(from, to, hazard.corridorHalfWidth_m);
  if (corridor.length > 0) rings.push(corridor);
  const leg = from !== undefined && to !== undefined && corridor.length > 0 ? [from, to] : [];
  return [
    ...rings.map(
      (points): Shape => ({ points, colour, opacity: 0.18, width_px: null, dash_px: [] }),
    ),
    ...rings.map((points) => line(points, colour, 2.5, [8, 5])),
    ...(leg.length === 0 ? [] : [line(leg, colour, 2, [2, 4])]),
  ];
}

/** From a vehicle under virtual stick control to its target. */
function steeredWay(vehicle: VehicleView, colours: Colours): Shape | null {
  const here = positionOf(vehicle);
  const { steering } = vehicle;
  if (here === null || steering === null) return null;
  const points: Point[] = [
    [here.lon, here.lat],
    [steering.longitude_deg, steering.latitude_deg],
  ];
  return line(points, colours.vehicle(vehicle.number), 3, [3, 4.5]);
}

/** To the fly-here target that has not been confirmed yet. */
function plannedWay({ plannedTarget }: Scene, colours: Colours): Shape[] {
  const { from, at } = plannedTarget ?? {};
  if (!from || !at) return [];
  const points: Point[] = [
    [from.lon, from.lat],
    [at.lon, at.lat],
  ];
  return [line(points, colours.casing, 6, [], 0.7), line(points, colours.text, 2.5, [5, 5])];
}
