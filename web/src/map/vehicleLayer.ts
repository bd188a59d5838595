import { type GeoJSONSource, type Map as MapLibre, Marker } from "maplibre-gl";
import { simulation, stalenessNow, vehicleKey, vehicleStatus } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { agedBy, formatAge, formatQuantity } from "../text/quantities";
import { clustersOf, type Spot } from "./clusters";
import { addFeatures } from "./features";
import type { LonLat } from "./localGrid";
import { type Layer, positionOf, type Scene } from "./scene";
import { type MarkerPress, VehicleMarker } from "./vehicleMarker";

const SOURCE = "vehicle-labels";
const LABELS = "vehicle-labels";
const PILL = "vehicle-pill";
/** Below this zoom heights are left out, except of the selected vehicles. */
const HEIGHTS_FROM_ZOOM = 14;

interface Placed {
  readonly vehicle: VehicleView;
  readonly at: LonLat;
  readonly isSelected: boolean;
  readonly isStale: boolean;
}

/**
 * All vehicles with a known position: symbols as elements, which keyboard and screen readers reach; labels by
 * MapLibre, which drops those without room; clusters where many would hide each other.
 */
export class VehicleLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly markers = new Map<number, VehicleMarker>();
  private readonly bubbles: Marker[] = [];
  private placed: readonly Placed[] = [];
  private labelled = "";
  private clustered: ReadonlySet<number> = new Set();

  constructor(private readonly press: MarkerPress) {}

  add(map: MapLibre): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addImage(PILL, pillImage(), {
      stretchX: [[14, 18]],
      stretchY: [[11, 13]],
      content: [8, 2, 24, 22],
      pixelRatio: 1,
    });
    map.addLayer({
      id: LABELS,
      type: "symbol",
      source: SOURCE,
      layout: {
        "text-field": ["get", "text"],
        // Drawn by the browser: the style has no glyphs, so nothing is fetched. The first name sets the weight.
        "text-font": ["Recon Semibold", "sans-serif"],
        "text-size": 15,
        "text-max-width": 30,
        "text-padding": 1,
        "symbol-sort-key": ["get", "rank"],
        "icon-image": PILL,
        "icon-text-fit": "both",
        "text-variable-anchor-offset": [
          "left",
          [1.7, 0],
          "right",
          [-1.7, 0],
          "top",
          [0, 1.7],
          "bottom",
          [0, -1.7],
        ],
      },
      paint: { "text-color": ["get", "colour"] },
    });
    map.on("zoom", () => this.cluster());
    map.on("moveend", () => this.cluster());
  }

  update(scene: Scene): void {
    const { map } = this;
    if (map === null) return;
    const isMixed = simulation(scene.state.vehicles) === "mixed";
    this.placed = scene.state.vehicles.flatMap((vehicle) => placedOf(vehicle, scene) ?? []);
    for (const { vehicle, at, isSelected } of this.placed) {
      const marker = this.markerOf(vehicleKey(vehicle));
      marker.show(map, vehicle, at, scene.behindS, isSelected, isMixed);
    }
    this.removeAllBut(new Set(this.placed.map(({ vehicle }) => vehicleKey(vehicle))));
    this.cluster();
    this.label(scene.behindS);
  }

  recolour(): void {}

  private label(behindS: number): void {
    const { map } = this;
    if (map === null) return;
    const isNear = map.getZoom() >= HEIGHTS_FROM_ZOOM;
    const features = this.placed
      .filter((one) => one.isSelected || one.isStale || (isNear && this.isLabelled(one)))
      .map((placed) => feature(placed, behindS));
    const labelled = JSON.stringify(features);
    if (labelled === this.labelled) return;
    this.labelled = labelled;
    map.getSource<GeoJSONSource>(SOURCE)?.setData({ type: "FeatureCollection", features });
  }

  /** On the ground a height means nothing, and a cluster has its own number. */
  private isLabelled({ vehicle }: Placed): boolean {
    return vehicle.is_flying.value !== false && !this.clustered.has(vehicleKey(vehicle));
  }

  /** Puts a count where many symbols would hide each other; a press zooms in on them. */
  private cluster(): void {
    const { map } = this;
    if (map === null) return;
    const spots = this.placed.map((placed) => spotOf(map, placed));
    const clusters = clustersOf(spots);
    this.clustered = new Set(clusters.flatMap(({ keys }) => keys));
    for (const [key, marker] of this.markers) marker.setClustered(this.clustered.has(key));
    while (this.bubbles.length > clusters.length) this.bubbles.pop()?.remove();
    for (const [index, { keys, x_px, y_px }] of clusters.entries()) {
      const at = map.unproject([x_px, y_px]);
      const bubble = this.bubbles[index] ?? new Marker({ element: bubbleElement(map) });
      this.bubbles[index] = bubble;
      const element = bubble.getElement();
      element.textContent = String(keys.length);
      element.setAttribute("aria-label", `${keys.length} vehicles: zoom in`);
      bubble.setLngLat(at);
      if (!element.isConnected) bubble.addTo(map);
    }
  }

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

function placedOf(vehicle: VehicleView, scene: Scene): Placed | null {
  const at = positionOf(vehicle);
  if (at === null) return null;
  const isSelected = scene.selected.includes(vehicleKey(vehicle));
  return { vehicle, at, isSelected, isStale: stalenessNow(vehicle, scene.behindS) !== "live" };
}

function spotOf(map: MapLibre, { vehicle, at, isSelected, isStale }: Placed): Spot {
  const { x, y } = map.project([at.lon, at.lat]);
  const isTrouble = isStale || vehicleStatus(vehicle, 0).severity !== null;
  return { key: vehicleKey(vehicle), x_px: x, y_px: y, standsAlone: isSelected || isTrouble };
}

function feature(placed: Placed, behindS: number) {
  const { vehicle, at, isSelected, isStale } = placed;
  return {
    type: "Feature" as const,
    geometry: { type: "Point" as const, coordinates: [at.lon, at.lat] },
    properties: {
      text: labelText(placed, behindS),
      colour: isStale ? "#ffc2cd" : "#ffffff",
      // The lowest finds its place first: the selected, then those in trouble, then by number.
      rank: (isSelected ? 0 : isStale ? 1000 : 2000) + Math.max(0, vehicle.number),
    },
  };
}

/** Height, or how old; with the name while selected. */
function labelText({ vehicle, isSelected, isStale }: Placed, behindS: number): string {
  const age = formatAge(agedBy(vehicle.telemetry_age_s, behindS));
  const state = isStale ? `${age} old` : heightText(vehicle);
  return isSelected ? `${vehicle.name} · ${state}` : state;
}

function heightText(vehicle: VehicleView): string {
  if (vehicle.is_flying.value !== true) return "on ground";
  return formatQuantity(vehicle.height_above_takeoff_m.value, "m", 0);
}

function bubbleElement(map: MapLibre): HTMLElement {
  const element = document.createElement("button");
  element.type = "button";
  element.className = "craft-cluster";
  element.addEventListener("click", (event) => {
    event.stopPropagation();
    const frame = map.getContainer().getBoundingClientRect();
    const box = element.getBoundingClientRect();
    const middle: [number, number] = [
      box.left + box.width / 2 - frame.left,
      box.top + box.height / 2 - frame.top,
    ];
    map.easeTo({ center: map.unproject(middle), zoom: map.getZoom() + 1.5, duration: 300 });
  });
  return element;
}

/** A dark rounded rectangle, stretched to each label; dark on every ground and theme. */
function pillImage(): ImageData {
  const [width, height] = [32, 24];
  const canvas = new OffscreenCanvas(width, height);
  const pen = canvas.getContext("2d");
  if (pen === null) return new ImageData(width, height);
  pen.fillStyle = "rgb(16 22 24 / 82%)";
  pen.beginPath();
  pen.roundRect(0, 0, width, height, 11);
  pen.fill();
  return pen.getImageData(0, 0, width, height);
}
