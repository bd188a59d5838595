import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import { addFeatures, areaFeature, lineFeature, setFeatures } from "./features";
import { band, type HazardShape, hazardOf } from "./hazards";
import { circle } from "./localGrid";
import type { Layer, Scene } from "./scene";

const SOURCE = "hazards";
const AREA = "hazards-area";
const EDGE = "hazards-edge";
const WAY = "hazards-way";

/** Hazard areas of lost vehicles: a growing circle and the corridor to home. */
export class HazardLayer implements Layer {
  private map: MapLibre | null = null;
  private hasHazards = false;

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addLayer({
      id: AREA,
      type: "fill",
      source: SOURCE,
      paint: { "fill-color": colours.stale, "fill-opacity": 0.18 },
      filter: ["==", ["geometry-type"], "Polygon"],
    });
    map.addLayer({
      id: EDGE,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.stale, "line-width": 2.5, "line-dasharray": [3, 2] },
      filter: ["==", ["geometry-type"], "Polygon"],
    });
    map.addLayer({
      id: WAY,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.stale, "line-width": 2, "line-dasharray": [1, 2] },
      filter: ["==", ["geometry-type"], "LineString"],
    });
  }

  update(scene: Scene): void {
    if (this.map === null) return;
    const hazards = scene.state.vehicles.flatMap((one) => hazardOf(one, scene.behindS) ?? []);
    // Usually empty; avoid redrawing.
    if (hazards.length === 0 && !this.hasHazards) return;
    this.hasHazards = hazards.length > 0;
    setFeatures(this.map, SOURCE, hazards.flatMap(featuresOf));
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(AREA, "fill-color", colours.stale);
    for (const line of [EDGE, WAY]) this.map?.setPaintProperty(line, "line-color", colours.stale);
  }
}

function featuresOf(hazard: HazardShape): Feature[] {
  const around = areaFeature(circle(hazard.centre, hazard.radius_m), {});
  const [from, to] = hazard.corridor;
  if (from === undefined || to === undefined) return [around];
  const way = lineFeature([from, to], {});
  const ring = band(from, to, hazard.corridorHalfWidth_m);
  return ring.length === 0 ? [around] : [around, areaFeature(ring, {}), way];
}
