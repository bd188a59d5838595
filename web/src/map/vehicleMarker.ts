import { type Map as MapLibre, Marker } from "maplibre-gl";
import { badgeText } from "../fleet/key";
import { stalenessNow } from "../fleet/staleness";
import { vehicleCondition } from "../fleet/vehicleWord";
import { colourOf } from "../look/identity";
import type { VehicleView } from "../protocol";
import { agedBy, formatAge } from "../words/age";
import { vehicleLabel } from "../words/names";
import { formatQuantity } from "../words/quantity";
import type { LonLat } from "./localGrid";

const SVG = "http://www.w3.org/2000/svg";
/** An arrow head that points up, and a disc for when the heading is unknown; both 40 by 40. */
const ARROW = "M20 2 33 36 20 28.5 7 36Z";
const DISC = "M20 8a12 12 0 1 0 .01 0Z";

/** What a press on a vehicle means. */
export interface MarkerPress {
  select(key: number): void;
  toggle(key: number): void;
}

/** One vehicle on the map: an arrow turned to its heading, under it its number, name and state. */
export class VehicleMarker {
  private readonly button = document.createElement("button");
  private readonly symbol = document.createElementNS(SVG, "svg");
  private readonly path = document.createElementNS(SVG, "path");
  /** A wide edge around the path, so that it stands out on any ground. */
  private readonly casing = document.createElementNS(SVG, "path");
  private readonly label = document.createElement("span");
  private readonly marker: Marker;
  /** On its own, under all symbols, so that no label hides another vehicle. */
  private readonly labelMarker: Marker;

  constructor(key: number, press: MarkerPress) {
    this.button.type = "button";
    this.button.className = "craft own-colour";
    this.button.style.setProperty("--own", colourOf(key));
    this.symbol.setAttribute("viewBox", "0 0 40 40");
    this.symbol.setAttribute("aria-hidden", "true");
    this.casing.setAttribute("class", "craft-casing");
    this.symbol.append(this.casing, this.path);
    this.label.className = "craft-label own-colour";
    this.label.setAttribute("aria-hidden", "true");
    this.label.style.setProperty("--own", colourOf(key));
    this.button.append(this.symbol);
    this.button.addEventListener("click", (event) => {
      event.stopPropagation();
      if (event.shiftKey || event.ctrlKey || event.metaKey) press.toggle(key);
      else press.select(key);
    });
    this.marker = new Marker({ element: this.button, anchor: "center" });
    this.labelMarker = new Marker({ element: this.label, anchor: "top", offset: [0, 26] });
  }

  /** Brings the marker up to date, and onto the map when it is not there yet. */
  show(map: MapLibre, vehicle: VehicleView, at: LonLat, behindS: number, isSelected: boolean) {
    const staleness = stalenessNow(vehicle, behindS);
    const yaw_deg = vehicle.attitude.yaw_deg;
    for (const path of [this.casing, this.path]) {
      path.setAttribute("d", yaw_deg === null ? DISC : ARROW);
    }
    this.symbol.style.transform = `rotate(${yaw_deg ?? 0}deg)`;
    const classes = this.button.classList;
    classes.toggle("is-simulated", vehicle.is_simulated);
    classes.toggle("is-stale", staleness !== "live");
    classes.toggle("is-grounded", vehicle.is_flying.value === false);
    classes.toggle("is-selected", isSelected);
    this.button.setAttribute("aria-pressed", String(isSelected));
    this.button.setAttribute("aria-label", describe(vehicle, behindS));
    this.label.replaceChildren(...labelParts(vehicle, behindS, staleness !== "live"));
    this.label.classList.toggle("is-stale", staleness !== "live");
    for (const marker of [this.marker, this.labelMarker]) {
      marker.setLngLat([at.lon, at.lat]);
      if (!marker.getElement().isConnected) marker.addTo(map);
    }
  }

  remove(): void {
    this.marker.remove();
    this.labelMarker.remove();
  }
}

function labelParts(vehicle: VehicleView, behindS: number, isStale: boolean): HTMLElement[] {
  const parts = [part("badge", badgeText(vehicle)), part("craft-name", vehicle.name)];
  if (vehicle.is_simulated) parts.push(part("tag tag-simulated", "SIM"));
  if (isStale) {
    const age = formatAge(agedBy(vehicle.telemetry_age_s, behindS));
    parts.push(part("craft-age", `${age} old`));
  } else {
    const height = vehicle.height_above_takeoff_m.value;
    const isUp = vehicle.is_flying.value === true;
    parts.push(part("craft-height", isUp ? `↥ ${formatQuantity(height, "m", 0)}` : "on ground"));
  }
  return parts;
}

function part(className: string, text: string): HTMLElement {
  const element = document.createElement("span");
  element.className = className;
  element.textContent = text;
  return element;
}

function describe(vehicle: VehicleView, behindS: number): string {
  const kind = vehicle.is_simulated ? "simulated vehicle" : "vehicle";
  return `${kind} ${vehicleLabel(vehicle)}, ${vehicleCondition(vehicle, behindS).word}`;
}
