import { type Map as MapLibre, Marker } from "maplibre-gl";
import type { AreaView, TemporaryZoneView } from "../protocol";
import { zoneLabel } from "../text/zones";
import { areaText, extent, type LabelPlace, labelPlaces, shownAreas } from "./areas";
import { type Frame, placeFrames } from "./labels";
import type { LonLat } from "./localGrid";
import type { Layer, Scene } from "./scene";
import { isInSight, uncoveredOf } from "./uncovered";

/** Areas of the site narrower than this on the screen get no label. */
const LEAST_WIDTH_PX = 90;

/** What keeps vehicles out is named first, if there is no room for all. */
const RANKS: Readonly<Record<AreaView["kind"], number>> = {
  keep_out: 1,
  height: 2,
  boundary: 3,
  survey: 4,
};

interface WantedLabel {
  readonly key: string;
  readonly rank: number;
  readonly kind: string;
  readonly text: string;
  readonly places: readonly LabelPlace[];
  /** The western and eastern end of what must be wide enough; null: it is always named. */
  readonly ends: readonly [LonLat, LonLat] | null;
}

interface ShownLabel {
  readonly marker: Marker;
  readonly wanted: WantedLabel;
  width_px: number;
  height_px: number;
}

/**
 * The labels of the site's areas and of temporary zones, none over another. As HTML: the map style has no fonts.
 */
export class AreaLabelLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly shown = new Map<string, ShownLabel>();
  private wanted = "";

  add(map: MapLibre): void {
    this.map = map;
    map.on("move", () => this.arrange());
    map.on("resize", () => this.arrange());
  }

  update({ state, behindS }: Scene): void {
    const { map } = this;
    if (map === null) return;
    const labels = [
      ...state.temporary_zones.map((zone) => zoneLabelOf(zone, behindS)),
      ...shownAreas(state).map(areaLabelOf),
    ];
    // Sites rarely change, and states arrive ten times a second.
    const wanted = JSON.stringify(labels);
    if (wanted === this.wanted) return;
    this.wanted = wanted;
    for (const label of labels) this.show(map, label);
    const kept = new Set(labels.map(({ key }) => key));
    for (const [key, { marker }] of this.shown) {
      if (kept.has(key)) continue;
      marker.remove();
      this.shown.delete(key);
    }
    this.arrange();
  }

  /** A theme may have other letters. */
  recolour(): void {
    for (const label of this.shown.values()) measure(label);
    this.arrange();
  }

  /** Creates or changes a label and measures it. */
  private show(map: MapLibre, wanted: WantedLabel): void {
    const known = this.shown.get(wanted.key);
    const marker = known?.marker ?? new Marker({ element: document.createElement("span") });
    const element = marker.getElement();
    if (known === undefined) {
      marker.setLngLat(wanted.places[0] ?? [0, 0]).addTo(map);
      element.classList.add("area-label", `area-label-${wanted.kind}`, "is-crowded");
    }
    if (element.textContent !== wanted.text) element.textContent = wanted.text;
    this.shown.set(wanted.key, measure({ marker, wanted, width_px: 0, height_px: 0 }));
  }

  /** Gives each label a free place, in sight if there is one; a label without a free place is hidden. */
  private arrange(): void {
    const { map } = this;
    if (map === null) return;
    const uncovered = uncoveredOf(map.getContainer());
    const isCut = ([, frame]: readonly [LabelPlace, Frame]) => !isInSight(frame, uncovered);
    const labels = [...this.shown.values()]
      .filter(({ wanted }) => isWideEnough(map, wanted))
      .map((label) => ({
        key: label.wanted.key,
        rank: label.wanted.rank,
        // Rather cut by the window's edge than not there: what it names keeps vehicles out.
        places: label.wanted.places
          .map((place) => [place, frameAt(map, place, label)] as const)
          .sort((a, b) => Number(isCut(a)) - Number(isCut(b))),
      }));
    const places = placeFrames(labels);
    for (const [key, { marker, height_px }] of this.shown) {
      const place = places.get(key);
      marker.getElement().classList.toggle("is-crowded", place === undefined);
      if (place === undefined) continue;
      marker.setLngLat(place).setOffset([0, shiftOf(place, height_px)]);
    }
  }
}

function measure(label: ShownLabel): ShownLabel {
  const { offsetWidth: width_px, offsetHeight: height_px } = label.marker.getElement();
  return Object.assign(label, { width_px, height_px });
}

function areaLabelOf(area: AreaView, index: number): WantedLabel {
  const { west, east, north: lat } = extent(area);
  return {
    key: `${area.kind} ${index}`,
    rank: RANKS[area.kind],
    kind: area.kind,
    text: areaText(area),
    places: labelPlaces(area),
    ends: [
      { lon: west, lat },
      { lon: east, lat },
    ],
  };
}

/** Outside of the zone, which stays free. */
function zoneLabelOf(zone: TemporaryZoneView, behindS: number): WantedLabel {
  const lons = zone.ring.map(([lon]) => lon);
  const lats = zone.ring.map(([, lat]) => lat);
  const lon = (Math.min(...lons) + Math.max(...lons)) / 2;
  return {
    key: `zone ${zone.id}`,
    rank: 0,
    kind: "temporary",
    text: zoneLabel(zone, behindS),
    places: [
      { lon, lat: Math.min(...lats), side: "below" },
      { lon, lat: Math.max(...lats), side: "above" },
    ],
    ends: null,
  };
}

function isWideEnough(map: MapLibre, { ends }: WantedLabel): boolean {
  if (ends === null) return true;
  return map.project(ends[1]).x - map.project(ends[0]).x >= LEAST_WIDTH_PX;
}

function frameAt(map: MapLibre, place: LabelPlace, { width_px, height_px }: ShownLabel): Frame {
  const { x, y } = map.project(place);
  const middle = y + shiftOf(place, height_px);
  return {
    left: x - width_px / 2,
    right: x + width_px / 2,
    top: middle - height_px / 2,
    bottom: middle + height_px / 2,
  };
}

function shiftOf({ side }: LabelPlace, height_px: number): number {
  if (side === "over") return 0;
  return side === "above" ? -height_px / 2 : height_px / 2;
}
