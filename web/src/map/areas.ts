import type { Feature } from "geojson";
import { activeSurveys } from "../fleet/activity";
import type { AreaView, StationState } from "../protocol";
import { text } from "../text/catalogue";
import { formatLength } from "../text/units";
import type { LonLat } from "./localGrid";

/** The site's areas with an outline. While a drawn area is flown, its survey regions are left out. */
export function shownAreas({ site, surveys }: Pick<StationState, "site" | "surveys">): AreaView[] {
  const isDrawn = activeSurveys(surveys).some(({ region }) => region === null);
  return (site?.areas ?? []).filter(
    (area) => outerRing(area).length > 2 && (area.kind !== "survey" || !isDrawn),
  );
}

/** Areas as GeoJSON features. */
export function areaFeatures(areas: readonly AreaView[]): Feature[] {
  return areas.map((area) => ({
    type: "Feature",
    geometry: {
      type: "Polygon",
      coordinates: area.rings.map((ring) => ring.map(([lon, lat]) => [lon, lat])),
    },
    properties: {},
  }));
}

/** An area's label on the map; heights include their datum. */
export function areaText(area: AreaView): string {
  const label = named(text.map.areas[area.kind], area.name);
  const hasHeights = area.kind === "keep_out" || area.kind === "height";
  return hasHeights ? joined(label, areaHeights(area)) : label;
}

function named(what: string, name: string): string {
  const isRepeated = name === "" || name.toLowerCase() === what.toLowerCase();
  return isRepeated ? what : `${what}: ${name}`;
}

function joined(label: string, heights: string): string {
  return heights === "" ? label : `${label}, ${heights}`;
}

/** An area's height range as text; empty without limits, which for a keep-out zone means all heights. */
export function areaHeights({ floor_m, ceiling_m, datum }: AreaView): string {
  if (floor_m === null && ceiling_m === null) return "";
  const { wgs84, aboveGround, upTo, from, fromTo } = text.map;
  const above = datum === "wgs84" ? wgs84 : aboveGround;
  if (floor_m === null) return upTo(formatLength(ceiling_m ?? 0), above);
  if (ceiling_m === null) return from(formatLength(floor_m), above);
  return fromTo(formatLength(floor_m), formatLength(ceiling_m), above);
}

/** A place for a label: in the middle over a point, or with an edge at it. */
export interface LabelPlace extends LonLat {
  readonly side: "over" | "above" | "below";
}

/**
 * Places for an area's label, the best first. A boundary's is at a corner, the northernmost first; any other area's at
 * the centre, else inside or outside of its northern or southern edge.
 */
export function labelPlaces(area: AreaView): LabelPlace[] {
  if (area.kind === "boundary") return cornerPlaces(outerRing(area));
  const { west, east, south, north } = extent(area);
  const lon = (west + east) / 2;
  return [
    { lon, lat: (south + north) / 2, side: "over" },
    { lon, lat: north, side: "below" },
    { lon, lat: south, side: "above" },
    { lon, lat: north, side: "above" },
    { lon, lat: south, side: "below" },
  ];
}

/** So many corners of a boundary are tried for its label. */
const CORNERS_TRIED = 8;

function cornerPlaces(ring: readonly (readonly [number, number])[]): LabelPlace[] {
  const southwards = [...ring].sort(([, a], [, b]) => b - a);
  const step = Math.ceil(southwards.length / CORNERS_TRIED);
  return southwards
    .filter((_, index) => index % step === 0)
    .map(([lon, lat]) => ({ lon, lat, side: "over" }));
}

/** The box around an area, degrees. */
export function extent(area: AreaView) {
  const ring = outerRing(area);
  const lons = ring.map(([lon]) => lon);
  const lats = ring.map(([, lat]) => lat);
  return {
    west: Math.min(...lons),
    east: Math.max(...lons),
    south: Math.min(...lats),
    north: Math.max(...lats),
  };
}

function outerRing(area: AreaView): readonly (readonly [number, number])[] {
  return (area.rings[0] ?? []) as [number, number][];
}
