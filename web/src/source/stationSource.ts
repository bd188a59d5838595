import type { Accessor } from "solid-js";
import type {
  AccessView,
  ActionResponse,
  AuthorityHolder,
  Order,
  OrderResult,
  PreflightView,
  StationState,
  SunAtView,
  TemporaryZoneRequest,
  TemporaryZoneResponse,
  TimelineView,
  UpwindView,
} from "../protocol";
import type { Instant } from "./clock";
import type { FlightRequests } from "./flightRequests";
import type { MapRequests } from "./mapRequests";
import type { ReplayRequests } from "./replayRequests";
import type { SiteRequests } from "./siteRequests";
import type { SurveyRequests } from "./surveyRequests";

/** State of the connection to the station; `reason` is a clause without a full stop. */
export type Connection =
  | { readonly kind: "connecting" }
  | { readonly kind: "live" }
  | {
      readonly kind: "lost";
      readonly reason: string;
      readonly attempt: number;
      /** The station wants a token; nothing is tried again until the user has logged in. */
      readonly needsLogin?: boolean;
    };

/** The result of a request. `problem` is a sentence for the operator that states what to do. */
export type Outcome<T> =
  | { readonly kind: "answered"; readonly value: T }
  | { readonly kind: "failed"; readonly problem: string };

/** A picture or file with its actual frame number: the station returns its newest, not the one requested. */
export interface Picture {
  readonly blob: Blob;
  readonly frameId: number | null;
}

/** An order and the vehicles it is for. */
export interface NamedOrder {
  readonly serials: readonly string[];
  readonly order: Order;
}

/** A temporary zone to draw; omitted fields use the station's defaults. */
export type NewZone = Pick<TemporaryZoneRequest, "kind" | "reason"> & Partial<TemporaryZoneRequest>;

export type TimelineSubject = "orders" | "alarms" | "flights" | "operations" | "station";

/** Which lines of the timeline; null means all vehicles, all subjects, the newest. */
export interface TimelineFilter {
  readonly serial: string | null;
  readonly about: TimelineSubject | null;
  /** The number of the entry before which the lines are wanted. */
  readonly before: number | null;
}

/** Where the page gets states from and sends orders to: a running station or a recording. */
export interface StationSource {
  /** The newest complete state; null before the first. */
  readonly state: Accessor<StationState | null>;
  readonly connection: Accessor<Connection>;
  /** The person of this page's requests; null until the station has stated it. */
  readonly person: Accessor<AccessView | null>;
  readonly site: SiteRequests;
  readonly flights: FlightRequests;
  readonly maps: MapRequests;
  readonly surveys: SurveyRequests;
  /** Moves a replay; a live station refuses it. */
  readonly replay: ReplayRequests;
  /** The address for other computers as a QR code. */
  sharedAddressCode(): Promise<Outcome<Picture>>;
  /** The address for companion apps as a QR code. */
  appAddressCode(): Promise<Outcome<Picture>>;
  /** Seconds to add at `now` to every age in `state`; null before the first state. */
  behindS(now: Instant): number | null;
  /** Sends an order, always without takeoff. */
  order(order: NamedOrder): Promise<Outcome<readonly OrderResult[]>>;
  /** Makes every flying vehicle hold position, and latches all; motors stay on. */
  allStop(): Promise<Outcome<readonly OrderResult[]>>;
  /** Draws a temporary zone, which acts at once. */
  drawZone(zone: NewZone): Promise<Outcome<TemporaryZoneResponse>>;
  endZone(id: number): Promise<Outcome<ActionResponse>>;
  /** Releases vehicles from the all stop in force; null means all, also those that connect later. */
  releaseStop(serials: readonly string[] | null): Promise<Outcome<ActionResponse>>;
  /** Admits the app that waits on a link as this vehicle, on the list or until the station stops. */
  admitApp(
    linkId: number,
    serial: string,
    lasting: "always" | "session",
  ): Promise<Outcome<ActionResponse>>;
  /** Closes the app that waits on a link, and again for some minutes. */
  refuseApp(linkId: number): Promise<Outcome<ActionResponse>>;
  /** Checks an order with the safety gate without sending it. */
  check(order: NamedOrder): Promise<Outcome<readonly OrderResult[]>>;
  /** Returns vehicles home with landing missions at separate heights; null means all in reach. */
  fleetReturn(serials: readonly string[] | null): Promise<Outcome<readonly OrderResult[]>>;
  /** Has the imaging drone fly 25 m aside and back. */
  lookAside(serial: string): Promise<Outcome<ActionResponse>>;
  /** Has an imaging drone take the place of another; of the same serial: return to its own. */
  relieve(serial: string, spare: string, takeoff: boolean): Promise<Outcome<ActionResponse>>;
  /** `takeOver`: also from another person who operates the vehicle. */
  setAuthority(
    serial: string,
    holder: AuthorityHolder,
    takeOver?: boolean,
  ): Promise<Outcome<ActionResponse>>;
  preflight(serial: string): Promise<Outcome<PreflightView>>;
  overridePreflight(serial: string, reason: string): Promise<Outcome<ActionResponse>>;
  /** Clears a lost vehicle's hazard area. */
  dismissHazard(name: string): Promise<Outcome<null>>;
  setSeparationHold(isOn: boolean): Promise<Outcome<null>>;
  acknowledge(alarmId: number): Promise<Outcome<null>>;
  vehicleFrame(serial: string, frameId: number): Promise<Outcome<Picture>>;
  groundImage(frameId: number): Promise<Outcome<Picture>>;
  groundImageFile(): Promise<Outcome<Picture>>;
  shadePicture(number: number): Promise<Outcome<Picture>>;
  forecastPicture(number: number, lead_s: number): Promise<Outcome<Picture>>;
  /** The light at a place, and when it changes next. */
  sunAt(latitudeDeg: number, longitudeDeg: number): Promise<Outcome<SunAtView>>;
  /** Where an imaging drone sees most of the shade that comes over the region. */
  upwindPlace(serial: string): Promise<Outcome<UpwindView>>;
  /** What happened in this run, the newest first. */
  timeline(filter: TimelineFilter, atMost: number): Promise<Outcome<TimelineView>>;
  close(): void;
}
