import { type Map as MapLibre, Marker } from "maplibre-gl";
import { badgeText, stalenessNow, vehicleStatus } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";
import { colourOf, lookClasses } from "../theme/theme";
import type { LonLat } from "./localGrid";

const SVG = "http://www.w3.org/2000/svg";
/** A nose that points up beyond the badge; 48 x 48. */
const NOSE = "M24 0 33 15H15Z";

/** Actions of a press on a vehicle. */
export interface MarkerPress {
  select(key: number): void;
  toggle(key: number): void;
}

/**
 * One vehicle on the map: the badge of the list with its number, and a nose along its heading. The number is part
 * of the symbol, so that no label that finds no room takes the identity with it.
 */
export class VehicleMarker {
  private readonly button = document.createElement("button");
  private readonly badge = document.createElement("span");
  private readonly symbol = document.createElementNS(SVG, "svg");
  private readonly marker: Marker;

  constructor(key: number, press: MarkerPress) {
    this.button.type = "button";
    this.button.className = `craft own-colour ${lookClasses(key)}`;
    this.button.style.setProperty("--own", colourOf(key));
    this.symbol.setAttribute("viewBox", "0 0 48 48");
    this.symbol.setAttribute("aria-hidden", "true");
    const nose = document.createElementNS(SVG, "path");
    nose.setAttribute("d", NOSE);
    this.symbol.append(nose);
    this.badge.className = "badge";
    this.button.append(this.symbol, this.badge);
    this.button.addEventListener("click", (event) => {
      event.stopPropagation();
      if (event.shiftKey || event.ctrlKey || event.metaKey) press.toggle(key);
      else press.select(key);
    });
    this.marker = new Marker({ element: this.button, anchor: "center" });
  }

  /** Updates the marker and adds it to the map if needed. */
  show(
    map: MapLibre,
    vehicle: VehicleView,
    at: LonLat,
    behindS: number,
    isSelected: boolean,
    isMixed: boolean,
  ): void {
    const yaw_deg = vehicle.attitude.yaw_deg;
    // Whole degrees: finer changes are invisible but would redraw constantly.
    setStyle(this.symbol, "transform", `rotate(${Math.round(yaw_deg ?? 0)}deg)`);
    const classes = this.button.classList;
    classes.toggle("has-heading", yaw_deg !== null);
    classes.toggle("is-simulated", isMixed && vehicle.is_simulated);
    classes.toggle("is-imager", vehicle.is_imager);
    classes.toggle("is-stale", stalenessNow(vehicle, behindS) !== "live");
    classes.toggle("is-grounded", vehicle.is_flying.value === false);
    classes.toggle("is-selected", isSelected);
    setAttribute(this.button, "aria-pressed", String(isSelected));
    const text = describe(vehicle, behindS);
    setAttribute(this.button, "aria-label", text);
    setAttribute(this.button, "title", text);
    if (this.badge.textContent !== badgeText(vehicle)) this.badge.textContent = badgeText(vehicle);
    moveTo(this.marker, map, at);
  }

  /** Hides it while a cluster stands for it. */
  setClustered(isClustered: boolean): void {
    if (this.button.hidden !== isClustered) this.button.hidden = isClustered;
  }

  remove(): void {
    this.marker.remove();
  }
}

/** Writing to the DOM is expensive even without a change. */
function setAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function setStyle(element: SVGElement, name: "transform", value: string): void {
  if (element.style[name] !== value) element.style[name] = value;
}

function describe(vehicle: VehicleView, behindS: number): string {
  const kind = vehicle.is_simulated ? "simulated vehicle" : "vehicle";
  return `${kind} ${vehicleLabel(vehicle)}, ${vehicleStatus(vehicle, behindS).activity}`;
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
