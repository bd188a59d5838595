import type { Accessor } from "solid-js";
import type { AccessView, Connection, StationState } from "../protocol";
import type { Instant } from "./clock";
import type { FlightRequests } from "./flightRequests";
import type { LightRequests } from "./lightRequests";
import type { MapRequests } from "./mapRequests";
import type { OrderRequests } from "./orderRequests";
import type { PhotoRequests } from "./photoRequests";
import type { ReplayRequests } from "./replayRequests";
import type { SiteRequests } from "./siteRequests";
import type { StationRequests } from "./stationRequests";
import type { SurveyRequests } from "./surveyRequests";
import type { VehicleRequests } from "./vehicleRequests";

/** Where the page gets states from and sends orders to: a running station or a recording. */
export interface StationSource {
  /** The newest complete state; null before the first. */
  readonly state: Accessor<StationState | null>;
  readonly connection: Accessor<Connection>;
  /** The person of this page's requests; null until the station has stated it. */
  readonly person: Accessor<AccessView | null>;
  readonly orders: OrderRequests;
  readonly vehicles: VehicleRequests;
  readonly surveys: SurveyRequests;
  readonly light: LightRequests;
  readonly site: SiteRequests;
  readonly maps: MapRequests;
  readonly flights: FlightRequests;
  readonly photos: PhotoRequests;
  /** Moves a replay; a live station refuses it. */
  readonly replay: ReplayRequests;
  readonly station: StationRequests;
  /** Seconds to add at `now` to every age in `state`; null before the first state. */
  behindS(now: Instant): number | null;
  close(): void;
}
