import type { Feature, GeoJsonProperties } from "geojson";
import type { GeoJSONSource, Map as MapLibre } from "maplibre-gl";

/** Longitude and latitude, degrees. */
export type Point = [number, number];

/** A line with properties for the style. */
export function lineFeature(coordinates: Point[], properties: GeoJsonProperties): Feature {
  return { type: "Feature", geometry: { type: "LineString", coordinates }, properties };
}

/** A polygon with one closed ring. */
export function areaFeature(ring: Point[], properties: GeoJsonProperties): Feature {
  return { type: "Feature", geometry: { type: "Polygon", coordinates: [ring] }, properties };
}

/** Adds an empty GeoJSON source. */
export function addFeatures(map: MapLibre, id: string): void {
  map.addSource(id, { type: "geojson", data: { type: "FeatureCollection", features: [] } });
}

/** Replaces the features of a GeoJSON source. */
export function setFeatures(map: MapLibre, id: string, features: Feature[]): void {
  map.getSource<GeoJSONSource>(id)?.setData({ type: "FeatureCollection", features });
}

/** Corners of an image on the map: north-west, north-east, south-east, south-west. */
export type Corners = [Point, Point, Point, Point];

/** The corners of an image as MapLibre takes them; null unless there are four. */
export function cornersOf(corners: readonly (readonly [number, number])[]): Corners | null {
  const [nw, ne, se, sw] = corners.map(([lon, lat]): Point => [lon, lat]);
  if (nw === undefined || ne === undefined || se === undefined || sw === undefined) return null;
  return [nw, ne, se, sw];
}
