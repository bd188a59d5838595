import { type Map as MapLibre, Marker } from "maplibre-gl";
import type { LonLat } from "./localGrid";

/** A target position with its label. */
export interface Target {
  readonly key: number;
  readonly at: LonLat;
  /** A CSS colour. */
  readonly colour: string;
  readonly text: string;
}

interface TargetMarker {
  readonly marker: Marker;
  readonly text: HTMLElement;
}

/** Target markers: a ring with a cross, and the label above it. */
export class TargetMarkers {
  private readonly shown = new Map<number, TargetMarker>();

  /** `className` distinguishes unconfirmed targets from active ones. */
  constructor(private readonly className = "target-active") {}

  show(map: MapLibre, targets: readonly Target[]): void {
    for (const target of targets) {
      const { marker, text } = this.shownFor(target);
      if (text.textContent !== target.text) text.textContent = target.text;
      moveTo(marker, map, target.at);
    }
    const kept = new Set(targets.map(({ key }) => key));
    for (const [key, { marker }] of this.shown) {
      if (kept.has(key)) continue;
      marker.remove();
      this.shown.delete(key);
    }
  }

  private shownFor(target: Target): TargetMarker {
    const known = this.shown.get(target.key);
    if (known !== undefined) return known;
    const element = document.createElement("div");
    element.className = `target ${this.className}`;
    element.style.setProperty("--own", target.colour);
    const text = document.createElement("span");
    text.className = "target-text";
    element.append(text);
    const made = { marker: new Marker({ element, anchor: "center" }), text };
    this.shown.set(target.key, made);
    return made;
  }
}

/** Moves a marker and adds it to the map if needed. */
function moveTo(marker: Marker, map: MapLibre, at: LonLat): void {
  const isOnMap = marker.getElement().isConnected;
  const before = isOnMap ? marker.getLngLat() : null;
  if (before === null || before.lng !== at.lon || before.lat !== at.lat) {
    marker.setLngLat([at.lon, at.lat]);
  }
  if (!isOnMap) marker.addTo(map);
}
