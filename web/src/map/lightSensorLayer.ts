import { type Map as MapLibre, Marker } from "maplibre-gl";
import type { LightSensorView } from "../protocol";
import { text } from "../text/catalogue";
import { isSensorLive } from "../text/light";
import type { Layer, Scene } from "./scene";

/** Light sensors on the ground: a dot in the colour of what each shows, hollow if it is not live. */
export class LightSensorLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly markers = new Map<string, Marker>();

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    const sensors = scene.state.light_sensors?.sensors ?? [];
    const placed = new Set<string>();
    for (const sensor of sensors) {
      const { longitude_deg: lon, latitude_deg: lat } = sensor;
      if (lon === null || lat === null) continue;
      placed.add(sensor.name);
      describe(this.marker(sensor.name, [lon, lat]), sensor, scene.behindS);
    }
    for (const [name, marker] of this.markers) {
      if (!placed.has(name)) {
        marker.remove();
        this.markers.delete(name);
      }
    }
  }

  recolour(): void {}

  private marker(name: string, at: [number, number]): HTMLElement {
    const known = this.markers.get(name);
    if (known !== undefined) return known.setLngLat(at).getElement();
    const element = document.createElement("span");
    const made = new Marker({ element, anchor: "center" }).setLngLat(at);
    if (this.map !== null) made.addTo(this.map);
    this.markers.set(name, made);
    return element;
  }
}

function describe(element: HTMLElement, sensor: LightSensorView, behindS: number): void {
  const shown = isSensorLive(sensor, behindS) ? sensor.shows : "stale";
  if (element.dataset["shown"] === shown) return;
  element.dataset["shown"] = shown;
  element.classList.add("light-sensor");
  element.title = text.lightSensors.mark[shown](sensor.name);
}
