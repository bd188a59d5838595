import type { NamedOrder, Order, OrderResponse, OrderResult, Outcome } from "../protocol";
import { text } from "../text/catalogue";
import type { Clock } from "./clock";
import {
  answered,
  attempt,
  CHANGE,
  done,
  failed,
  ORDER,
  READ,
  type StationHttp,
} from "./stationHttp";

/** A station that runs answers an all stop within some tens of milliseconds. */
export const GUARD_AFTER_MS = 1_000;

/** What orders need to know of the stream. */
export interface OrderContext {
  readonly clock: Clock;
  /** The owner that a steered order depends on. */
  owner(): string;
  /** An order to move that arrives long after it was given, in the station's time, is refused. */
  stationNowMs(): number | null;
  /** Where the station's guard takes an all stop; null without one. */
  guardUrl(): string | null;
  /** The person of this page. */
  personName(): string | null;
}

export type OrderRequests = ReturnType<typeof orderRequests>;

/** Whatever moves vehicles, or stops them. */
export function orderRequests(http: StationHttp, context: OrderContext) {
  const { client } = http;
  const bodyOf = ({ serials, order, takeoff }: NamedOrder) => ({
    serials: [...serials],
    order,
    takeoff: takeoff ?? false,
    given_at_unix_ms: context.stationNowMs(),
    ...(IS_STEERED[order.kind] && { owner: context.owner() }),
  });
  return {
    /** Sends an order. */
    send: (named: NamedOrder) => {
      const body = bodyOf(named);
      return answered(ORDER, (signal) => client.POST("/api/orders", { body, signal }), resultsOf);
    },
    /** Checks an order with the safety gate without sending it. */
    check: (named: NamedOrder) => {
      const body = bodyOf(named);
      return answered(
        READ,
        (signal) => client.POST("/api/orders/check", { body, signal }),
        resultsOf,
      );
    },
    /**
     * Makes every flying vehicle hold position, and latches all; motors stay on. The station's guard is asked too, when
     * the station does not answer.
     */
    allStop: async (): Promise<Outcome<readonly OrderResult[]>> => {
      const guardUrl = context.guardUrl();
      const asked = answered(
        ORDER,
        (signal) => client.POST("/api/all-stop", { signal }),
        resultsOf,
      );
      if (guardUrl === null) return asked;
      const silence = new Promise<null>((resolve) =>
        context.clock.after(GUARD_AFTER_MS, () => resolve(null)),
      );
      const first = await Promise.race([asked, silence]);
      if (first?.kind === "answered") return first;
      const held = await allStopAtGuard(http, guardUrl, context.personName());
      return held.kind === "answered" ? held : asked;
    },
    /** Releases vehicles from the all stop in force; null means all, also those that connect later. */
    releaseStop: (named: readonly string[] | null) => {
      const body = { serials: named === null ? null : [...named] };
      return answered(CHANGE, (signal) => client.POST("/api/all-stop/release", { body, signal }));
    },
    /** Returns vehicles home with landing missions at separate heights; null means all in reach. */
    fleetReturn: (named: readonly string[] | null) => {
      const given_at_unix_ms = context.stationNowMs();
      const body = { serials: named === null ? null : [...named], given_at_unix_ms };
      return answered(
        ORDER,
        (signal) => client.POST("/api/fleet-return", { body, signal }),
        resultsOf,
      );
    },
    /** Has the imaging drone fly 25 m aside and back. */
    sideStep: (serial: string) => {
      const body = { serial, given_at_unix_ms: context.stationNowMs() };
      return answered(ORDER, (signal) => client.POST("/api/side-step", { body, signal }));
    },
    /** Has an imaging drone take the place of another; of the same serial: return to its own. */
    relieve: (serial: string, spare: string, takeoff: boolean) => {
      const body = { serial, spare, takeoff, given_at_unix_ms: context.stationNowMs() };
      return answered(ORDER, (signal) => client.POST("/api/imager-relief", { body, signal }));
    },
  };
}

/** Whether an order is executed by virtual stick, for as long as the page's stream lasts. */
const IS_STEERED: Readonly<Record<Order["kind"], boolean>> = {
  hover: false,
  land: false,
  return_home: false,
  camera_start: false,
  camera_stop: false,
  camera_lock: false,
  mission: false,
  stick: false,
  goto: true,
  nudge: true,
  hold_position: true,
};

function resultsOf({ results }: OrderResponse): readonly OrderResult[] {
  return results;
}

/** An all stop at the station's guard: no order of the station, so results have no number. */
function allStopAtGuard(http: StationHttp, url: string, by: string | null) {
  return attempt(ORDER, async (signal) => {
    const body = JSON.stringify(by === null ? {} : { by });
    const response = await http.fetch(new Request(url, { method: "POST", body, signal }));
    if (!response.ok)
      return failed<readonly OrderResult[]>(text.requests.guardRefused(response.status));
    const { held, refused } = (await response.json()) as { held: string[]; refused: string[] };
    const reason = text.requests.notSeenFlying;
    return done<readonly OrderResult[]>([
      ...held.map((name) => guardResult(name, null)),
      ...refused.map((name) => guardResult(name, reason)),
    ]);
  });
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
