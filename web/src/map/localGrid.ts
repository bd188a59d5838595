/** The map's metric grid, east and north of an origin; for display, not for measurement. */

export interface LonLat {
  readonly lon: number;
  readonly lat: number;
}

export interface Box {
  readonly west: number;
  readonly south: number;
  readonly east: number;
  readonly north: number;
}

const WGS84_A_M = 6_378_137;
const WGS84_E2 = 6.694_379_990_14e-3;

/** Metres per degree of longitude and latitude on the WGS84 ellipsoid. */
export function metresPerDegree(lat_deg: number): { readonly lon: number; readonly lat: number } {
  const lat = (lat_deg * Math.PI) / 180;
  const w2 = 1 - WGS84_E2 * Math.sin(lat) ** 2;
  const degree = Math.PI / 180;
  return {
    lon: ((WGS84_A_M * Math.cos(lat)) / Math.sqrt(w2)) * degree,
    lat: ((WGS84_A_M * (1 - WGS84_E2)) / w2 ** 1.5) * degree,
  };
}

/** The smallest of 1, 2, 5, 10, 20, ... metres that is at least `least_m`. */
export function roundStepM(least_m: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(least_m, 1e-3)));
  const factor = [1, 2, 5, 10].find((candidate) => candidate * power >= least_m * (1 - 1e-9)) ?? 10;
  return factor * power;
}

/** One grid line: `m` metres east (or north) of the origin, at `deg` longitude (or latitude). */
export interface GridLine {
  readonly m: number;
  readonly deg: number;
}

export interface Grid {
  readonly step_m: number;
  readonly eastings: readonly GridLine[];
  readonly northings: readonly GridLine[];
}

/** Upper bound of grid lines in each direction. */
const MOST_LINES = 200;

/** Grid lines that cross `box`, `step_m` apart, counted from `origin`. */
export function gridLines(box: Box, origin: LonLat, step_m: number): Grid {
  const per = metresPerDegree(origin.lat);
  return {
    step_m,
    eastings: lines(box.west, box.east, origin.lon, per.lon, step_m),
    northings: lines(box.south, box.north, origin.lat, per.lat, step_m),
  };
}

function lines(
  from: number,
  to: number,
  zero: number,
  per_deg: number,
  step_m: number,
): GridLine[] {
  const first = Math.ceil(((from - zero) * per_deg) / step_m);
  const last = Math.floor(((to - zero) * per_deg) / step_m);
  const count = Math.min(MOST_LINES, Math.max(0, last - first + 1));
  return Array.from({ length: count }, (_, index) => {
    const m = (first + index) * step_m;
    return { m, deg: zero + m / per_deg };
  });
}

/** A closed ring with `radius_m` around a point, as longitude and latitude. */
export function circle(centre: LonLat, radius_m: number, corners = 48): [number, number][] {
  const per = metresPerDegree(centre.lat);
  return Array.from({ length: corners + 1 }, (_, index) => {
    const angle = (2 * Math.PI * (index % corners)) / corners;
    return [
      centre.lon + (radius_m * Math.sin(angle)) / per.lon,
      centre.lat + (radius_m * Math.cos(angle)) / per.lat,
    ];
  });
}

/** The smallest box around `points`, at least `least_m` wide and high; null without points. */
export function boxAround(points: readonly LonLat[], least_m: number): Box | null {
  if (points.length === 0) return null;
  const lons = points.map((point) => point.lon);
  const lats = points.map((point) => point.lat);
  const middle = {
    lon: (Math.min(...lons) + Math.max(...lons)) / 2,
    lat: (Math.min(...lats) + Math.max(...lats)) / 2,
  };
  const per = metresPerDegree(middle.lat);
  const halfLon = Math.max((Math.max(...lons) - Math.min(...lons)) / 2, least_m / 2 / per.lon);
  const halfLat = Math.max((Math.max(...lats) - Math.min(...lats)) / 2, least_m / 2 / per.lat);
  return {
    west: middle.lon - halfLon,
    east: middle.lon + halfLon,
    south: middle.lat - halfLat,
    north: middle.lat + halfLat,
  };
}
