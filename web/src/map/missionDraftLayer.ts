import { type Map as MapLibre, Marker } from "maplibre-gl";
import { text } from "../text/catalogue";
import { formatHeight } from "../text/units";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, type Point, setFeatures } from "./features";
import { type LonLat, metresPerDegree } from "./localGrid";
import type { Layer, Scene } from "./scene";

const SOURCE = "mission-draft";
const CASING = "mission-draft-casing";
const LINE = "mission-draft-line";

/** A mission being drawn, as the map shows it. */
export interface MissionShape {
  /** Where its vehicle is; null while unknown. */
  readonly from: LonLat | null;
  readonly points: readonly MissionMark[];
}

interface MissionMark {
  readonly id: number;
  readonly at: LonLat;
  readonly height_m: number | null;
  readonly isSelected: boolean;
  /** Whether the gate's refusal names it. */
  readonly isRefused: boolean;
}

/** What a person does with a point on the map. */
interface MissionEvents {
  select(id: number): void;
  move(id: number, at: LonLat): void;
  remove(id: number): void;
}

/** A mission being drawn: a dashed line, and points that are dragged, or moved and deleted by keys. */
export class MissionDraftLayer implements Layer {
  private map: MapLibre | null = null;
  private shown: MissionShape | null = null;
  private readonly markers = new Map<number, Marker>();

  constructor(private readonly events: MissionEvents) {}

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addLayer({
      id: CASING,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.casing, "line-width": 6, "line-opacity": 0.8 },
    });
    map.addLayer({
      id: LINE,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.text, "line-width": 3, "line-dasharray": [2, 1] },
    });
  }

  update({ missionDraft }: Scene): void {
    const { map } = this;
    if (map === null || missionDraft === this.shown) return;
    this.shown = missionDraft;
    const points = missionDraft?.points ?? [];
    setFeatures(map, SOURCE, missionDraft === null ? [] : lineOf(missionDraft));
    for (const [index, point] of points.entries()) this.mark(map, point, index + 1);
    for (const [id, marker] of this.markers) {
      if (points.some((point) => point.id === id)) continue;
      marker.remove();
      this.markers.delete(id);
    }
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(CASING, "line-color", colours.casing);
    this.map?.setPaintProperty(LINE, "line-color", colours.text);
  }

  private mark(map: MapLibre, point: MissionMark, number: number): void {
    const marker = this.markers.get(point.id) ?? this.made(map, point);
    const element = marker.getElement();
    const height = formatHeight(point.height_m);
    element.dataset["number"] = String(number);
    element.dataset["height"] = height;
    element.ariaLabel = text.mission.pointOnMap(number, height);
    element.ariaPressed = String(point.isSelected);
    element.classList.toggle("is-refused", point.isRefused);
    marker.setLngLat([point.at.lon, point.at.lat]);
  }

  private made(map: MapLibre, { id, at }: MissionMark): Marker {
    const element = document.createElement("button");
    element.type = "button";
    element.className = "mission-point";
    const marker = new Marker({ element, draggable: true }).setLngLat([at.lon, at.lat]).addTo(map);
    const place = () => {
      const { lng: lon, lat } = marker.getLngLat();
      return { lon, lat };
    };
    marker.on("dragstart", () => this.events.select(id));
    marker.on("drag", () => this.events.move(id, place()));
    element.addEventListener("click", (event) => {
      event.stopPropagation();
      this.events.select(id);
    });
    element.addEventListener("keydown", (event) => {
      const moved = movedBy(event, place());
      if (event.key === "Delete") this.events.remove(id);
      else if (moved !== null) this.events.move(id, moved);
      else return;
      // The map would move under its arrow keys.
      event.stopPropagation();
      event.preventDefault();
    });
    this.markers.set(id, marker);
    return marker;
  }
}

/** How far an arrow key moves a point, and with Shift. */
const KEY_STEP_M = 1;
const FAR_STEP_M = 10;
const ARROWS: Readonly<Record<string, readonly [east: number, north: number]>> = {
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
};

/** Where an arrow key moves a point to; null for another key. */
export function movedBy(
  { key, shiftKey }: Pick<KeyboardEvent, "key" | "shiftKey">,
  { lon, lat }: LonLat,
): LonLat | null {
  const arrow = ARROWS[key];
  if (arrow === undefined) return null;
  const step_m = shiftKey ? FAR_STEP_M : KEY_STEP_M;
  const per = metresPerDegree(lat);
  return { lon: lon + (arrow[0] * step_m) / per.lon, lat: lat + (arrow[1] * step_m) / per.lat };
}

function lineOf({ from, points }: MissionShape) {
  const places = [...(from === null ? [] : [from]), ...points.map(({ at }) => at)];
  const coordinates = places.map(({ lon, lat }): Point => [lon, lat]);
  if (coordinates.length < 2) return [];
  return [lineFeature(coordinates, {})];
}
