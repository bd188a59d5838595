import type { Map as MapLibre } from "maplibre-gl";
import { vehicleKey } from "../fleet/vehicleStatus";
import { type LabelPlace, type LabelView, placeLabels } from "./labelPlacement";
import { type Layer, positionOf, type Scene } from "./scene";
import { type MarkerPress, VehicleMarker } from "./vehicleMarker";

/** All vehicles with a known position; CSS sets their colours. */
export class VehicleLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly markers = new Map<number, VehicleMarker>();
  private places: ReadonlyMap<number, LabelPlace> = new Map();
  private view: LabelView = { width_px: 0, height_px: 0, covered: [] };
  /** Reports label sizes after layout; reading them would force a layout. */
  private readonly sizes = new ResizeObserver((entries) => this.measure(entries));

  /** `covers` are elements over the map; labels avoid their children. */
  constructor(
    private readonly press: MarkerPress,
    private readonly covers: readonly HTMLElement[],
  ) {}

  add(map: MapLibre): void {
    this.map = map;
    map.on("zoom", () => this.arrangeLabels());
    for (const element of [map.getContainer(), ...this.covers]) this.sizes.observe(element);
    map.on("remove", () => this.sizes.disconnect());
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
    this.arrangeLabels();
  }

  recolour(): void {}

  private arrangeLabels(): void {
    const { map } = this;
    if (map === null) return;
    const inOrder = [...this.markers.values()].sort(
      (a, b) => rank(a.label.key) - rank(b.label.key),
    );
    const spots = inOrder.flatMap(({ label }) => label.spot(map) ?? []);
    this.places = placeLabels(spots, this.places, this.view);
    for (const { label } of inOrder) {
      const place = this.places.get(label.key);
      if (place !== undefined) label.place(place);
    }
  }

  private measure(entries: readonly ResizeObserverEntry[]): void {
    for (const marker of this.markers.values()) {
      const box = entries.find(({ target }) => target === marker.label.element)?.borderBoxSize[0];
      if (box !== undefined) marker.label.measured(box.inlineSize, box.blockSize);
    }
    if (this.map !== null) this.view = viewOf(this.map, this.covers);
    this.arrangeLabels();
  }

  private markerOf(key: number): VehicleMarker {
    const known = this.markers.get(key);
    if (known !== undefined) return known;
    const marker = new VehicleMarker(key, this.press);
    this.markers.set(key, marker);
    this.sizes.observe(marker.label.element);
    return marker;
  }

  private removeAllBut(placed: ReadonlySet<number>): void {
    for (const [key, marker] of this.markers) {
      if (placed.has(key)) continue;
      this.sizes.unobserve(marker.label.element);
      marker.remove();
      this.markers.delete(key);
    }
  }
}

function viewOf(map: MapLibre, covers: readonly HTMLElement[]): LabelView {
  const frame = map.getContainer().getBoundingClientRect();
  const children = covers.flatMap((element) => [...element.children]);
  const covered = children.map((child) => {
    const { left, top, right, bottom } = child.getBoundingClientRect();
    return {
      left: left - frame.left,
      top: top - frame.top,
      right: right - frame.left,
      bottom: bottom - frame.top,
    };
  });
  return { width_px: frame.width, height_px: frame.height, covered };
}

/** Sorts by number; unidentified vehicles have negative keys and come last. */
function rank(key: number): number {
  return key > 0 ? key : Number.MAX_SAFE_INTEGER / 2 - key;
}
