import { badgeText, stalenessNow, vehicleStatus } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { vehicleLabel } from "../text/names";
import { colourOf, lookClasses } from "../theme/theme";
import type { Side } from "./labels";

const SVG = "http://www.w3.org/2000/svg";
/**
 * A nose that points up beyond the badge, over a larger one as its outline; 48 x 48. An outline as a stroke would take
 * a browser without a GPU as long as everything else of 64 vehicles.
 */
const NOSES = { "nose-casing": "M24 -2 35 16H13Z", nose: "M24 0 33 15H15Z" };
const HALF_PX = 24;

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
  private readonly label = document.createElement("span");
  private readonly symbol = document.createElementNS(SVG, "svg");

  constructor(key: number, press: MarkerPress, container: HTMLElement) {
    this.button.type = "button";
    this.button.className = `craft own-colour ${lookClasses(key)}`;
    this.button.style.setProperty("--own", colourOf(key));
    this.symbol.setAttribute("viewBox", "0 0 48 48");
    this.symbol.setAttribute("aria-hidden", "true");
    for (const [name, shape] of Object.entries(NOSES)) {
      const nose = document.createElementNS(SVG, "path");
      nose.setAttribute("class", name);
      nose.setAttribute("d", shape);
      this.symbol.append(nose);
    }
    this.badge.className = "badge";
    this.label.hidden = true;
    this.label.setAttribute("aria-hidden", "true");
    this.button.append(this.symbol, this.badge);
    this.button.addEventListener("click", (event) => {
      event.stopPropagation();
      if (event.shiftKey || event.ctrlKey || event.metaKey) press.toggle(key);
      else press.select(key);
    });
    container.append(this.button, this.label);
  }

  /** Shows a vehicle's state. */
  show(vehicle: VehicleView, behindS: number, isSelected: boolean, isMixed: boolean): void {
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
    const description = describe(vehicle, behindS);
    setAttribute(this.button, "aria-label", description);
    setAttribute(this.button, "title", description);
    if (this.badge.textContent !== badgeText(vehicle)) this.badge.textContent = badgeText(vehicle);
  }

  /** Moves it to a place on the map's screen, as its middle. */
  moveTo(x_px: number, y_px: number): void {
    // In two dimensions: MapLibre's own markers are each a layer of the browser's, drawn and laid over one by one.
    const place = `translate(${Math.round(x_px) - HALF_PX}px, ${Math.round(y_px) - HALF_PX}px)`;
    setStyle(this.button, "transform", place);
    setStyle(this.label, "transform", place);
  }

  /** Shows a text beside the symbol; without a side it has no room. */
  setLabel(label: string, side: Side | undefined, isStale: boolean): void {
    const isHidden = side === undefined;
    if (this.label.hidden !== isHidden) this.label.hidden = isHidden;
    if (isHidden) return;
    if (this.label.textContent !== label) this.label.textContent = label;
    const look = `craft-label is-${side}${isStale ? " is-stale" : ""}`;
    if (this.label.className !== look) this.label.className = look;
  }

  /** Hides it while a cluster stands for it. */
  setClustered(isClustered: boolean): void {
    if (this.button.hidden !== isClustered) this.button.hidden = isClustered;
  }

  remove(): void {
    this.button.remove();
    this.label.remove();
  }
}

/** Writing to the DOM is expensive even without a change. */
function setAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function setStyle(element: SVGElement | HTMLElement, name: "transform", value: string): void {
  if (element.style[name] !== value) element.style[name] = value;
}

function describe(vehicle: VehicleView, behindS: number): string {
  const named = vehicle.is_simulated ? text.map.simulatedVehicle : text.map.vehicle;
  const { activity } = vehicleStatus(vehicle, behindS);
  return named(vehicleLabel(vehicle), text.activity.names[activity]);
}
