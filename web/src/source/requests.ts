import createClient from "openapi-fetch";
import type {
  AuthorityHolder,
  OrderResult,
  PreflightView,
  SurveyRequest,
  SurveyResponse,
  SurveyWays,
  WordResponse,
} from "../protocol";
import type { paths } from "../protocol/schema";
import type { NamedOrder, NewSurvey, Outcome, Picture } from "./stationSource";

/** A request older than this is given up: an order must not arrive when nobody thinks of it any more. */
export const REQUEST_MS = 3_000;

/** Rows are worked out behind the pictures that the station reads just then; nothing flies by it. */
const PLANNED_MS = 12_000;

/** What the page asks of the station over HTTP. Failures are values with a sentence for the operator. */
export class Requests {
  private readonly client;
  private readonly headers: Record<string, string>;

  constructor(
    private readonly origin: string,
    token: string | null,
    private readonly fetch: (request: Request) => Promise<Response>,
  ) {
    this.headers = token === null ? {} : { Authorization: `Bearer ${token}` };
    this.client = createClient<paths>({ baseUrl: origin, headers: this.headers, fetch });
  }

  /** `owner` names the stream whose end ends a steered order; left out of all others. */
  order(named: NamedOrder, owner: string): Promise<Outcome<readonly OrderResult[]>> {
    const body = orderBody(named, owner);
    return answered(
      () => this.client.POST("/api/orders", { body, signal: soon() }),
      (data) => data.results,
    );
  }

  check(named: NamedOrder, owner: string): Promise<Outcome<readonly OrderResult[]>> {
    const body = orderBody(named, owner);
    return answered(
      () => this.client.POST("/api/orders/check", { body, signal: soon() }),
      (data) => data.results,
    );
  }

  fleetReturn(named: readonly string[] | null): Promise<Outcome<readonly OrderResult[]>> {
    const body = { serials: named === null ? null : [...named] };
    return answered(
      () => this.client.POST("/api/fleet-return", { body, signal: soon() }),
      (data) => data.results,
    );
  }

  takeAuthority(serial: string, holder: AuthorityHolder): Promise<Outcome<WordResponse>> {
    const options = { params: { path: { serial } }, body: { holder }, signal: soon() };
    return answered(() => this.client.POST("/api/vehicles/{serial}/authority", options), same);
  }

  preflight(serial: string): Promise<Outcome<PreflightView>> {
    const options = { params: { path: { serial } }, signal: soon() };
    return answered(() => this.client.GET("/api/vehicles/{serial}/preflight", options), same);
  }

  overridePreflight(serial: string, reason: string): Promise<Outcome<WordResponse>> {
    const options = { params: { path: { serial } }, body: { reason }, signal: soon() };
    return answered(
      () => this.client.POST("/api/vehicles/{serial}/preflight/override", options),
      same,
    );
  }

  askSurvey(survey: NewSurvey): Promise<Outcome<SurveyResponse>> {
    // What is left out has its default at the station; the generated type cannot say so.
    const options = { body: survey as SurveyRequest, signal: AbortSignal.timeout(PLANNED_MS) };
    return answered(() => this.client.POST("/api/surveys", options), asSurvey);
  }

  startSurvey(
    survey_id: number,
    serials: readonly string[],
    takeoff: boolean,
  ): Promise<Outcome<SurveyResponse>> {
    const body = { serials: [...serials], takeoff };
    const options = { params: { path: { survey_id } }, body, signal: soon() };
    return answered(() => this.client.POST("/api/surveys/{survey_id}/start", options), asSurvey);
  }

  stopSurvey(survey_id: number, word: "pause" | "abort"): Promise<Outcome<SurveyResponse>> {
    const options = { params: { path: { survey_id, word } }, signal: soon() };
    return answered(() => this.client.POST("/api/surveys/{survey_id}/{word}", options), asSurvey);
  }

  surveyWays(survey_id: number): Promise<Outcome<SurveyWays>> {
    const options = { params: { path: { survey_id } }, signal: soon() };
    return answered(
      () => this.client.GET("/api/surveys/{survey_id}/ways", options),
      (data) => data as SurveyWays,
    );
  }

  dismissHazard(serial: string): Promise<Outcome<null>> {
    const options = { params: { path: { serial } }, signal: soon() };
    return taken(() => this.client.POST("/api/vehicles/{serial}/hazard/dismiss", options));
  }

  switchSeparationHold(isOn: boolean): Promise<Outcome<null>> {
    const path: { switch: "on" | "off" } = { switch: isOn ? "on" : "off" };
    const options = { params: { path }, signal: soon() };
    return taken(() => this.client.POST("/api/separation-hold/{switch}", options));
  }

  allStop(): Promise<Outcome<readonly OrderResult[]>> {
    return answered(
      () => this.client.POST("/api/all-stop", { signal: soon() }),
      (data) => data.results,
    );
  }

  acknowledge(alarm_id: number): Promise<Outcome<null>> {
    const options = { params: { path: { alarm_id } }, signal: soon() };
    return taken(() => this.client.POST("/api/alarms/{alarm_id}/acknowledge", options));
  }

  /** Why the station turns this page away, when it answers at all; a browser does not tell for a stream. */
  async whyRefused(): Promise<string | null> {
    const asked = await attempt(async () => {
      const answer = await this.client.GET("/api/state", { signal: soon() });
      return done(answer.response.ok ? null : refusal(answer.response, answer.error));
    });
    return asked.kind === "answered" ? asked.value : null;
  }

  /** Fetches a picture or file; always with the token's header, which an `<img>` could not send. */
  async picture(path: string): Promise<Outcome<Picture>> {
    return attempt(async () => {
      const request = new Request(this.origin + path, {
        headers: this.headers,
        signal: AbortSignal.timeout(4 * REQUEST_MS),
      });
      const response = await this.fetch(request);
      if (!response.ok) return failed(refusal(response, null));
      return done({ blob: await response.blob(), frameId: frameIdOf(response) });
    });
  }
}

function frameIdOf(response: Response): number | null {
  const text = response.headers.get("X-Frame-Id");
  return text !== null && /^\d+$/.test(text) ? Number(text) : null;
}

/** Orders that the station steers by sticks for as long as the page's stream lasts. */
const STEERED: readonly string[] = ["goto", "nudge", "hold_position"];

function orderBody({ serials, order }: NamedOrder, owner: string) {
  const body = { serials: [...serials], order, takeoff: false };
  return STEERED.includes(order.kind) ? { ...body, owner } : body;
}

function soon(): AbortSignal {
  return AbortSignal.timeout(REQUEST_MS);
}

/** The request library widens pairs to lists; the station's are pairs. */
function asSurvey(data: unknown): SurveyResponse {
  return data as SurveyResponse;
}

function same<T>(value: T): T {
  return value;
}

interface Answer<D> {
  readonly data?: D;
  readonly error?: unknown;
  readonly response: Response;
}

function answered<D, T>(ask: () => Promise<Answer<D>>, read: (data: D) => T): Promise<Outcome<T>> {
  return attempt(async () => {
    const { data, error, response } = await ask();
    return data === undefined ? failed(refusal(response, error)) : done(read(data));
  });
}

/** For what is answered with nothing but that it was taken. */
function taken(ask: () => Promise<Answer<unknown>>): Promise<Outcome<null>> {
  return attempt(async () => {
    const { error, response } = await ask();
    return response.ok ? done(null) : failed(refusal(response, error));
  });
}

async function attempt<T>(ask: () => Promise<Outcome<T>>): Promise<Outcome<T>> {
  try {
    return await ask();
  } catch (error) {
    return failed(unreached(error));
  }
}

function done<T>(value: T): Outcome<T> {
  return { kind: "answered", value };
}

function failed<T>(problem: string): Outcome<T> {
  return { kind: "failed", problem };
}

function unreached(error: unknown): string {
  const isLate = error instanceof DOMException && error.name === "TimeoutError";
  if (isLate) {
    return `The station did not answer within ${REQUEST_MS / 1000} s. It may still have heard: look at the commands.`;
  }
  return "The station cannot be reached. Use the remote controllers.";
}

const UNAUTHORISED = 401;

function refusal(response: Response, body: unknown): string {
  if (response.status === UNAUTHORISED) {
    return "The station refuses this page. Open it with its token.";
  }
  const said =
    typeof body === "object" && body !== null ? (body as { error?: unknown }).error : null;
  if (typeof said === "string") return said;
  return `The station answered ${response.status} ${response.statusText}`.trim();
}
