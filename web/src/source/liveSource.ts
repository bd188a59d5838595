import { createSignal } from "solid-js";
import type { AccessView, Connection, StationState } from "../protocol";
import type { Clock, Instant } from "./clock";
import { flightRequests } from "./flightRequests";
import { FramePacer, type NextFrame } from "./framePacer";
import { lightRequests } from "./lightRequests";
import { mapRequests } from "./mapRequests";
import { orderRequests } from "./orderRequests";
import { photoRequests } from "./photoRequests";
import { replayRequests } from "./replayRequests";
import { siteRequests } from "./siteRequests";
import { StationHttp } from "./stationHttp";
import { stationRequests } from "./stationRequests";
import type { StationSource } from "./stationSource";
import { newStreamOwner, type Socket, Stream } from "./stream";
import { StreamLag } from "./streamLag";
import { surveyRequests } from "./surveyRequests";
import { vehicleRequests } from "./vehicleRequests";

/** Dependencies of a live source; tests pass fakes. */
export interface LiveSourceOptions {
  /** The station's address, such as `http://127.0.0.1:8080`. */
  readonly origin: string;
  /** The token this page was opened with; null without one. */
  readonly token: string | null;
  readonly clock: Clock;
  /** Fills the array with cryptographically random bytes. */
  random(bytes: Uint8Array): Uint8Array;
  openSocket(url: string, protocols: string[]): Socket;
  /** Paces the states to the screen; without it every one is handed on. */
  readonly nextFrame?: NextFrame;
  fetch(request: Request): Promise<Response>;
}

interface Received {
  readonly newest: StationState;
  readonly receivedAt: Instant;
}

/** WebSocket subprotocol of the stream. */
export const STREAM_PROTOCOL = "recon.v1";

/** A source connected to a running station. */
export class LiveSource implements StationSource {
  readonly state;
  readonly connection;
  readonly person;
  readonly orders;
  readonly vehicles;
  readonly surveys;
  readonly light;
  readonly site;
  readonly maps;
  readonly flights;
  readonly photos;
  readonly replay;
  readonly station;
  private readonly lag = new StreamLag();
  private readonly stream: Stream;
  private readonly clock: Clock;
  private owner = "";

  constructor(options: LiveSourceOptions) {
    const { clock, origin, token } = options;
    this.clock = clock;
    const [state, setState] = createSignal<StationState | null>(null, { equals: false });
    const [connection, setConnection] = createSignal<Connection>({ kind: "connecting" });
    this.state = state;
    this.connection = connection;
    const [person, setPerson] = createSignal<AccessView | null>(null);
    this.person = person;
    const http = new StationHttp(origin, token, (request) => options.fetch(request));
    const stationNowMs = () => this.stationNowMs();
    this.orders = orderRequests(http, {
      clock,
      owner: () => this.owner,
      stationNowMs,
      guardUrl: () => state()?.station.guard_stop_url ?? null,
      personName: () => person()?.name ?? null,
    });
    this.vehicles = vehicleRequests(http);
    this.surveys = surveyRequests(http, stationNowMs);
    this.light = lightRequests(http);
    this.site = siteRequests(http);
    this.maps = mapRequests(http);
    this.flights = flightRequests(http);
    this.photos = photoRequests(http);
    this.replay = replayRequests(http);
    this.station = stationRequests(http);
    const url = `${origin.replace(/^http/, "ws")}/api/stream`;
    const open = () => {
      // A new owner: orders held by an earlier connection stay stopped.
      this.owner = newStreamOwner((bytes) => options.random(bytes));
      return options.openSocket(`${url}?owner=${this.owner}&changes=2`, streamProtocols(token));
    };
    // Ages count from the state that is shown.
    const show = ({ newest, receivedAt }: Received) => {
      // A replay has a clock of its own, which pauses and jumps.
      if (newest.replay !== null) this.lag.restart(newest.time_ns, receivedAt);
      else this.lag.record(newest.time_ns, receivedAt);
      setState(newest);
    };
    const pacer = new FramePacer(show, options.nextFrame ?? ((action) => action()));
    this.stream = new Stream(open, clock, {
      onConnection: (next) => {
        setConnection(next);
        if (next.kind === "lost") {
          if (next.needsLogin !== true) void this.explain(next, setConnection);
        } else if (next.kind === "live") {
          void this.station.person().then((outcome) => {
            if (outcome.kind === "answered") setPerson(outcome.value);
          });
        }
      },
      onState: (newest, isFirst) => {
        const received = { newest, receivedAt: clock.now() };
        if (isFirst) this.lag.restart(newest.time_ns, received.receivedAt);
        if (isFirst) pacer.restart(received);
        else pacer.offer(received);
      },
    });
    this.stream.open();
  }

  /** Replaces the assumed reason of a lost connection with the station's own, if it gives one. */
  private async explain(
    lost: Connection & { kind: "lost" },
    setConnection: (connection: Connection) => void,
  ): Promise<void> {
    const reason = await this.station.refusalReason();
    if (reason !== null && this.connection() === lost) setConnection({ ...lost, reason });
  }

  behindS(now: Instant): number | null {
    return this.lag.behindS(now);
  }

  /** The station's present time by its newest state, Unix milliseconds; null before the first. */
  private stationNowMs(): number | null {
    const state = this.state();
    const behindS = this.lag.behindS(this.clock.now());
    return state === null || behindS === null
      ? null
      : Math.round(state.time_ns / 1e6 + behindS * 1000);
  }

  close(): void {
    this.stream.close();
  }
}

/** A browser cannot set headers on a WebSocket, so the token travels as a second subprotocol. */
function streamProtocols(token: string | null): string[] {
  return token === null ? [STREAM_PROTOCOL] : [STREAM_PROTOCOL, `recon.token.${token}`];
}
