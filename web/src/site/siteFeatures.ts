import { type LonLat, metresPerDegree } from "../map/localGrid";
import type { DrawnFeatureView, LayerName } from "../protocol";
import { text } from "../text/catalogue";

/** What a layer's features are, and which attributes they have. */
export interface LayerKind {
  readonly isPoint: boolean;
  readonly hasHeights: boolean;
}

export const LAYERS: Readonly<Record<LayerName, LayerKind>> = {
  boundary: { isPoint: false, hasHeights: false },
  survey_regions: { isPoint: false, hasHeights: false },
  keep_out: { isPoint: false, hasHeights: true },
  height_zones: { isPoint: false, hasHeights: true },
  landing_pads: { isPoint: true, hasHeights: false },
};

export const LAYER_NAMES = Object.keys(LAYERS) as readonly LayerName[];

/** Of a feature whose corners are handles on the map: with 9,000 the page stood still for 14 s. */
export const MOST_DRAGGED = 500;

export function isDraggable({ rings }: Pick<DraftFeature, "rings">): boolean {
  return rings.reduce((sum, ring) => sum + ring.length, 0) <= MOST_DRAGGED;
}

export type Attribute = DrawnFeatureView["properties"][string];

/** Corners of an outline or a hole, without the first one again at the end. */
export type Ring = readonly LonLat[];

/** A feature of the draft. A pad has one ring of one corner; an area its outline, then its holes. */
export interface DraftFeature {
  readonly id: number;
  readonly layer: LayerName;
  readonly rings: readonly Ring[];
  readonly properties: Readonly<Record<string, Attribute>>;
  /** As read from the station. It is sent as it came until the feature is edited: no digit is lost. */
  readonly unedited: DrawnFeatureView | null;
}

export function featureOf(id: number, view: DrawnFeatureView): DraftFeature {
  const { layer, geometry, properties } = view;
  return { id, layer, rings: ringsOf(geometry), properties, unedited: view };
}

export function ringsOf({ coordinates, type }: DrawnFeatureView["geometry"]): Ring[] {
  if (type === "Point") return [[lonLat(coordinates as number[])]];
  return (coordinates as number[][][]).map((ring) => ring.slice(0, -1).map(lonLat));
}

function lonLat([lon = 0, lat = 0]: readonly number[]): LonLat {
  return { lon, lat };
}

export function viewOf(feature: DraftFeature): DrawnFeatureView {
  if (feature.unedited !== null) return feature.unedited;
  const { layer, rings, properties } = feature;
  const position = ({ lon, lat }: LonLat) => [lon, lat];
  const [outline = []] = rings;
  const [first = { lon: 0, lat: 0 }] = outline;
  const geometry: DrawnFeatureView["geometry"] = LAYERS[layer].isPoint
    ? { type: "Point", coordinates: position(first) }
    : { type: "Polygon", coordinates: rings.map((ring) => closed(ring).map(position)) };
  return { layer, geometry, properties: { ...properties } };
}

/** A ring with its first corner again at the end. */
export function closed(ring: Ring): Ring {
  const [first] = ring;
  return first === undefined ? ring : [...ring, first];
}

/** A feature's own name, else what it is. */
export function featureName({ layer, properties }: DraftFeature): string {
  const { name, serial } = properties;
  const own = typeof name === "string" && name !== "" ? name : serial;
  return typeof own === "string" && own !== "" ? own : text.siteLayers[layer].name;
}

/** The area of a feature without its holes, hectares. */
export function areaHa({ rings }: Pick<DraftFeature, "rings">): number {
  const [outline = 0, ...holes] = rings.map(ringAreaM2);
  return (outline - holes.reduce((sum, hole) => sum + hole, 0)) / 10_000;
}

function ringAreaM2(ring: Ring): number {
  const [origin] = ring;
  if (origin === undefined) return 0;
  const per = metresPerDegree(origin.lat);
  const points = ring.map(({ lon, lat }) => [
    (lon - origin.lon) * per.lon,
    (lat - origin.lat) * per.lat,
  ]);
  const twice = points.reduce((sum, [x = 0, y = 0], index) => {
    const [nextX = 0, nextY = 0] = points[(index + 1) % points.length] ?? [];
    return sum + x * nextY - nextX * y;
  }, 0);
  return Math.abs(twice) / 2;
}

/** A square around a place, corners clockwise from the north-west. */
export function squareAround({ lon, lat }: LonLat, side_m: number): Ring {
  const per = metresPerDegree(lat);
  const [east, north] = [side_m / 2 / per.lon, side_m / 2 / per.lat];
  return [
    { lon: lon - east, lat: lat + north },
    { lon: lon + east, lat: lat + north },
    { lon: lon + east, lat: lat - north },
    { lon: lon - east, lat: lat - north },
  ];
}

const DECIMALS = 7;

/** A corner as typed and shown: latitude first, degrees. */
export function cornerText({ lon, lat }: LonLat): string {
  return `${lat.toFixed(DECIMALS)}, ${lon.toFixed(DECIMALS)}`;
}

/** The corner that a text gives; null for anything but a latitude and a longitude. */
export function cornerOf(typed: string): LonLat | null {
  const parts = typed.trim().split(/\s*[,;]\s*|\s+/);
  if (parts.length !== 2 || parts.some((part) => part === "")) return null;
  const [lat = Number.NaN, lon = Number.NaN] = parts.map(Number);
  return Math.abs(lat) <= 90 && Math.abs(lon) <= 180 ? { lon, lat } : null;
}
