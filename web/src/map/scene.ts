import type { Map as MapLibre } from "maplibre-gl";
import type { StationState, VehicleView } from "../protocol";
import type { Colours } from "./colours";
import { type Box, boxAround, type LonLat } from "./localGrid";

/** One thing drawn on the map. `add` is called once, in the order things lie on each other. */
export interface Layer {
  add(map: MapLibre, colours: Colours): void;
  update(scene: Scene): void;
  /** The theme changed. */
  recolour(colours: Colours): void;
}

/** What the map shows at one moment. Layers take it whole. */
export interface Scene {
  readonly state: StationState;
  /** Seconds to add to the state's ages. */
  readonly behindS: number;
  readonly selected: readonly number[];
  /** Where a vehicle would fly that nobody has confirmed yet. */
  readonly meant: Meant | null;
}

/** A place that is meant, with its words; `from` is null while the vehicle's own place is not known. */
export interface Meant {
  readonly from: LonLat | null;
  readonly at: LonLat;
  readonly text: string;
}

/** Where a vehicle was last seen; null when that is unknown. */
export function positionOf(vehicle: Pick<VehicleView, "position">): LonLat | null {
  const { longitude_deg: lon, latitude_deg: lat } = vehicle.position;
  return lon === null || lat === null ? null : { lon, lat };
}

/** A view is never closer than this, so that a lone vehicle has its surroundings. */
const LEAST_VIEW_M = 120;

/** What the first view shows: every vehicle and the ground image, else the site's areas, else its place; null when nothing is placed. */
export function wholeView(state: StationState): Box | null {
  const vehicles = state.vehicles.flatMap((vehicle) => positionOf(vehicle) ?? []);
  const corners = (state.ground_image?.corners ?? []).map(([lon, lat]) => ({ lon, lat }));
  return boxAround([...vehicles, ...corners], LEAST_VIEW_M) ?? siteView(state);
}

function siteView(state: StationState): Box | null {
  const drawn = (state.site?.areas ?? []).flatMap((area) => area.rings.flat());
  const around = boxAround(
    drawn.map(([lon, lat]) => ({ lon, lat })),
    LEAST_VIEW_M,
  );
  if (around !== null) return around;
  const { longitude_deg: lon, latitude_deg: lat } = state.site ?? {};
  if (lon === null || lon === undefined || lat === null || lat === undefined) return null;
  return boxAround([{ lon, lat }], LEAST_VIEW_M * 2);
}

/** What the grid counts from: the site's origin, else the first vehicle that is placed. */
export function gridOrigin(state: StationState): LonLat | null {
  const { longitude_deg: lon, latitude_deg: lat } = state.site ?? {};
  if (typeof lon === "number" && typeof lat === "number") return { lon, lat };
  return state.vehicles.flatMap((vehicle) => positionOf(vehicle) ?? [])[0] ?? null;
}
