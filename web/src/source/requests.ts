import createClient from "openapi-fetch";
import type {
  AccessView,
  ActionResponse,
  AuthorityHolder,
  FlightFiguresView,
  FlightView,
  ImportedView,
  OrderResult,
  PreflightView,
  SiteDrawingRequest,
  SiteDrawingResponse,
  SiteDrawingView,
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
import type { paths } from "../protocol/schema";
import type {
  NamedOrder,
  NewSurvey,
  NewZone,
  Outcome,
  Picture,
  TimelineFilter,
} from "./stationSource";

/** Request timeout: an order must not arrive long after the operator sent it. */
export const REQUEST_MS = 3_000;

/** Timeout for planning a survey: it waits for image processing and moves nothing. */
const PLANNING_MS = 12_000;

/** Timeout for reading and writing the site's files, and for reading an imported one, ms. */
const SITE_MS = 25_000;
const SITE_LATE =
  "The station did not answer within 25 s. Load the site again to see whether it was saved.";
/** Timeout for a file made of a flight record: a long one takes minutes, and nothing waits for it. */
const RECORD_MS = 600_000;

/** HTTP requests to the station. Failures are values with a sentence for the operator. */
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

  /**
   * `owner` is the stream a steered order depends on; other orders carry none. `givenAtMs` is when the
   * order was given, in the station's time: an order to move that arrives long after is refused.
   */
  order(
    named: NamedOrder,
    owner: string,
    givenAtMs: number | null,
  ): Promise<Outcome<readonly OrderResult[]>> {
    const body = orderBody(named, owner, givenAtMs);
    return answered(
      () => this.client.POST("/api/orders", { body, signal: timeout() }),
      (data) => data.results,
    );
  }

  check(
    named: NamedOrder,
    owner: string,
    givenAtMs: number | null,
  ): Promise<Outcome<readonly OrderResult[]>> {
    const body = orderBody(named, owner, givenAtMs);
    return answered(
      () => this.client.POST("/api/orders/check", { body, signal: timeout() }),
      (data) => data.results,
    );
  }

  fleetReturn(
    named: readonly string[] | null,
    given_at_unix_ms: number | null,
  ): Promise<Outcome<readonly OrderResult[]>> {
    const body = { serials: named === null ? null : [...named], given_at_unix_ms };
    return answered(
      () => this.client.POST("/api/fleet-return", { body, signal: timeout() }),
      (data) => data.results,
    );
  }

  lookAside(serial: string, given_at_unix_ms: number | null): Promise<Outcome<ActionResponse>> {
    const body = { serial, given_at_unix_ms };
    return answered(
      () => this.client.POST("/api/look-aside", { body, signal: timeout() }),
      identity,
    );
  }

  /** `take_over`: also from another person who operates the vehicle. */
  setAuthority(
    serial: string,
    holder: AuthorityHolder,
    take_over: boolean,
  ): Promise<Outcome<ActionResponse>> {
    const body = { holder, take_over };
    const options = { params: { query: { serial } }, body, signal: timeout() };
    return answered(() => this.client.POST("/api/vehicle/authority", options), identity);
  }

  preflight(serial: string): Promise<Outcome<PreflightView>> {
    const options = { params: { query: { serial } }, signal: timeout() };
    return answered(() => this.client.GET("/api/vehicle/preflight", options), identity);
  }

  overridePreflight(serial: string, reason: string): Promise<Outcome<ActionResponse>> {
    const options = { params: { query: { serial } }, body: { reason }, signal: timeout() };
    return answered(() => this.client.POST("/api/vehicle/preflight/override", options), identity);
  }

  planSurvey(survey: NewSurvey): Promise<Outcome<SurveyResponse>> {
    // Omitted fields have defaults at the station; the generated type cannot express that.
    const options = { body: survey as SurveyRequest, signal: AbortSignal.timeout(PLANNING_MS) };
    return answered(() => this.client.POST("/api/surveys", options), asSurveyResponse);
  }

  startSurvey(
    survey_id: number,
    serials: readonly string[],
    takeoff: boolean,
    given_at_unix_ms: number | null,
  ): Promise<Outcome<SurveyResponse>> {
    const body = { serials: [...serials], takeoff, given_at_unix_ms };
    const options = { params: { path: { survey_id } }, body, signal: timeout() };
    return answered(
      () => this.client.POST("/api/surveys/{survey_id}/start", options),
      asSurveyResponse,
    );
  }

  stopSurvey(survey_id: number, word: "pause" | "abort"): Promise<Outcome<SurveyResponse>> {
    const options = { params: { path: { survey_id, command: word } }, signal: timeout() };
    return answered(
      () => this.client.POST("/api/surveys/{survey_id}/{command}", options),
      asSurveyResponse,
    );
  }

  surveyEstimate(
    survey_id: number,
    serials: readonly string[],
  ): Promise<Outcome<SurveyEstimateView>> {
    const params = { path: { survey_id }, query: { serial: [...serials] } };
    const options = { params, signal: timeout() };
    return answered(() => this.client.GET("/api/surveys/{survey_id}/estimate", options), identity);
  }

  cameras(): Promise<Outcome<readonly SurveyCameraView[]>> {
    return answered(() => this.client.GET("/api/cameras", { signal: timeout() }), identity);
  }

  surveyWays(survey_id: number): Promise<Outcome<SurveyWays>> {
    const options = { params: { path: { survey_id } }, signal: timeout() };
    return answered(
      () => this.client.GET("/api/surveys/{survey_id}/ways", options),
      (data) => data as SurveyWays,
    );
  }

  sunAt(latitude_deg: number, longitude_deg: number): Promise<Outcome<SunAtView>> {
    const options = { params: { query: { latitude_deg, longitude_deg } }, signal: timeout() };
    return answered(() => this.client.GET("/api/sun-at", options), identity);
  }

  upwindPlace(serial: string): Promise<Outcome<UpwindView>> {
    const options = { params: { query: { serial } }, signal: timeout() };
    return answered(() => this.client.GET("/api/upwind-place", options), identity);
  }

  dismissHazard(serial: string): Promise<Outcome<null>> {
    const options = { params: { query: { serial } }, signal: timeout() };
    return withoutBody(() => this.client.POST("/api/vehicle/hazard/dismiss", options));
  }

  setSeparationHold(isOn: boolean): Promise<Outcome<null>> {
    const path: { switch: "on" | "off" } = { switch: isOn ? "on" : "off" };
    const options = { params: { path }, signal: timeout() };
    return withoutBody(() => this.client.POST("/api/separation-hold/{switch}", options));
  }

  allStop(): Promise<Outcome<readonly OrderResult[]>> {
    return answered(
      () => this.client.POST("/api/all-stop", { signal: timeout() }),
      (data) => data.results,
    );
  }

  /** An all stop at the station's guard: no order of the station, so results have no number. */
  allStopAtGuard(url: string, by: string | null): Promise<Outcome<readonly OrderResult[]>> {
    return attempt(async () => {
      const body = JSON.stringify(by === null ? {} : { by });
      const response = await this.fetch(
        new Request(url, { method: "POST", body, signal: timeout() }),
      );
      if (!response.ok) return failed(`The guard refused: ${response.status}`);
      const { held, missed } = (await response.json()) as { held: string[]; missed: string[] };
      const reason = "nothing recent shows it in flight; use its controller";
      return done([
        ...held.map((name) => guardResult(name, null)),
        ...missed.map((name) => guardResult(name, reason)),
      ]);
    });
  }

  drawZone(zone: NewZone): Promise<Outcome<TemporaryZoneResponse>> {
    const options = { body: zone as TemporaryZoneRequest, signal: timeout() };
    return answered(() => this.client.POST("/api/zones", options), asZoneResponse);
  }

  endZone(zone_id: number): Promise<Outcome<ActionResponse>> {
    const options = { params: { path: { zone_id } }, signal: timeout() };
    return answered(() => this.client.POST("/api/zones/{zone_id}/end", options), identity);
  }

  timeline(filter: TimelineFilter, at_most: number): Promise<Outcome<TimelineView>> {
    const given = Object.entries(filter).filter(([, value]) => value !== null);
    const query = { ...(Object.fromEntries(given) as Partial<TimelineQuery>), at_most };
    const options = { params: { query }, signal: timeout() };
    return answered(() => this.client.GET("/api/timeline", options), identity);
  }

  siteDrawing(): Promise<Outcome<SiteDrawingView>> {
    return answered(
      () => this.client.GET("/api/site/drawing", { signal: siteTimeout() }),
      identity,
      SITE_LATE,
    );
  }

  checkSite(body: SiteDrawingRequest): Promise<Outcome<SiteDrawingResponse>> {
    return answered(
      () => this.client.POST("/api/site/drawing/check", { body, signal: siteTimeout() }),
      identity,
      SITE_LATE,
    );
  }

  saveSite(body: SiteDrawingRequest): Promise<Outcome<SiteDrawingResponse>> {
    return answered(
      () => this.client.POST("/api/site/drawing", { body, signal: siteTimeout() }),
      identity,
      SITE_LATE,
    );
  }

  undoSite(revision: string): Promise<Outcome<SiteDrawingResponse>> {
    return answered(
      () =>
        this.client.POST("/api/site/drawing/undo", { body: { revision }, signal: siteTimeout() }),
      identity,
      SITE_LATE,
    );
  }

  importSite(file: File): Promise<Outcome<ImportedView>> {
    return attempt(async () => {
      const url = `${this.origin}/api/site/import?name=${encodeURIComponent(file.name.slice(-100))}`;
      const options = { method: "POST", headers: this.headers, body: file, signal: siteTimeout() };
      const response = await this.fetch(new Request(url, options));
      const answer: unknown = await response.json().catch(() => null);
      return response.ok ? done(answer as ImportedView) : failed(refusal(response, answer));
    }, SITE_LATE);
  }

  releaseStop(named: readonly string[] | null): Promise<Outcome<ActionResponse>> {
    const body = { serials: named === null ? null : [...named] };
    return answered(
      () => this.client.POST("/api/all-stop/release", { body, signal: timeout() }),
      identity,
    );
  }

  admitApp(
    link_id: number,
    serial: string,
    lasting: "always" | "session",
  ): Promise<Outcome<ActionResponse>> {
    const body = { link_id, serial, lasting, any_address: false };
    return answered(
      () => this.client.POST("/api/apps/admit", { body, signal: timeout() }),
      identity,
    );
  }

  refuseApp(link_id: number): Promise<Outcome<ActionResponse>> {
    const body = { link_id };
    return answered(
      () => this.client.POST("/api/apps/refuse", { body, signal: timeout() }),
      identity,
    );
  }

  acknowledge(alarm_id: number): Promise<Outcome<null>> {
    const options = { params: { path: { alarm_id } }, signal: timeout() };
    return withoutBody(() => this.client.POST("/api/alarms/{alarm_id}/acknowledge", options));
  }

  person(): Promise<Outcome<AccessView>> {
    return answered(() => this.client.GET("/api/access", { signal: timeout() }), identity);
  }

  flights(): Promise<Outcome<readonly FlightView[]>> {
    return answered(() => this.client.GET("/api/flights", { signal: timeout() }), identity);
  }

  flightFigures(name: string): Promise<Outcome<FlightFiguresView>> {
    const options = { params: { path: { name } }, signal: AbortSignal.timeout(RECORD_MS) };
    return answered(() => this.client.GET("/api/flights/{name}", options), identity);
  }

  flightFile(name: string, file: string): Promise<Outcome<Picture>> {
    return this.picture(`/api/flights/${encodeURIComponent(name)}/${file}`, RECORD_MS);
  }

  /** Why the station rejects this page, or null: a browser reports no reason for a WebSocket. */
  async refusalReason(): Promise<string | null> {
    const outcome = await attempt(async () => {
      const answer = await this.client.GET("/api/state", { signal: timeout() });
      return done(answer.response.ok ? null : refusal(answer.response, answer.error));
    });
    return outcome.kind === "answered" ? outcome.value : null;
  }

  /** Fetches a picture or file; always with the token's header, which an `<img>` could not send. */
  async picture(path: string, within_ms = 4 * REQUEST_MS): Promise<Outcome<Picture>> {
    return attempt(async () => {
      const request = new Request(this.origin + path, {
        headers: this.headers,
        signal: AbortSignal.timeout(within_ms),
      });
      const response = await this.fetch(request);
      if (!response.ok) return failed(refusal(response, await sentenceOf(response)));
      return done({ blob: await response.blob(), frameId: frameIdOf(response) });
    });
  }
}

/** The body of a refusal; null if it is no JSON. */
async function sentenceOf(response: Response): Promise<unknown> {
  try {
    return await response.json();
  } catch {
    return null;
  }
}

function frameIdOf(response: Response): number | null {
  const text = response.headers.get("X-Frame-Id");
  return text !== null && /^\d+$/.test(text) ? Number(text) : null;
}

/** Orders executed by virtual stick for as long as the page's stream lasts. */
const STEERED: readonly string[] = ["goto", "nudge", "hold_position"];

function orderBody({ serials, order }: NamedOrder, owner: string, given_at_unix_ms: number | null) {
  const body = { serials: [...serials], order, takeoff: false, given_at_unix_ms };
  return STEERED.includes(order.kind) ? { ...body, owner } : body;
}

function guardResult(vehicle_name: string, reason: string | null): OrderResult {
  return {
    accepted: reason === null,
    command_id: 0,
    is_simulated: false,
    link_id: null,
    parameters: {},
    parts: 0,
    reason,
    repairs: [],
    rule: reason === null ? null : "flying",
    serial: null,
    vehicle_name,
  };
}

type TimelineQuery = { [Key in keyof TimelineFilter]: NonNullable<TimelineFilter[Key]> };

function timeout(): AbortSignal {
  return AbortSignal.timeout(REQUEST_MS);
}

function siteTimeout(): AbortSignal {
  return AbortSignal.timeout(SITE_MS);
}

/** openapi-fetch widens pairs to lists; the station sends pairs. */
function asSurveyResponse(data: unknown): SurveyResponse {
  return data as SurveyResponse;
}

function asZoneResponse(data: unknown): TemporaryZoneResponse {
  return data as TemporaryZoneResponse;
}

function identity<T>(value: T): T {
  return value;
}

interface ApiResponse<D> {
  readonly data?: D;
  readonly error?: unknown;
  readonly response: Response;
}

function answered<D, T>(
  ask: () => Promise<ApiResponse<D>>,
  read: (data: D) => T,
  late = ORDER_LATE,
): Promise<Outcome<T>> {
  return attempt(async () => {
    const { data, error, response } = await ask();
    return data === undefined ? failed(refusal(response, error)) : done(read(data));
  }, late);
}

/** For requests whose answer has no body. */
function withoutBody(ask: () => Promise<ApiResponse<unknown>>): Promise<Outcome<null>> {
  return attempt(async () => {
    const { error, response } = await ask();
    return response.ok ? done(null) : failed(refusal(response, error));
  });
}

async function attempt<T>(ask: () => Promise<Outcome<T>>, late = ORDER_LATE): Promise<Outcome<T>> {
  try {
    return await ask();
  } catch (error) {
    return failed(unreached(error, late));
  }
}

function done<T>(value: T): Outcome<T> {
  return { kind: "answered", value };
}

function failed<T>(problem: string): Outcome<T> {
  return { kind: "failed", problem };
}

const ORDER_LATE = `The station did not answer within ${REQUEST_MS / 1000} s. The order may still have arrived: check the command list.`;

function unreached(error: unknown, late: string): string {
  const isLate = error instanceof DOMException && error.name === "TimeoutError";
  return isLate ? late : "Station unreachable. Use the remote controllers.";
}

const UNAUTHORISED = 401;

function refusal(response: Response, body: unknown): string {
  if (response.status === UNAUTHORISED) {
    return "Not logged in: the token is missing, wrong or ended.";
  }
  const message =
    typeof body === "object" && body !== null ? (body as { error?: unknown }).error : null;
  if (typeof message === "string") return message;
  return `Station error ${response.status} ${response.statusText}`.trim();
}
