import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import { band, type GhostShape, ghostOf } from "./ghosts";
import type { Layer } from "./layer";
import { addFeatures, areaFeature, lineFeature, setFeatures } from "./lines";
import { circle } from "./localGrid";
import type { Scene } from "./scene";

const SOURCE = "ghosts";
const AREA = "ghosts-area";
const EDGE = "ghosts-edge";
const WAY = "ghosts-way";

/** A growing circle around each vehicle that is not heard, and its way home: it may be anywhere there. */
export class GhostLayer implements Layer {
  private map: MapLibre | null = null;
  private hasGhosts = false;

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
    const ghosts = scene.state.vehicles.flatMap((one) => ghostOf(one, scene.behindS) ?? []);
    // Most of the time there are none, and drawing costs.
    if (ghosts.length === 0 && !this.hasGhosts) return;
    this.hasGhosts = ghosts.length > 0;
    setFeatures(this.map, SOURCE, ghosts.flatMap(featuresOf));
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(AREA, "fill-color", colours.stale);
    for (const line of [EDGE, WAY]) this.map?.setPaintProperty(line, "line-color", colours.stale);
  }
}

function featuresOf(ghost: GhostShape): Feature[] {
  const around = areaFeature(circle(ghost.centre, ghost.radius_m), {});
  const [from, to] = ghost.corridor;
  if (from === undefined || to === undefined) return [around];
  const way = lineFeature([from, to], {});
  const ring = band(from, to, ghost.corridorHalfWidth_m);
  return ring.length === 0 ? [around] : [around, areaFeature(ring, {}), way];
}
