import { type Map as MapLibre, Marker } from "maplibre-gl";
import { stalenessNow } from "../fleet/staleness";
import { vehicleCondition } from "../fleet/vehicleWord";
import { colourOf } from "../look/identity";
import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../words/names";
import type { LonLat } from "./localGrid";
import { MarkerLabel, moveTo } from "./markerLabel";

const SVG = "http://www.w3.org/2000/svg";
/** An arrow head that points up, and a disc for when the heading is unknown; both 40 by 40. */
const ARROW = "M20 2 33 36 20 28.5 7 36Z";
const DISC = "M20 8a12 12 0 1 0 .01 0Z";

/** What a press on a vehicle means. */
export interface MarkerPress {
  select(key: number): void;
  toggle(key: number): void;
}

/** One vehicle on the map: an arrow turned to its heading, and its label. */
export class VehicleMarker {
  /** On its own, under all symbols, so that no label hides another vehicle. */
  readonly label: MarkerLabel;
  private readonly button = document.createElement("button");
  private readonly symbol = document.createElementNS(SVG, "svg");
  private readonly path = document.createElementNS(SVG, "path");
  /** A wide edge around the path, so that it stands out on any ground. */
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

  /** Brings the marker up to date, and onto the map when it is not there yet. */
  show(map: MapLibre, vehicle: VehicleView, at: LonLat, behindS: number, isSelected: boolean) {
    const yaw_deg = vehicle.attitude.yaw_deg;
    for (const path of [this.casing, this.path]) {
      setAttribute(path, "d", yaw_deg === null ? DISC : ARROW);
    }
    // Whole degrees: a finer turn is not seen, and would be drawn anew all the time.
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

/** Touching the page costs even when nothing changes by it. */
function setAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function describe(vehicle: VehicleView, behindS: number): string {
  const kind = vehicle.is_simulated ? "simulated vehicle" : "vehicle";
  return `${kind} ${vehicleLabel(vehicle)}, ${vehicleCondition(vehicle, behindS).word}`;
}
