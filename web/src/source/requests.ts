import type {
  AccessView,
  ActionResponse,
  AuthorityHolder,
  OrderResult,
  PreflightView,
  SunAtView,
  TemporaryZoneRequest,
  TemporaryZoneResponse,
  TimelineView,
  UpwindView,
} from "../protocol";
import { text } from "../text/catalogue";
import {
  answered,
  attempt,
  CHANGE,
  done,
  failed,
  ORDER,
  READ,
  refusal,
  type StationHttp,
  withoutBody,
} from "./stationHttp";
import type { NamedOrder, NewZone, Outcome, TimelineFilter } from "./stationSource";

/** HTTP requests to the station about vehicles, alarms and access. */
export class Requests {
  private readonly client;

  constructor(private readonly http: StationHttp) {
    this.client = http.client;
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
      ORDER,
      (signal) => this.client.POST("/api/orders", { body, signal }),
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
      READ,
      (signal) => this.client.POST("/api/orders/check", { body, signal }),
      (data) => data.results,
    );
  }

  fleetReturn(
    named: readonly string[] | null,
    given_at_unix_ms: number | null,
  ): Promise<Outcome<readonly OrderResult[]>> {
    const body = { serials: named === null ? null : [...named], given_at_unix_ms };
    return answered(
      ORDER,
      (signal) => this.client.POST("/api/fleet-return", { body, signal }),
      (data) => data.results,
    );
  }

  lookAside(serial: string, given_at_unix_ms: number | null): Promise<Outcome<ActionResponse>> {
    const body = { serial, given_at_unix_ms };
    return answered(ORDER, (signal) => this.client.POST("/api/look-aside", { body, signal }));
  }

  relieve(
    serial: string,
    spare: string,
    takeoff: boolean,
    given_at_unix_ms: number | null,
  ): Promise<Outcome<ActionResponse>> {
    const body = { serial, spare, takeoff, given_at_unix_ms };
    return answered(ORDER, (signal) => this.client.POST("/api/imager-relief", { body, signal }));
  }

  /** `take_over`: also from another person who operates the vehicle. */
  setAuthority(
    serial: string,
    holder: AuthorityHolder,
    take_over: boolean,
  ): Promise<Outcome<ActionResponse>> {
    const options = { params: { query: { serial } }, body: { holder, take_over } };
    return answered(CHANGE, (signal) =>
      this.client.POST("/api/vehicle/authority", { ...options, signal }),
    );
  }

  preflight(serial: string): Promise<Outcome<PreflightView>> {
    const params = { query: { serial } };
    return answered(READ, (signal) =>
      this.client.GET("/api/vehicle/preflight", { params, signal }),
    );
  }

  overridePreflight(serial: string, reason: string): Promise<Outcome<ActionResponse>> {
    const options = { params: { query: { serial } }, body: { reason } };
    return answered(CHANGE, (signal) =>
      this.client.POST("/api/vehicle/preflight/override", { ...options, signal }),
    );
  }

  sunAt(latitude_deg: number, longitude_deg: number): Promise<Outcome<SunAtView>> {
    const params = { query: { latitude_deg, longitude_deg } };
    return answered(READ, (signal) => this.client.GET("/api/sun-at", { params, signal }));
  }

  upwindPlace(serial: string): Promise<Outcome<UpwindView>> {
    const params = { query: { serial } };
    return answered(READ, (signal) => this.client.GET("/api/upwind-place", { params, signal }));
  }

  dismissHazard(serial: string): Promise<Outcome<null>> {
    const params = { query: { serial } };
    return withoutBody(CHANGE, (signal) =>
      this.client.POST("/api/vehicle/hazard/dismiss", { params, signal }),
    );
  }

  setSeparationHold(isOn: boolean): Promise<Outcome<null>> {
    const path: { switch: "on" | "off" } = { switch: isOn ? "on" : "off" };
    return withoutBody(CHANGE, (signal) =>
      this.client.POST("/api/separation-hold/{switch}", { params: { path }, signal }),
    );
  }

  allStop(): Promise<Outcome<readonly OrderResult[]>> {
    return answered(
      ORDER,
      (signal) => this.client.POST("/api/all-stop", { signal }),
      (data) => data.results,
    );
  }

  /** An all stop at the station's guard: no order of the station, so results have no number. */
  allStopAtGuard(url: string, by: string | null): Promise<Outcome<readonly OrderResult[]>> {
    return attempt(ORDER, async (signal) => {
      const body = JSON.stringify(by === null ? {} : { by });
      const response = await this.http.fetch(new Request(url, { method: "POST", body, signal }));
      if (!response.ok) return failed(text.requests.guardRefused(response.status));
      const { held, missed } = (await response.json()) as { held: string[]; missed: string[] };
      const reason = text.requests.notSeenFlying;
      return done([
        ...held.map((name) => guardResult(name, null)),
        ...missed.map((name) => guardResult(name, reason)),
      ]);
    });
  }

  drawZone(zone: NewZone): Promise<Outcome<TemporaryZoneResponse>> {
    const body = zone as TemporaryZoneRequest;
    return answered(
      CHANGE,
      (signal) => this.client.POST("/api/zones", { body, signal }),
      // openapi-fetch widens pairs to lists; the station sends pairs.
      (data) => data as TemporaryZoneResponse,
    );
  }

  endZone(zone_id: number): Promise<Outcome<ActionResponse>> {
    const params = { path: { zone_id } };
    return answered(CHANGE, (signal) =>
      this.client.POST("/api/zones/{zone_id}/end", { params, signal }),
    );
  }

  timeline(filter: TimelineFilter, at_most: number): Promise<Outcome<TimelineView>> {
    const given = Object.entries(filter).filter(([, value]) => value !== null);
    const query = { ...(Object.fromEntries(given) as Partial<TimelineQuery>), at_most };
    return answered(READ, (signal) =>
      this.client.GET("/api/timeline", { params: { query }, signal }),
    );
  }

  releaseStop(named: readonly string[] | null): Promise<Outcome<ActionResponse>> {
    const body = { serials: named === null ? null : [...named] };
    return answered(CHANGE, (signal) =>
      this.client.POST("/api/all-stop/release", { body, signal }),
    );
  }

  admitApp(
    link_id: number,
    serial: string,
    lasting: "always" | "session",
  ): Promise<Outcome<ActionResponse>> {
    const body = { link_id, serial, lasting, any_address: false };
    return answered(CHANGE, (signal) => this.client.POST("/api/apps/admit", { body, signal }));
  }

  refuseApp(link_id: number): Promise<Outcome<ActionResponse>> {
    const body = { link_id };
    return answered(CHANGE, (signal) => this.client.POST("/api/apps/refuse", { body, signal }));
  }

  acknowledge(alarm_id: number): Promise<Outcome<null>> {
    const params = { path: { alarm_id } };
    return withoutBody(CHANGE, (signal) =>
      this.client.POST("/api/alarms/{alarm_id}/acknowledge", { params, signal }),
    );
  }

  person(): Promise<Outcome<AccessView>> {
    return answered(READ, (signal) => this.client.GET("/api/access", { signal }));
  }

  /** Why the station rejects this page, or null: a browser reports no reason for a WebSocket. */
  async refusalReason(): Promise<string | null> {
    const outcome = await attempt(READ, async (signal) => {
      const { response, error } = await this.client.GET("/api/state", { signal });
      return done(response.ok ? null : refusal(response, error));
    });
    return outcome.kind === "answered" ? outcome.value : null;
  }
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
