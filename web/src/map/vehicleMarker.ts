import { type Map as MapLibre, Marker } from "maplibre-gl";
import { badgeText, stalenessNow, vehicleStatus } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";
import { agedBy, formatAge, formatQuantity } from "../text/quantities";
import { colourOf } from "../theme/theme";
import { type LabelPlace, type LabelSpot, labelLine } from "./labelPlacement";
import type { LonLat } from "./localGrid";

const SVG = "http://www.w3.org/2000/svg";
/** Arrow pointing up, and a disc for an unknown heading; both 40 x 40. */
const ARROW = "M20 2 33 36 20 28.5 7 36Z";
const DISC = "M20 8a12 12 0 1 0 .01 0Z";

/** Actions of a press on a vehicle. */
export interface MarkerPress {
  select(key: number): void;
  toggle(key: number): void;
}

/** One vehicle on the map: an arrow pointing along its heading, and its label. */
export class VehicleMarker {
  /** A separate marker below all symbols, so that no label hides a vehicle. */
  readonly label: MarkerLabel;
  private readonly button = document.createElement("button");
  private readonly symbol = document.createElementNS(SVG, "svg");
  private readonly path = document.createElementNS(SVG, "path");
  /** A wide outline, visible on any background. */
  private readonly casing = document.createElementNS(SVG, "path");
  private readonly marker: Marker;

  constructor(key: number, press: MarkerPress) {
    this.button.type = "button";
    this.button.className = "craft own-colour";
    this.button.style.setProperty("--own", colourOf(key));
    this.symbol.setAttribute("viewBox", "0 0 40 40");
    this.symbol.setAttribute("aria-hidden", "true");
    this.casing.setAttribute("class", "craft-casing");
    this.symbol.append(this.casing, this.path);
    this.button.append(this.symbol);
    this.button.addEventListener("click", (event) => {
      event.stopPropagation();
      if (event.shiftKey || event.ctrlKey || event.metaKey) press.toggle(key);
      else press.select(key);
    });
    this.marker = new Marker({ element: this.button, anchor: "center" });
    this.label = new MarkerLabel(key);
  }

  /** Updates the marker and adds it to the map if needed. */
  show(map: MapLibre, vehicle: VehicleView, at: LonLat, behindS: number, isSelected: boolean) {
    const yaw_deg = vehicle.attitude.yaw_deg;
    for (const path of [this.casing, this.path]) {
      setAttribute(path, "d", yaw_deg === null ? DISC : ARROW);
    }
    // Whole degrees: finer changes are invisible but would redraw constantly.
    this.symbol.style.transform = `rotate(${Math.round(yaw_deg ?? 0)}deg)`;
    const classes = this.button.classList;
    classes.toggle("is-simulated", vehicle.is_simulated);
    classes.toggle("is-stale", stalenessNow(vehicle, behindS) !== "live");
    classes.toggle("is-grounded", vehicle.is_flying.value === false);
    classes.toggle("is-selected", isSelected);
    setAttribute(this.button, "aria-pressed", String(isSelected));
    setAttribute(this.button, "aria-label", describe(vehicle, behindS));
    moveTo(this.marker, map, at);
    this.label.show(map, vehicle, at, behindS);
  }

  remove(): void {
    this.marker.remove();
    this.label.remove();
  }
}

/** Writing to the DOM is expensive even without a change. */
function setAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function describe(vehicle: VehicleView, behindS: number): string {
  const kind = vehicle.is_simulated ? "simulated vehicle" : "vehicle";
  return `${kind} ${vehicleLabel(vehicle)}, ${vehicleStatus(vehicle, behindS).activity}`;
}

/** Assumed label size until the browser has measured it. */
const FIRST_SIZE = { width_px: 150, height_px: 34 };

/** A vehicle's number, name and height beside its symbol, with a thin line to it when moved. */
export class MarkerLabel {
  readonly element = document.createElement("span");
  private readonly badge = part("badge");
  private readonly name = part("craft-name");
  private readonly simulated = part("tag tag-simulated");
  private readonly height = part("craft-height");
  private readonly age = part("craft-age");
  private readonly line = part("craft-label-line");
  private readonly marker: Marker;
  private size = FIRST_SIZE;
  private at: LonLat | null = null;
  private placed = "";

  constructor(readonly key: number) {
    this.element.className = "craft-label own-colour";
    this.element.setAttribute("aria-hidden", "true");
    this.element.style.setProperty("--own", colourOf(key));
    this.simulated.textContent = "SIM";
    const { line, badge, name, simulated, height, age } = this;
    this.element.append(line, badge, name, simulated, height, age);
    this.marker = new Marker({ element: this.element, anchor: "top-left" });
  }

  /** Updates the text and moves the label with its vehicle. */
  show(map: MapLibre, vehicle: VehicleView, at: LonLat, behindS: number): void {
    const isStale = stalenessNow(vehicle, behindS) !== "live";
    this.element.classList.toggle("is-stale", isStale);
    setText(this.badge, badgeText(vehicle));
    setText(this.name, vehicle.name);
    this.simulated.hidden = !vehicle.is_simulated;
    this.height.hidden = isStale;
    this.age.hidden = !isStale;
    const telemetryAgeS = agedBy(vehicle.telemetry_age_s, behindS);
    if (isStale) setText(this.age, `${formatAge(telemetryAgeS)} old`);
    else setText(this.height, heightText(vehicle));
    moveTo(this.marker, map, at);
    this.at = at;
  }

  /** Sets the measured size. */
  measured(width_px: number, height_px: number): void {
    this.size = { width_px, height_px };
  }

  /** The vehicle's position on the screen and the label's size. */
  spot(map: MapLibre): LabelSpot | null {
    if (this.at === null) return null;
    const { x, y } = map.project([this.at.lon, this.at.lat]);
    return { key: this.key, x_px: x, y_px: y, ...this.size };
  }

  place(place: LabelPlace): void {
    const { width_px, height_px } = this.size;
    const placed = [place.slot, width_px, height_px].join();
    if (placed === this.placed) return;
    this.placed = placed;
    this.marker.setOffset([place.dx_px, place.dy_px]);
    this.drawLine(place);
  }

  remove(): void {
    this.marker.remove();
  }

  private drawLine(place: LabelPlace): void {
    const line = labelLine(place, this.size);
    this.line.hidden = line === null;
    if (line === null) return;
    const { style } = this.line;
    style.left = `${line.x_px}px`;
    style.top = `${line.y_px}px`;
    style.width = `${line.length_px}px`;
    style.transform = `rotate(${line.angle_rad}rad)`;
  }
}

/** Moves a marker and adds it to the map if needed. */
export function moveTo(marker: Marker, map: MapLibre, at: LonLat): void {
  const isOnMap = marker.getElement().isConnected;
  const before = isOnMap ? marker.getLngLat() : null;
  if (before === null || before.lng !== at.lon || before.lat !== at.lat) {
    marker.setLngLat([at.lon, at.lat]);
  }
  if (!isOnMap) marker.addTo(map);
}

function heightText(vehicle: VehicleView): string {
  if (vehicle.is_flying.value !== true) return "on ground";
  return `↥ ${formatQuantity(vehicle.height_above_takeoff_m.value, "m", 0)}`;
}

/** Writing to the DOM is expensive even without a change. */
function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

function part(className: string): HTMLElement {
  const element = document.createElement("span");
  element.className = className;
  return element;
}
