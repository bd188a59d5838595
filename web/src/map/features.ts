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

/**
 * The deepest tiles of a source. Each tile of each source costs its share of a frame, also an empty one, and
 * without a GPU that is most of the frame; a field is in one to four of these, some 900 m wide, and a place in one
 * is exact to 0.1 m.
 */
const DEEPEST_TILES = 15;

/** Adds an empty GeoJSON source. */
export function addFeatures(map: MapLibre, id: string): void {
  const data = { type: "FeatureCollection", features: [] } as const;
  map.addSource(id, { type: "geojson", data: { ...data, features: [] }, maxzoom: DEEPEST_TILES });
}

/** Replaces the features of a GeoJSON source; the layers of one without features are hidden and cost nothing. */
export function setFeatures(map: MapLibre, id: string, features: Feature[]): void {
  map.getSource<GeoJSONSource>(id)?.setData({ type: "FeatureCollection", features });
  showLayers(map, (source) => source === id, features.length > 0);
}

/** Hides every layer with a source, until that has features. */
export function hideLayers(map: MapLibre): void {
  showLayers(map, (source) => source !== undefined, false);
}

function showLayers(map: MapLibre, has: (source: string | undefined) => boolean, are: boolean) {
  const visibility = are ? "visible" : "none";
  for (const id of map.getLayersOrder()) {
    const layer = map.getLayer(id);
    if (layer === undefined || !has(layer.source) || layer.visibility === visibility) continue;
    map.setLayoutProperty(id, "visibility", visibility);
  }
}

/** Corners of an image on the map: north-west, north-east, south-east, south-west. */
export type Corners = [Point, Point, Point, Point];

/** The corners of an image as MapLibre takes them; null unless there are four. */
export function cornersOf(corners: readonly (readonly [number, number])[]): Corners | null {
  const [nw, ne, se, sw] = corners.map(([lon, lat]): Point => [lon, lat]);
  if (nw === undefined || ne === undefined || se === undefined || sw === undefined) return null;
  return [nw, ne, se, sw];
}
