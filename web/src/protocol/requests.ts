import type { Order, SurveyRequest, TemporaryZoneRequest } from ".";
import type { operations } from "./schema";

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
  /** Allows vehicles on the ground to take off with it; left out: they stay there. */
  readonly takeoff?: true;
}

/** A temporary zone to draw; omitted fields use the station's defaults. */
export type NewZone = Pick<TemporaryZoneRequest, "kind" | "reason"> & Partial<TemporaryZoneRequest>;

/** A survey to plan; omitted fields use the station's defaults. */
export type NewSurvey = Pick<SurveyRequest, "speed_mps"> &
  Partial<Omit<SurveyRequest, "camera">> & { camera?: Partial<SurveyRequest["camera"]> };

/** A file that the station makes of a flight record. */
export type FlightFile =
  operations["file_api_flights__name__files__file__get"]["parameters"]["path"]["file"];

/** A file that the job on photos has made. */
export type PhotoFile =
  operations["file_api_photos_files__file__get"]["parameters"]["path"]["file"];

type TimelineQuery = NonNullable<operations["timeline_api_timeline_get"]["parameters"]["query"]>;

export type TimelineSubject = NonNullable<TimelineQuery["about"]>;

/** Which lines of the timeline; null means all vehicles, all subjects, the newest. */
export interface TimelineFilter {
  readonly serial: string | null;
  readonly about: TimelineSubject | null;
  /** The number of the entry before which the lines are wanted. */
  readonly before: number | null;
}
