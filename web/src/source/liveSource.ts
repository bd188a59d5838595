import { createSignal } from "solid-js";
import type { AccessView, AuthorityHolder, StationState } from "../protocol";
import type { Clock, Instant } from "./clock";
import { flightRequests } from "./flightRequests";
import { FramePacer, type NextFrame } from "./framePacer";
import { mapRequests } from "./mapRequests";
import { replayRequests } from "./replayRequests";
import { Requests } from "./requests";
import { siteRequests } from "./siteRequests";
import { StationHttp } from "./stationHttp";
import type {
  Connection,
  NamedOrder,
  NewZone,
  StationSource,
  TimelineFilter,
} from "./stationSource";
import { newStreamOwner, type Socket, Stream } from "./stream";
import { StreamLag } from "./streamLag";
import { surveyRequests } from "./surveyRequests";

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

/** A station that runs answers an all stop within some tens of milliseconds. */
export const GUARD_AFTER_MS = 1_000;

/** A source connected to a running station. */
export class LiveSource implements StationSource {
  readonly state;
  readonly connection;
  readonly person;
  readonly site;
  readonly flights;
  readonly maps;
  readonly surveys;
  readonly replay;
  private readonly lag = new StreamLag();
  private readonly stream: Stream;
  private readonly http: StationHttp;
  private readonly requests: Requests;
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
    this.http = new StationHttp(origin, token, (request) => options.fetch(request));
    this.requests = new Requests(this.http);
    this.site = siteRequests(this.http);
    this.flights = flightRequests(this.http);
    this.maps = mapRequests(this.http);
    this.replay = replayRequests(this.http);
    this.surveys = surveyRequests(this.http, () => this.stationNowMs());
    const url = `${origin.replace(/^http/, "ws")}/api/stream`;
    const open = () => {
      // A new owner: orders held by an earlier connection stay stopped.
      this.owner = newStreamOwner((bytes) => options.random(bytes));
      return options.openSocket(`${url}?owner=${this.owner}&changes=1`, streamProtocols(token));
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
          void this.requests.person().then((outcome) => {
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
    const reason = await this.requests.refusalReason();
    if (reason !== null && this.connection() === lost) setConnection({ ...lost, reason });
  }

  behindS(now: Instant): number | null {
    return this.lag.behindS(now);
  }

  order(order: NamedOrder) {
    return this.requests.order(order, this.owner, this.stationNowMs());
  }

  check(order: NamedOrder) {
    return this.requests.check(order, this.owner, this.stationNowMs());
  }

  /** The station's present time by its newest state, Unix milliseconds; null before the first. */
  private stationNowMs(): number | null {
    const state = this.state();
    const behindS = this.lag.behindS(this.clock.now());
    return state === null || behindS === null
      ? null
      : Math.round(state.time_ns / 1e6 + behindS * 1000);
  }

  admitApp(linkId: number, serial: string, lasting: "always" | "session") {
    return this.requests.admitApp(linkId, serial, lasting);
  }

  refuseApp(linkId: number) {
    return this.requests.refuseApp(linkId);
  }

  drawZone(zone: NewZone) {
    return this.requests.drawZone(zone);
  }

  endZone(id: number) {
    return this.requests.endZone(id);
  }

  timeline(filter: TimelineFilter, atMost: number) {
    return this.requests.timeline(filter, atMost);
  }

  releaseStop(serials: readonly string[] | null) {
    return this.requests.releaseStop(serials);
  }

  fleetReturn(serials: readonly string[] | null) {
    return this.requests.fleetReturn(serials, this.stationNowMs());
  }

  lookAside(serial: string) {
    return this.requests.lookAside(serial, this.stationNowMs());
  }

  relieve(serial: string, spare: string, takeoff: boolean) {
    return this.requests.relieve(serial, spare, takeoff, this.stationNowMs());
  }

  setAuthority(serial: string, holder: AuthorityHolder, takeOver = false) {
    return this.requests.setAuthority(serial, holder, takeOver);
  }

  preflight(serial: string) {
    return this.requests.preflight(serial);
  }

  overridePreflight(serial: string, reason: string) {
    return this.requests.overridePreflight(serial, reason);
  }

  dismissHazard(name: string) {
    return this.requests.dismissHazard(name);
  }

  setSeparationHold(isOn: boolean) {
    return this.requests.setSeparationHold(isOn);
  }

  /** Asks the station's guard too, when the station does not answer. */
  async allStop() {
    const guardUrl = this.state()?.station.guard_stop_url ?? null;
    const asked = this.requests.allStop();
    if (guardUrl === null) return asked;
    const silence = new Promise<null>((resolve) =>
      this.clock.after(GUARD_AFTER_MS, () => resolve(null)),
    );
    const first = await Promise.race([asked, silence]);
    if (first?.kind === "answered") return first;
    const held = await this.requests.allStopAtGuard(guardUrl, this.person()?.name ?? null);
    return held.kind === "answered" ? held : asked;
  }

  acknowledge(alarmId: number) {
    return this.requests.acknowledge(alarmId);
  }

  vehicleFrame(serial: string, frameId: number) {
    return this.http.picture(
      `/api/vehicle/frame.jpg?serial=${encodeURIComponent(serial)}&id=${frameId}`,
    );
  }

  groundImage(frameId: number) {
    return this.http.picture(`/api/ground-image.png?id=${frameId}`);
  }

  sharedAddressCode() {
    return this.http.picture("/api/access/qr.svg");
  }

  appAddressCode() {
    return this.http.picture("/api/apps/qr.svg");
  }

  groundImageFile() {
    return this.http.picture("/api/ground-image.tif");
  }

  shadePicture(number: number) {
    return this.http.picture(`/api/shade.png?id=${number}`);
  }

  forecastPicture(number: number, lead_s: number) {
    return this.http.picture(`/api/forecast.png?id=${number}&lead_s=${lead_s}`);
  }

  sunAt(latitudeDeg: number, longitudeDeg: number) {
    return this.requests.sunAt(latitudeDeg, longitudeDeg);
  }

  upwindPlace(serial: string) {
    return this.requests.upwindPlace(serial);
  }

  close(): void {
    this.stream.close();
  }
}

/** A browser cannot set headers on a WebSocket, so the token travels as a second subprotocol. */
function streamProtocols(token: string | null): string[] {
  return token === null ? [STREAM_PROTOCOL] : [STREAM_PROTOCOL, `recon.token.${token}`];
}
