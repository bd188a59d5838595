import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { stalenessNow } from "../fleet/staleness";
import type { VehicleView } from "../protocol";
import type { Colours } from "./colours";
import type { Layer } from "./layer";
import { addFeatures, lineFeature, type Point, setFeatures } from "./lines";
import { positionOf, type Scene } from "./scene";

const SOURCE = "trails";
const CASING = "trails-casing";
const REAL = "trails-real";
const SIMULATED = "trails-simulated";

/** Where each vehicle has been: a line in its colour, dashed when it is simulated. */
export class TrailLayer implements Layer {
  private map: MapLibre | null = null;
  private colours: Colours | null = null;
  private scene: Scene | null = null;

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    this.colours = colours;
    addFeatures(map, SOURCE);
    const layout = { "line-join": "round", "line-cap": "round" } as const;
    map.addLayer({
      id: CASING,
      type: "line",
      source: SOURCE,
      layout,
      paint: { "line-color": colours.casing, "line-width": 5, "line-opacity": 0.55 },
    });
    const paint = { "line-color": ["get", "colour"], "line-width": 2.5 } as {
      "line-color": ["get", string];
      "line-width": number;
    };
    map.addLayer({
      id: REAL,
      type: "line",
      source: SOURCE,
      layout,
      paint,
      filter: ["!", ["get", "simulated"]],
    });
    map.addLayer({
      id: SIMULATED,
      type: "line",
      source: SOURCE,
      paint: { ...paint, "line-dasharray": [2, 1.5] },
      filter: ["get", "simulated"],
    });
  }

  update(scene: Scene): void {
    this.scene = scene;
    const { map, colours } = this;
    if (map === null || colours === null) return;
    const trails = scene.state.vehicles.flatMap((vehicle) => trail(vehicle, scene, colours) ?? []);
    setFeatures(map, SOURCE, trails);
  }

  recolour(colours: Colours): void {
    this.colours = colours;
    this.map?.setPaintProperty(CASING, "line-color", colours.casing);
    if (this.scene !== null) this.update(this.scene);
  }
}

function trail(vehicle: VehicleView, scene: Scene, colours: Colours): Feature | null {
  const here = positionOf(vehicle);
  const points: Point[] = vehicle.track.map(([lon, lat]) => [lon, lat]);
  if (here !== null) points.push([here.lon, here.lat]);
  if (points.length < 2) return null;
  const isLive = stalenessNow(vehicle, scene.behindS) === "live";
  return lineFeature(points, {
    colour: isLive ? colours.vehicle(vehicle.number) : colours.stale,
    simulated: vehicle.is_simulated,
  });
}
