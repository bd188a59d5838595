import { type Map as MapLibre, Marker } from "maplibre-gl";
import {
  badgeText,
  simulation,
  stalenessNow,
  vehicleKey,
  vehicleStatus,
} from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { vehicleLabel } from "../text/names";
import { agedBy, formatAge } from "../text/quantities";
import { formatHeight } from "../text/units";
import { clustersOf, type Spot } from "./clusters";
import { EdgeMarkers, edgeMarksOf, type NamedSpot } from "./edgeMarks";
import { type Frame, type LabelSpot, placeLabels, type Side } from "./labels";
import type { LonLat } from "./localGrid";
import { type Layer, positionOf, type Scene } from "./scene";
import { targetOf } from "./targetLayer";
import type { Target } from "./targetMarkers";
import { isInSight, onCoversChange, uncoveredOf } from "./uncovered";
import { type MarkerPress, VehicleMarker } from "./vehicleMarker";

/** Below this zoom heights are excluded, except of the selected vehicles. */
const HEIGHTS_FROM_ZOOM = 14;

interface Placed {
  readonly vehicle: VehicleView;
  readonly at: LonLat;
  readonly isSelected: boolean;
  readonly isStale: boolean;
  readonly text: string;
}

/** A vehicle's place on the screen. */
interface PlacedSpot extends Spot, LabelSpot, NamedSpot {
  /** Whether its label is shown at every zoom. */
  readonly isMarked: boolean;
  readonly isStale: boolean;
  readonly isOnGround: boolean;
}

/**
 * All vehicles with a known position: symbols as elements, which keyboard and screen readers reach, with labels where
 * there is room; clusters where many would hide each other. The map itself is not drawn again for any of them: without
 * a GPU that takes longer than the time between two states.
 */
export class VehicleLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly markers = new Map<number, VehicleMarker>();
  private readonly bubbles: Marker[] = [];
  private placed: readonly Placed[] = [];
  private targets: readonly Target[] = [];
  private sides = new Map<number, Side>();
  private edges: EdgeMarkers | null = null;

  constructor(private readonly press: MarkerPress) {}

  add(map: MapLibre): void {
    this.map = map;
    this.edges = new EdgeMarkers(map);
    map.on("move", () => this.arrange());
    onCoversChange(map, () => this.arrange());
  }

  update(scene: Scene): void {
    const { map } = this;
    if (map === null) return;
    const isMixed = simulation(scene.state.vehicles) === "mixed";
    this.placed = scene.state.vehicles.flatMap((vehicle) => placedOf(vehicle, scene) ?? []);
    this.targets = scene.state.vehicles.flatMap(targetOf);
    for (const { vehicle, isSelected } of this.placed) {
      const marker = this.markerOf(map, vehicleKey(vehicle));
      marker.show(vehicle, scene.behindS, isSelected, isMixed);
    }
    this.removeAllBut(new Set(this.placed.map(({ vehicle }) => vehicleKey(vehicle))));
    this.arrange();
  }

  recolour(): void {}

  /** Puts everything in its place on the screen. */
  private arrange(): void {
    const { map } = this;
    if (map === null) return;
    const spots = this.placed.map((placed) => spotOf(map, placed));
    for (const { key, x_px, y_px } of spots) this.markers.get(key)?.moveTo(x_px, y_px);
    const alone = this.cluster(map, spots);
    const isNear = map.getZoom() >= HEIGHTS_FROM_ZOOM;
    // On the ground a height means nothing, and a cluster has its own number.
    const wanted = alone.filter((spot) => spot.isMarked || (isNear && !spot.isOnGround));
    const fixed = this.targets.map((one) => ({ text: one.text, ...onScreen(map, one.at) }));
    const uncovered = uncoveredOf(map.getContainer());
    const isShown = (frame: Frame) => isInSight(frame, uncovered);
    this.edges?.show(edgeMarksOf(spots, uncovered));
    this.sides = placeLabels(wanted, alone, this.sides, fixed, isShown);
    for (const { key, text: label, isStale } of spots)
      this.markers.get(key)?.setLabel(label, this.sides.get(key), isStale);
  }

  /** Puts a count where many symbols would hide each other, and returns the others; a press zooms in on them. */
  private cluster(map: MapLibre, spots: readonly PlacedSpot[]): readonly PlacedSpot[] {
    const clusters = clustersOf(spots);
    const clustered = new Set(clusters.flatMap(({ keys }) => keys));
    for (const [key, marker] of this.markers) marker.setClustered(clustered.has(key));
    while (this.bubbles.length > clusters.length) this.bubbles.pop()?.remove();
    for (const [index, { keys, x_px, y_px }] of clusters.entries()) {
      const at = map.unproject([x_px, y_px]);
      const bubble = this.bubbles[index] ?? new Marker({ element: bubbleElement(map) });
      this.bubbles[index] = bubble;
      const element = bubble.getElement();
      element.textContent = String(keys.length);
      element.setAttribute("aria-label", text.map.cluster(keys.length));
      bubble.setLngLat(at);
      if (!element.isConnected) bubble.addTo(map);
    }
    return spots.filter(({ key }) => !clustered.has(key));
  }

  private markerOf(map: MapLibre, key: number): VehicleMarker {
    const known = this.markers.get(key);
    if (known !== undefined) return known;
    const marker = new VehicleMarker(key, this.press, map.getCanvasContainer());
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
  const isStale = stalenessNow(vehicle, scene.behindS) !== "live";
  const label = labelText(vehicle, isSelected, isStale, scene.behindS);
  return { vehicle, at, isSelected, isStale, text: label };
}

function spotOf(
  map: MapLibre,
  { vehicle, at, isSelected, isStale, text: label }: Placed,
): PlacedSpot {
  const isTrouble = isStale || vehicleStatus(vehicle, 0).severity !== null;
  return {
    key: vehicleKey(vehicle),
    ...onScreen(map, at),
    badge: badgeText(vehicle),
    name: vehicleLabel(vehicle),
    standsAlone: isSelected || isTrouble,
    isMarked: isSelected || isStale,
    isStale,
    isOnGround: vehicle.is_flying.value === false,
    text: label,
    // The selected first, then those in trouble, then by number.
    rank: (isSelected ? 0 : isStale ? 1000 : 2000) + Math.max(0, vehicle.number),
  };
}

function onScreen(map: MapLibre, at: LonLat) {
  // Beside the date line the nearer of its places.
  const turns = Math.round((map.getCenter().lng - at.lon) / 360);
  const { x, y } = map.project([at.lon + 360 * turns, at.lat]);
  return { x_px: x, y_px: y };
}

/** Height, or how old; with the name while selected. */
function labelText(
  vehicle: VehicleView,
  isSelected: boolean,
  isStale: boolean,
  behindS: number,
): string {
  const age = formatAge(agedBy(vehicle.telemetry_age_s, behindS));
  const state = isStale ? text.map.old(age) : heightText(vehicle);
  return isSelected ? `${vehicle.name} · ${state}` : state;
}

function heightText(vehicle: VehicleView): string {
  if (vehicle.is_flying.value !== true) return text.map.onGround;
  return formatHeight(vehicle.height_above_takeoff_m.value);
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
