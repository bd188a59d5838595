import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { reachM, stalenessNow } from "../fleet/staleness";
import type { VehicleView } from "../protocol";
import { agedBy } from "../words/age";
import { groundSpeedMps } from "../words/quantity";
import type { Colours } from "./colours";
import type { Layer } from "./layer";
import { addFeatures, areaFeature, setFeatures } from "./lines";
import { circle } from "./localGrid";
import { positionOf, type Scene } from "./scene";

const SOURCE = "ghosts";
const AREA = "ghosts-area";
const EDGE = "ghosts-edge";
/** Beyond this the circle says nothing any more. */
const WIDEST_M = 2000;

/** A growing circle around each vehicle whose telemetry is old: it may be anywhere inside. */
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
      paint: { "fill-color": colours.stale, "fill-opacity": 0.16 },
    });
    map.addLayer({
      id: EDGE,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.stale, "line-width": 2, "line-dasharray": [3, 2] },
    });
  }

  update(scene: Scene): void {
    if (this.map === null) return;
    const ghosts = scene.state.vehicles.flatMap((vehicle) => ghost(vehicle, scene.behindS) ?? []);
    // Most of the time there are none, and drawing costs.
    if (ghosts.length === 0 && !this.hasGhosts) return;
    this.hasGhosts = ghosts.length > 0;
    setFeatures(this.map, SOURCE, ghosts);
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(AREA, "fill-color", colours.stale);
    this.map?.setPaintProperty(EDGE, "line-color", colours.stale);
  }
}

function ghost(vehicle: VehicleView, behindS: number): Feature | null {
  const here = positionOf(vehicle);
  const ageS = agedBy(vehicle.position.age_s, behindS);
  if (here === null || ageS === null || stalenessNow(vehicle, behindS) === "live") return null;
  const { north_mps, east_mps } = vehicle.velocity_ned;
  // A vehicle of unknown speed may have had any: 15 m/s is what DJI's missions allow.
  const speedMps = groundSpeedMps(north_mps, east_mps) ?? 15;
  const radiusM = Math.min(WIDEST_M, reachM(ageS, speedMps, vehicle.is_flying.value !== false));
  return areaFeature(circle(here, radiusM), { number: vehicle.number });
}
