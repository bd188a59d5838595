import type { Map as MapLibre } from "maplibre-gl";
import type { StationState, VehicleView } from "../protocol";
import type { ImportChoice } from "../site/siteDraft";
import type { DraftFeature } from "../site/siteFeatures";
import type { Colours } from "./colours";
import { type Box, boxAround, type LonLat } from "./localGrid";
import type { MissionShape } from "./missionDraftLayer";

/** One layer of the map. `add` is called once per layer, from bottom to top. */
export interface Layer {
  add(map: MapLibre, colours: Colours): void;
  update(scene: Scene): void;
  /** The theme changed. */
  recolour(colours: Colours): void;
}

/** Everything the map shows at one moment; passed to every layer. */
export interface Scene {
  readonly state: StationState;
  /** Seconds to add to the state's ages. */
  readonly behindS: number;
  readonly selected: readonly number[];
  /** The fly-here target that has not been confirmed yet. */
  readonly plannedTarget: PlannedTarget | null;
  /** The mission being drawn; null while none is. */
  readonly missionDraft: MissionShape | null;
  /** The temporary zone being drawn. */
  readonly zoneDraft: ZoneOutline | null;
  /** The site being edited; null while it is not. */
  readonly siteDraft: DraftShapes | null;
}

/** What is drawn of a site that is being edited. */
export interface DraftShapes {
  readonly features: readonly DraftFeature[];
  readonly imported: readonly ImportChoice[];
  readonly selectedId: number | null;
}

/** A zone being drawn: a centre with a radius, or the corners so far without one. */
export interface ZoneOutline {
  readonly points: readonly LonLat[];
  readonly radius_m: number | null;
}

/** An unconfirmed target with its label; `from` is null while the vehicle's position is unknown. */
export interface PlannedTarget {
  readonly from: LonLat | null;
  readonly at: LonLat;
  readonly text: string;
}

/** A vehicle's last known position; null when unknown. */
export function positionOf(vehicle: Pick<VehicleView, "position">): LonLat | null {
  const { longitude_deg: lon, latitude_deg: lat } = vehicle.position;
  return lon === null || lat === null ? null : { lon, lat };
}

/** Smallest extent of a view, so that a single vehicle is shown with its surroundings. */
const LEAST_VIEW_M = 120;

/** Kinds of areas where the site's work is; zones to keep out of may be far away. */
const PLACES_OF_WORK = ["boundary", "survey"];

/** Extent of the first view: the site's boundary and survey regions, vehicles, ground image, temporary zones and a site being edited; around its origin if there is nothing else, null without any position. */
export function wholeView(state: StationState, draft: DraftShapes | null = null): Box | null {
  const vehicles = state.vehicles.flatMap((vehicle) => positionOf(vehicle) ?? []);
  const areas = state.site?.areas ?? [];
  const drawn = [
    ...areas.filter(({ kind }) => PLACES_OF_WORK.includes(kind)).flatMap(({ rings }) => rings),
    state.ground_image?.corners ?? [],
    ...state.temporary_zones.map(({ ring }) => ring),
  ];
  const corners = drawn.flatMap((ring) => ring.map(([lon, lat]) => ({ lon, lat })));
  const drafted = [...(draft?.features ?? []), ...(draft?.imported ?? [])];
  const inDraft = drafted.flatMap(({ rings }) => rings.flat());
  return boxAround([...vehicles, ...corners, ...inDraft], LEAST_VIEW_M) ?? aroundOrigin(state);
}

function aroundOrigin(state: StationState): Box | null {
  const { longitude_deg: lon, latitude_deg: lat } = state.site ?? {};
  if (typeof lon !== "number" || typeof lat !== "number") return null;
  return boxAround([{ lon, lat }], LEAST_VIEW_M * 2);
}

/** Origin of the grid: the site's origin, else the position of the first vehicle. */
export function gridOrigin(state: StationState): LonLat | null {
  const { longitude_deg: lon, latitude_deg: lat } = state.site ?? {};
  if (typeof lon === "number" && typeof lat === "number") return { lon, lat };
  return state.vehicles.flatMap((vehicle) => positionOf(vehicle) ?? [])[0] ?? null;
}
