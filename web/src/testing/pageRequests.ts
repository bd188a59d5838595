import type {
  ActionResponse,
  AuthorityHolder,
  FlightFile,
  NewSurvey,
  NewZone,
  Outcome,
  PhotoFile,
  PhotoRequest,
  ReplayTransport,
  SurveyAgainRequest,
} from "../protocol";
import type { NamedAircraft } from "../source/surveyRequests";

/** A request other than a vehicle order. */
export type PageRequest =
  | { readonly authority: AuthorityHolder; readonly serial: string; readonly takeOver?: boolean }
  | { readonly override: string; readonly serial: string }
  | { readonly clearedHazard: string }
  | { readonly separationHold: boolean }
  | { readonly drawnZone: NewZone }
  | { readonly endedZone: number }
  | { readonly releasedStop: readonly string[] | null }
  | {
      readonly admittedLink: number;
      readonly serial: string;
      readonly lasting: "always" | "session";
    }
  | { readonly refusedLink: number }
  | { readonly fleetReturn: readonly string[] | null }
  | { readonly sideStep: string }
  | { readonly relieved: string; readonly spare: string; readonly takeoff: boolean }
  | { readonly plannedSurvey: NewSurvey }
  | { readonly surveyAgain: SurveyAgainRequest }
  | {
      readonly startedSurvey: number;
      readonly serials: readonly string[];
      readonly takeoff: boolean;
    }
  | {
      readonly savedPlan: number;
      readonly kind: string;
      readonly serials: readonly string[];
      readonly model: NamedAircraft | null;
    }
  | { readonly stoppedSurvey: number; readonly word: "pause" | "abort" }
  | { readonly transport: ReplayTransport }
  | { readonly startedPhotos: PhotoRequest }
  | { readonly cancelled: "photos" }
  | { readonly photoFile: PhotoFile }
  | { readonly flight: string; readonly file?: FlightFile | "record.mcap" };

/** The requests of a page other than orders, and the answer to those that the station may refuse. */
export class PageRequests {
  readonly sent: PageRequest[] = [];
  response: ActionResponse = { accepted: true, rule: null, reason: null };

  /** Keeps a request; the answer is `response`, with what else its kind of answer has. */
  async answer<T extends object = object>(
    request: PageRequest,
    more?: T,
  ): Promise<Outcome<ActionResponse & T>> {
    this.sent.push(request);
    return answered({ ...this.response, ...(more as T) });
  }
}

export function answered<T>(value: T): Outcome<T> {
  return { kind: "answered", value };
}

export function failed(problem: string): Outcome<never> {
  return { kind: "failed", problem };
}

export const noPicture = async () => failed("no picture in this test");
