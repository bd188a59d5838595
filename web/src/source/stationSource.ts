import type { Accessor } from "solid-js";
import type {
  AuthorityHolder,
  Order,
  OrderResult,
  PreflightView,
  StationState,
  SurveyRequest,
  SurveyResponse,
  SurveyWays,
  WordResponse,
} from "../protocol";
import type { Instant } from "./clock";

/** How the stream of states is doing. */
export type Connection =
  | { readonly kind: "connecting" }
  | { readonly kind: "live" }
  | { readonly kind: "lost"; readonly reason: string; readonly attempt: number };

/** What became of something the station was asked. A failure says what to do. */
export type Outcome<T> =
  | { readonly kind: "answered"; readonly value: T }
  | { readonly kind: "failed"; readonly problem: string };

/** A picture or file, and which frame it really is: the station gives its newest, not the one asked for. */
export interface Picture {
  readonly blob: Blob;
  readonly frameId: number | null;
}

/** An order and the vehicles it names. */
export interface NamedOrder {
  readonly serials: readonly string[];
  readonly order: Order;
}

/** A survey to plan; what is left out is as the station has it. */
export type NewSurvey = Pick<SurveyRequest, "height_above_takeoff_m" | "speed_mps"> &
  Partial<SurveyRequest>;

/** Where the screens get their states from and bring their orders to: live now, a recording later. */
export interface StationSource {
  /** The newest whole state; null before the first. */
  readonly state: Accessor<StationState | null>;
  readonly connection: Accessor<Connection>;
  /** Seconds to add at `now` to every age in `state`; null before the first state. */
  behindS(now: Instant): number | null;
  /** Gives an order. Never with takeoff: the console's buttons keep vehicles on the ground there. */
  order(order: NamedOrder): Promise<Outcome<readonly OrderResult[]>>;
  /** Makes every flying vehicle hold its position; motors stay on. */
  allStop(): Promise<Outcome<readonly OrderResult[]>>;
  /** What the gate would say to an order now; nothing is given. */
  check(order: NamedOrder): Promise<Outcome<readonly OrderResult[]>>;
  /** Calls vehicles home as landing missions at heights of their own; null: all that fly or may. */
  fleetReturn(serials: readonly string[] | null): Promise<Outcome<readonly OrderResult[]>>;
  takeAuthority(serial: string, holder: AuthorityHolder): Promise<Outcome<WordResponse>>;
  preflight(serial: string): Promise<Outcome<PreflightView>>;
  overridePreflight(serial: string, reason: string): Promise<Outcome<WordResponse>>;
  /** Says that somebody knows where a vehicle is that is not heard. */
  dismissHazard(name: string): Promise<Outcome<null>>;
  switchSeparationHold(isOn: boolean): Promise<Outcome<null>>;
  acknowledge(alarmId: number): Promise<Outcome<null>>;
  vehicleFrame(serial: string, frameId: number): Promise<Outcome<Picture>>;
  groundImage(frameId: number): Promise<Outcome<Picture>>;
  groundImageFile(): Promise<Outcome<Picture>>;
  /** Plans a survey; nothing flies by it. */
  askSurvey(survey: NewSurvey): Promise<Outcome<SurveyResponse>>;
  /** Flies a survey with these vehicles: they are given to the station's guidance by it. */
  startSurvey(
    id: number,
    serials: readonly string[],
    mayTakeOff: boolean,
  ): Promise<Outcome<SurveyResponse>>;
  stopSurvey(id: number, word: "pause" | "abort"): Promise<Outcome<SurveyResponse>>;
  surveyWays(id: number): Promise<Outcome<SurveyWays>>;
  surveyCells(id: number, number: number): Promise<Outcome<Picture>>;
  shadePicture(number: number): Promise<Outcome<Picture>>;
  forecastPicture(number: number, lead_s: number): Promise<Outcome<Picture>>;
  close(): void;
}
