import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { stalenessNow, vehicleKey } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, type Point, setFeatures } from "./features";
import type { LonLat } from "./localGrid";
import { type Layer, positionOf, type Scene } from "./scene";

const SOURCE = "trails";
const CASING = "trails-casing";
const REAL = "trails-real";
const SIMULATED = "trails-simulated";
/** Redraw only when a trail's end has moved this far: the symbol hides less, and drawing is expensive. */
const HIDDEN_END_PX = 12;
/** And not more often: the whole map is drawn again, and a frame with newer positions waits for that. */
const REDRAW_NS = 2e9;

/** Each vehicle's track in its colour, dashed if simulated. */
export class TrailLayer implements Layer {
  private map: MapLibre | null = null;
  private colours: Colours | null = null;
  private scene: Scene | null = null;
  /** What was drawn last: each trail's appearance and end. */
  private drawn = { looks: "", ends: new Map<number, LonLat>(), at_ns: 0 };

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
    map.on("zoom", () => this.drawIfVisible());
  }

  update(scene: Scene): void {
    this.scene = scene;
    const since_ns = Math.abs(scene.state.time_ns - this.drawn.at_ns);
    if (since_ns >= REDRAW_NS || looksOf(scene) !== this.drawn.looks) this.drawIfVisible();
  }

  recolour(colours: Colours): void {
    this.colours = colours;
    this.map?.setPaintProperty(CASING, "line-color", colours.casing);
    this.draw();
  }

  /** Redraws when the difference would be visible. */
  private drawIfVisible(): void {
    const { map, scene } = this;
    if (map === null || scene === null) return;
    const hasNewLook = looksOf(scene) !== this.drawn.looks;
    if (hasNewLook || endsOf(scene).some(([key, end]) => this.isVisible(map, key, end)))
      this.draw();
  }

  private isVisible(map: MapLibre, key: number, end: LonLat): boolean {
    const before = this.drawn.ends.get(key);
    if (before === undefined) return true;
    const a = map.project([before.lon, before.lat]);
    const b = map.project([end.lon, end.lat]);
    return Math.hypot(a.x - b.x, a.y - b.y) > HIDDEN_END_PX;
  }

  private draw(): void {
    const { map, colours, scene } = this;
    if (map === null || colours === null || scene === null) return;
    const trails = scene.state.vehicles.flatMap((vehicle) => trail(vehicle, scene, colours) ?? []);
    setFeatures(map, SOURCE, trails);
    const at_ns = scene.state.time_ns;
    this.drawn = { looks: looksOf(scene), ends: new Map(endsOf(scene)), at_ns };
  }
}

/** Everything that changes the trails' appearance except their ends. */
function looksOf(scene: Scene): string {
  return scene.state.vehicles
    .map((vehicle) => {
      const isLive = stalenessNow(vehicle, scene.behindS) === "live";
      const hasTrail = vehicle.track.length > 0;
      return [vehicleKey(vehicle), vehicle.is_simulated, isLive, hasTrail].join();
    })
    .join(";");
}

function endsOf(scene: Scene): [number, LonLat][] {
  return scene.state.vehicles.flatMap((vehicle): [number, LonLat][] => {
    const here = positionOf(vehicle);
    return here === null ? [] : [[vehicleKey(vehicle), here]];
  });
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
