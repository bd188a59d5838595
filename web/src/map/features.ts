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
