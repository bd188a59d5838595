import type { Accessor } from "solid-js";
import type {
  AccessView,
  ActionResponse,
  AuthorityHolder,
  FlightFiguresView,
  FlightView,
  ImportedView,
  Order,
  OrderResult,
  PreflightView,
  SiteDrawingRequest,
  SiteDrawingResponse,
  SiteDrawingView,
  StationState,
  SunAtView,
  SurveyCameraView,
  SurveyEstimateView,
  SurveyRequest,
  SurveyResponse,
  SurveyWays,
  TemporaryZoneRequest,
  TemporaryZoneResponse,
  TimelineView,
  UpwindView,
} from "../protocol";
import type { Instant } from "./clock";

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

/** A survey to plan; omitted fields use the station's defaults. */
export type NewSurvey = Pick<SurveyRequest, "height_above_takeoff_m" | "speed_mps"> &
  Partial<Omit<SurveyRequest, "camera">> & { camera?: Partial<SurveyRequest["camera"]> };

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
/** A file that the station makes of a flight record. */
export type FlightFile =
  | "tracks.gpx"
  | "tracks.geojson"
  | "tracks.csv"
  | "surveys.kml"
  | "sun.tif"
  | "coverage.png"
  | "report.html";

/** Where the page gets states from and sends orders to: a running station or a recording. */
export interface StationSource {
  /** The newest complete state; null before the first. */
  readonly state: Accessor<StationState | null>;
  readonly connection: Accessor<Connection>;
  /** The person of this page's requests; null until the station has stated it. */
  readonly person: Accessor<AccessView | null>;
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
  /** Plans a survey; nothing moves. */
  planSurvey(survey: NewSurvey): Promise<Outcome<SurveyResponse>>;
  /** Starts a survey with these vehicles and gives guidance control of them. */
  startSurvey(
    id: number,
    serials: readonly string[],
    allowTakeoff: boolean,
  ): Promise<Outcome<SurveyResponse>>;
  stopSurvey(id: number, word: "pause" | "abort"): Promise<Outcome<SurveyResponse>>;
  /** What a planned survey will take with these vehicles; without any, with one drone. */
  surveyEstimate(id: number, serials: readonly string[]): Promise<Outcome<SurveyEstimateView>>;
  /** The survey cameras that a plan may name. */
  cameras(): Promise<Outcome<readonly SurveyCameraView[]>>;
  surveyWays(id: number): Promise<Outcome<SurveyWays>>;
  surveyCells(id: number, number: number): Promise<Outcome<Picture>>;
  shadePicture(number: number): Promise<Outcome<Picture>>;
  forecastPicture(number: number, lead_s: number): Promise<Outcome<Picture>>;
  /** The light at a place, and when it changes next. */
  sunAt(latitudeDeg: number, longitudeDeg: number): Promise<Outcome<SunAtView>>;
  /** Where an imaging drone sees most of the shade that comes over the region. */
  upwindPlace(serial: string): Promise<Outcome<UpwindView>>;
  /** What happened in this run, the newest first. */
  timeline(filter: TimelineFilter, atMost: number): Promise<Outcome<TimelineView>>;
  /** The site's layers with all corners, as they are in its folder. */
  siteDrawing(): Promise<Outcome<SiteDrawingView>>;
  /** Checks a drawing as the station would at its start; nothing is saved. */
  checkSite(drawing: SiteDrawingRequest): Promise<Outcome<SiteDrawingResponse>>;
  /** Saves a drawing in the site's folder and brings it into force. */
  saveSite(drawing: SiteDrawingRequest): Promise<Outcome<SiteDrawingResponse>>;
  /** Takes back the newest save. */
  undoSite(revision: string): Promise<Outcome<SiteDrawingResponse>>;
  /** Reads the polygons and points of a file of another program; nothing is saved. */
  importSite(file: File): Promise<Outcome<ImportedView>>;
  /** The flight records in the station's folder, the newest first. */
  flights(): Promise<Outcome<readonly FlightView[]>>;
  /** Takes seconds: the station reads the record. */
  flightFigures(name: string): Promise<Outcome<FlightFiguresView>>;
  flightFile(name: string, file: FlightFile): Promise<Outcome<Picture>>;
  flightRecord(name: string): Promise<Outcome<Picture>>;
  close(): void;
}
