import type { Map as MapLibre } from "maplibre-gl";
import { vehicleKey } from "../fleet/key";
import type { Layer } from "./layer";
import { positionOf, type Scene } from "./scene";
import { type MarkerPress, VehicleMarker } from "./vehicleMarker";

/** All vehicles whose position was ever known; the style sheet colours them. */
export class VehicleLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly markers = new Map<number, VehicleMarker>();

  constructor(private readonly press: MarkerPress) {}

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    if (this.map === null) return;
    const placed = new Set<number>();
    for (const vehicle of scene.state.vehicles) {
      const at = positionOf(vehicle);
      if (at === null) continue;
      const key = vehicleKey(vehicle);
      placed.add(key);
      const isSelected = scene.selected.includes(key);
      this.markerOf(key).show(this.map, vehicle, at, scene.behindS, isSelected);
    }
    this.removeAllBut(placed);
  }

  recolour(): void {}

  private markerOf(key: number): VehicleMarker {
    const known = this.markers.get(key);
    if (known !== undefined) return known;
    const marker = new VehicleMarker(key, this.press);
    this.markers.set(key, marker);
    return marker;
  }

  private removeAllBut(placed: ReadonlySet<number>): void {
    for (const [key, marker] of this.markers) {
      if (placed.has(key)) continue;
      marker.remove();
      this.markers.delete(key);
    }
  }
}
