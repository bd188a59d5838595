import type { Page, WebSocketRoute } from "@playwright/test";
import type {
  AccessView,
  BaseMapsView,
  CalibrationView,
  FlownRegionsView,
  FrozenFrameView,
  OrderRequest,
  OrderResult,
  PreflightView,
  SiteDrawingResponse,
  SiteDrawingView,
  SiteVehiclesResponse,
  SiteVehiclesView,
  StationState,
  SurveyCameraView,
  SurveyPaths,
} from "../../src/protocol";
import { surveyEstimate } from "../../src/testing/fakeField";

const MINI_3_PRO: SurveyCameraView = {
  name: "mini3pro",
  title: "DJI Mini 3 Pro",
  across_px: 4032,
  along_px: 3024,
  across_deg: 71.6,
  along_deg: 56.9,
  timer_s: [2, 3, 5],
  shutter: "rolling",
  source: "",
};

/** A station inside the browser: answers requests and sends the states a test provides. */
export class FakeStation {
  /** Orders, without the times at which they were given. */
  readonly orders: Omit<OrderRequest, "given_at_unix_ms">[] = [];
  readonly acknowledged: number[] = [];
  allStops = 0;
  /** Whether an all stop answers for each vehicle, as the gate does: those on the ground are refused. */
  stopsAll = false;
  /** All other requests: path and body, likewise. */
  readonly requests: [path: string, body: unknown][] = [];
  /** The gate's result for checked orders. */
  checkResult: Partial<OrderResult> = {};
  preflight: PreflightView | null = null;
  flown: FlownRegionsView = { today: "2026-05-03", regions: [], unreadable: [] };
  /** The person of the page's requests: this computer's user. */
  person: AccessView = {
    name: "local-operator",
    role: "admin",
    is_logged_in: false,
    urls: [],
    fingerprint: null,
  };
  /** The site's folder, and the answer to checks and saves. */
  drawing: SiteDrawingView = { revision: "r1", features: [], locked_reason: null, undo: null };
  drawingResult: SiteDrawingResponse = {
    accepted: true,
    rule: null,
    reason: null,
    feature: null,
    layers: [],
    also: [],
    drawing: null,
  };
  /** The vehicles of the site's folder, and the answer to their checks and saves. */
  vehicles: SiteVehiclesView = { revision: "r1", vehicles: [], locked_reason: null, undo: null };
  vehiclesResult: SiteVehiclesResponse = {
    accepted: true,
    rule: null,
    reason: null,
    row: null,
    changes: [],
    vehicles: null,
  };
  /** What a freeze and a fit answer. */
  frozen: FrozenFrameView | null = null;
  fit: CalibrationView | null = null;
  /** The base maps of the site's folder. */
  maps: BaseMapsView = { maps: [], note: "No map in the site's folder maps" };
  /** Answer for any survey's paths. */
  paths: SurveyPaths | null = null;
  private sockets: WebSocketRoute[] = [];
  private isReachable = true;
  private picture: Buffer | null = null;

  private constructor(private state: StationState) {}

  /** Replaces the station for `page`; call before opening it. */
  static async behind(page: Page, state: StationState): Promise<FakeStation> {
    const fake = new FakeStation(state);
    await page.routeWebSocket(/\/api\/stream\?owner=[0-9a-f]{32}&changes=2$/, (socket) =>
      fake.accept(socket),
    );
    await page.route("**/api/**", (route) => {
      const request = route.request();
      const answer = fake.answer(new URL(request.url()), request.postData());
      return answer === null ? route.abort() : route.fulfill(answer);
    });
    return fake;
  }

  /** Sends a new state. */
  send(state: StationState): void {
    this.state = state;
    for (const socket of this.sockets) socket.send(JSON.stringify(state));
  }

  /** Sets the picture of `ground-image.png` and `frame.jpg`. */
  showPicture(picture: Buffer): void {
    this.picture = picture;
  }

  /** Closes the streams and answers nothing until `goOnline`. */
  async goOffline(): Promise<void> {
    this.isReachable = false;
    const closed = this.sockets;
    this.sockets = [];
    await Promise.all(closed.map((socket) => socket.close()));
  }

  goOnline(): void {
    this.isReachable = true;
  }

  private accept(socket: WebSocketRoute): void {
    if (!this.isReachable) {
      void socket.close();
      return;
    }
    this.sockets.push(socket);
    socket.send(JSON.stringify(this.state));
    socket.onMessage(() => undefined);
  }

  private answer({ pathname: path, search }: URL, body: string | null) {
    if (!this.isReachable) return null;
    if (path === "/api/access") return { json: this.person };
    if (path === "/api/orders") return this.order(JSON.parse(body ?? "{}") as OrderRequest);
    if (path === "/api/orders/check")
      return this.checkOrder(JSON.parse(body ?? "{}") as OrderRequest);
    if (path.endsWith("/preflight") && this.preflight !== null) return { json: this.preflight };
    if (path.endsWith("/paths") && this.paths !== null) return { json: this.paths };
    if (path === "/api/site/drawing" && body === null) return { json: this.drawing };
    if (path === "/api/site/vehicles" && body === null) return { json: this.vehicles };
    if (path.startsWith("/api/site/vehicles")) return { json: this.vehiclesResult };
    if (path === "/api/site/calibration/freeze" && this.frozen !== null)
      return { json: this.frozen };
    if (path === "/api/site/calibration/frame.jpg" && this.picture !== null)
      return {
        body: this.picture,
        contentType: "image/jpeg",
        headers: { "X-Frame-Id": String(this.frozen?.frame_id) },
      };
    if (path.startsWith("/api/site/calibration")) return { json: this.fit };
    if (path === "/api/maps") return { json: this.maps };
    if (path.startsWith("/api/maps/") && this.picture !== null)
      return { body: this.picture, contentType: "image/png" };
    if (path === "/api/surveys/estimate") return { json: surveyEstimate({ survey_id: 0 }) };
    if (path === "/api/flown-regions") return { json: this.flown };
    if (path === "/api/cameras") return { json: [MINI_3_PRO] };
    if (path.startsWith("/api/site/drawing")) return { json: this.drawingResult };
    const isControlRequest = /\/(authority|override|release|zones|end)$/.test(path);
    if (isControlRequest || path === "/api/fleet-return") {
      const { given_at_unix_ms: _given, ...asked } = JSON.parse(body ?? "{}") as OrderRequest;
      this.requests.push([path + search, asked]);
      return {
        json: isControlRequest ? { accepted: true, rule: null, reason: null } : { results: [] },
      };
    }
    if (/\/dismiss$|^\/api\/separation-hold\//.test(path)) {
      this.requests.push([path + search, null]);
      return { status: 204 };
    }
    if (path === "/api/all-stop") return this.stopAll();
    const alarm = /^\/api\/alarms\/(\d+)\/acknowledge$/.exec(path);
    if (alarm !== null) {
      this.acknowledged.push(Number(alarm[1]));
      return { status: 204 };
    }
    if (/\.(png|jpg)$/.test(path) && this.picture !== null) {
      const frame = String(this.state.ground_image?.frame_id ?? 1);
      return { body: this.picture, contentType: "image/png", headers: { "X-Frame-Id": frame } };
    }
    return { status: 404, json: { error: "not found" } };
  }

  private order(request: OrderRequest) {
    const { given_at_unix_ms: _given, ...order } = request;
    this.orders.push(order);
    return { json: { results: this.results(request) } };
  }

  private checkOrder(request: OrderRequest) {
    const checked = this.results(request).map((result) => ({ ...result, ...this.checkResult }));
    return { json: { results: checked } };
  }

  private results(request: OrderRequest) {
    return request.serials.map((serial, index) => ({
      serial,
      link_id: index + 1,
      vehicle_name: this.nameOf(serial),
      is_simulated: this.isSimulated(serial),
      accepted: true,
      command_id: 40 + index,
      rule: null,
      reason: null,
    }));
  }

  private stopAll() {
    this.allStops += 1;
    if (!this.stopsAll) return { json: { results: [] } };
    const serials = this.state.vehicles.flatMap(({ serial }) => serial ?? []);
    const results = this.results({ serials, order: { kind: "hover" }, takeoff: false });
    const isFlying = (serial: string | null) =>
      this.state.vehicles.find((one) => one.serial === serial)?.is_flying.value === true;
    return {
      json: {
        results: results.map((result) =>
          isFlying(result.serial)
            ? result
            : { ...result, accepted: false, rule: "flying", reason: "on the ground" },
        ),
      },
    };
  }

  private isSimulated(serial: string): boolean {
    return this.state.vehicles.find((vehicle) => vehicle.serial === serial)?.is_simulated ?? false;
  }

  private nameOf(serial: string): string {
    return this.state.vehicles.find((vehicle) => vehicle.serial === serial)?.name ?? serial;
  }
}
