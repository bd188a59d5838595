import type { Feature, GeoJsonProperties } from "geojson";
import type { GeoJSONSource, Map as MapLibre } from "maplibre-gl";

/** Longitude and latitude, degrees. */
export type Point = [number, number];

/** A line with what the style needs to know of it. */
export function lineFeature(coordinates: Point[], properties: GeoJsonProperties): Feature {
  return { type: "Feature", geometry: { type: "LineString", coordinates }, properties };
}

/** An area inside one closed ring. */
export function areaFeature(ring: Point[], properties: GeoJsonProperties): Feature {
  return { type: "Feature", geometry: { type: "Polygon", coordinates: [ring] }, properties };
}

/** Adds an empty GeoJSON source to draw from. */
export function addFeatures(map: MapLibre, id: string): void {
  map.addSource(id, { type: "geojson", data: { type: "FeatureCollection", features: [] } });
}

/** Replaces what a GeoJSON source holds. */
export function setFeatures(map: MapLibre, id: string, features: Feature[]): void {
  map.getSource<GeoJSONSource>(id)?.setData({ type: "FeatureCollection", features });
}
