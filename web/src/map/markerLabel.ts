import { type Map as MapLibre, Marker } from "maplibre-gl";
import { badgeText } from "../fleet/key";
import { stalenessNow } from "../fleet/staleness";
import { colourOf } from "../look/identity";
import type { VehicleView } from "../protocol";
import { agedBy, formatAge } from "../words/age";
import { formatQuantity } from "../words/quantity";
import { type LabelPlace, type LabelSpot, leaderOf } from "./labelPlaces";
import type { LonLat } from "./localGrid";

/** What a label is taken to measure until the browser has laid it out. */
const FIRST_SIZE = { width_px: 150, height_px: 34 };

/** A vehicle's number, name and state beside its symbol, with a thin line to it when moved away. */
export class MarkerLabel {
  readonly element = document.createElement("span");
  private readonly badge = part("badge");
  private readonly name = part("craft-name");
  private readonly simulated = part("tag tag-simulated");
  private readonly height = part("craft-height");
  private readonly age = part("craft-age");
  private readonly leader = part("craft-leader");
  private readonly marker: Marker;
  private size = FIRST_SIZE;
  private at: LonLat | null = null;
  private placed = "";

  constructor(readonly key: number) {
    this.element.className = "craft-label own-colour";
    this.element.setAttribute("aria-hidden", "true");
    this.element.style.setProperty("--own", colourOf(key));
    this.simulated.textContent = "SIM";
    const { leader, badge, name, simulated, height, age } = this;
    this.element.append(leader, badge, name, simulated, height, age);
    this.marker = new Marker({ element: this.element, anchor: "top-left" });
  }

  /** Brings the text up to date and moves the label along with its vehicle. */
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

  /** The browser measured the label. */
  measured(width_px: number, height_px: number): void {
    this.size = { width_px, height_px };
  }

  /** Where the label's vehicle is on the screen, and how large the label is. */
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
    this.drawLeader(place);
  }

  remove(): void {
    this.marker.remove();
  }

  private drawLeader(place: LabelPlace): void {
    const leader = leaderOf(place, this.size);
    this.leader.hidden = leader === null;
    if (leader === null) return;
    const { style } = this.leader;
    style.left = `${leader.x_px}px`;
    style.top = `${leader.y_px}px`;
    style.width = `${leader.length_px}px`;
    style.transform = `rotate(${leader.angle_rad}rad)`;
  }
}

/** Moves a marker, and puts it onto the map when it is not there yet. */
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

/** Touching the page costs even when nothing changes by it. */
function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

function part(className: string): HTMLElement {
  const element = document.createElement("span");
  element.className = className;
  return element;
}
