import { describe, expect, it, vi } from "vitest";
import { FakeClock } from "../testing/fakeClock";
import { FakeSocket } from "../testing/fakeSocket";
import { station, vehicle } from "../testing/fakeState";
import { LiveSource } from "./liveSource";

type Answer = (request: Request) => Response | Promise<Response>;

function setUp(answer: Answer, token: string | null = null) {
  const clock = new FakeClock();
  let next = 1;
  const sockets: FakeSocket[] = [];
  const requests: Request[] = [];
  const source = new LiveSource({
    origin: "http://127.0.0.1:8080",
    token,
    clock,
    random: (bytes) => bytes.fill(next++),
    openSocket: (url, protocols) => {
      const socket = new FakeSocket(url, protocols);
      sockets.push(socket);
      return socket;
    },
    fetch: async (request) => {
      requests.push(request);
      return answer(request);
    },
  });
  return { clock, source, sockets, requests };
}

const posted = (requests: Request[]) => requests.filter(({ method }) => method === "POST");

const HOVER = { serials: ["A"], order: { kind: "hover" as const } };
const ZONE = { kind: "person" as const, reason: "a walker" };
const SURVEY = { height_above_takeoff_m: 40, speed_mps: 5 };
const DRAWING = { revision: "r1", features: [] };
const ALL = { serial: null, about: null, before: null };

const json = (value: unknown, status = 200) => Response.json(value, { status });

describe("the live source", () => {
  it("shows the newest state and its lag", () => {
    const { source, sockets, clock } = setUp(() => json({}));
    expect(source.state()).toBeNull();
    sockets[0]?.deliver(station([vehicle(1)]));
    clock.advance(400);
    expect(source.state()?.vehicles).toHaveLength(1);
    expect(source.behindS(clock.now())).toBeCloseTo(0.4);
    expect(source.connection().kind).toBe("live");
  });

  it("adds no age in a replay, whose clock pauses and jumps", () => {
    const { source, sockets, clock } = setUp(() => json({}));
    const replay = {
      file: "a.mcap",
      duration_s: 100,
      position_s: 0,
      speed: 1,
      is_playing: false,
      trouble: null,
    };
    for (const time_ns of [90e9, 90e9, 5e9, 95e9]) {
      sockets[0]?.deliver(station([vehicle(1)], { replay, time_ns }));
      expect(source.behindS(clock.now())).toBe(0);
      clock.advance(1000);
    }
  });

  it("sends the token as a header and as a subprotocol, never in a URL", async () => {
    const { source, sockets, requests } = setUp(() => new Response("png"), "s3cret-token");
    await source.light.groundImage(7);
    expect(sockets[0]?.protocols).toEqual(["recon.v1", "recon.token.s3cret-token"]);
    expect(requests[0]?.headers.get("Authorization")).toBe("Bearer s3cret-token");
    expect(`${sockets[0]?.url} ${requests[0]?.url}`).not.toContain("s3cret");
  });

  it("opens the stream at the page's origin", () => {
    const { sockets } = setUp(() => json({}));
    expect(sockets[0]?.url).toBe(
      `ws://127.0.0.1:8080/api/stream?owner=${"01".repeat(16)}&changes=2`,
    );
    expect(sockets[0]?.protocols).toEqual(["recon.v1"]);
  });

  it("reports the station's reason when access is denied", async () => {
    const { source, sockets, requests } = setUp(() => json({ error: "a token is needed" }, 401));
    sockets[0]?.fail();
    expect(source.connection()).toMatchObject({ reason: "Station unreachable" });
    await expect
      .poll(() => source.connection())
      .toMatchObject({
        kind: "lost",
        reason: "Not logged in: the token is missing, wrong or ended.",
      });
    expect(requests.map(({ url }) => new URL(url).pathname)).toEqual(["/api/state"]);
  });

  it("sends its newest stream as the owner of steered orders only", async () => {
    const { source, sockets, requests, clock } = setUp(() => json({ results: [] }));
    sockets[0]?.fail();
    clock.advance(1000);
    expect(sockets[1]?.url).toContain("02".repeat(16));
    const place = { latitude_deg: 44.7, longitude_deg: -93.07, height_above_takeoff_m: 40 };
    const goto = { kind: "goto" as const, ...place, speed_mps: 5 };
    await source.orders.check({ serials: ["A"], order: goto });
    await source.orders.send({ serials: ["A"], order: goto });
    await source.orders.send({ serials: ["A"], order: { kind: "hover" } });
    const asked = requests.filter(({ url }) => url.includes("/api/orders"));
    const bodies = await Promise.all(asked.map((request) => request.json()));
    expect(asked.map(({ url }) => new URL(url).pathname)).toEqual([
      "/api/orders/check",
      "/api/orders",
      "/api/orders",
    ]);
    expect(bodies.map(({ owner }) => owner)).toEqual(["02".repeat(16), "02".repeat(16), undefined]);
  });

  it("states when an order was given, in the station's time", async () => {
    const { source, sockets, requests, clock } = setUp(() => json({ results: [] }));
    await source.orders.send({ serials: ["A"], order: { kind: "hover" } });
    sockets[0]?.deliver(station([vehicle(1)], { time_ns: 1_780_000_000e9 }));
    clock.advance(400);
    await source.orders.send({ serials: ["A"], order: { kind: "hover" } });
    const bodies = await Promise.all(posted(requests).map((request) => request.json()));
    expect(bodies.map(({ given_at_unix_ms }) => given_at_unix_ms)).toEqual([
      null,
      1_780_000_000_400,
    ]);
  });

  it("releases an all stop for named vehicles or for all", async () => {
    const { source, requests } = setUp(() => json({ accepted: true, rule: null, reason: null }));
    await source.orders.releaseStop(["A"]);
    await source.orders.releaseStop(null);
    expect(requests.map(({ url }) => new URL(url).pathname)).toEqual([
      "/api/all-stop/release",
      "/api/all-stop/release",
    ]);
    const bodies = await Promise.all(posted(requests).map((request) => request.json()));
    expect(bodies).toEqual([{ serials: ["A"] }, { serials: null }]);
  });

  it("admits or refuses the app of a link", async () => {
    const { source, requests } = setUp(() => json({ accepted: true, rule: null, reason: null }));
    await source.station.admitApp(7, "A", "session");
    await source.station.refuseApp(7);
    const bodies = await Promise.all(posted(requests).map((request) => request.json()));
    expect(requests.map(({ url }) => new URL(url).pathname)).toEqual([
      "/api/apps/admit",
      "/api/apps/refuse",
    ]);
    expect(bodies).toEqual([
      { link_id: 7, serial: "A", lasting: "session", any_address: false },
      { link_id: 7 },
    ]);
  });

  it("encodes the serial in requests about one vehicle", async () => {
    const response = { accepted: false, rule: "stale", reason: "no telemetry" };
    const { source, requests } = setUp(() => json(response));
    expect(await source.vehicles.setAuthority("..", "operator")).toEqual({
      kind: "answered",
      value: response,
    });
    await source.vehicles.overridePreflight("a/b", "test flight");
    const addresses = requests.map(({ url }) => new URL(url));
    expect(addresses.map(({ pathname }) => pathname)).toEqual([
      "/api/vehicle/authority",
      "/api/vehicle/preflight/override",
    ]);
    expect(addresses.map((url) => url.searchParams.get("serial"))).toEqual(["..", "a/b"]);
    expect(await requests[1]?.json()).toEqual({ reason: "test flight" });
  });

  it("reports why a hazard area was not cleared", async () => {
    const { source } = setUp(() => json({ error: "'A' is connected" }, 404));
    expect(await source.vehicles.dismissHazard("A")).toEqual({
      kind: "failed",
      problem: "'A' is connected",
    });
  });

  it("sends orders to the named vehicles and never allows takeoff", async () => {
    const { source, requests } = setUp(() => json({ results: [] }));
    await source.orders.send({ serials: ["A", "B"], order: { kind: "land" } });
    const [request] = requests;
    expect(new URL(request?.url ?? "").pathname).toBe("/api/orders");
    expect(await request?.json()).toEqual({
      serials: ["A", "B"],
      order: { kind: "land" },
      takeoff: false,
      given_at_unix_ms: null,
    });
  });

  it("returns the results per vehicle", async () => {
    const result = {
      serial: "A",
      link_id: 1,
      vehicle_name: "Alder",
      accepted: false,
      command_id: 3,
      rule: "flying",
      reason: "on the ground",
    };
    const { source } = setUp(() => json({ results: [result] }));
    expect(await source.orders.allStop()).toEqual({ kind: "answered", value: [result] });
  });

  it("returns the station's error text", async () => {
    const { source } = setUp(() => json({ error: "no alarm 9" }, 404));
    expect(await source.station.acknowledge(9)).toEqual({ kind: "failed", problem: "no alarm 9" });
  });

  it("tells the operator what to do when the station is unreachable", async () => {
    const { source } = setUp(() => Promise.reject(new TypeError("fetch failed")));
    const outcome = await source.orders.send({ serials: ["A"], order: { kind: "hover" } });
    expect(outcome).toMatchObject({
      kind: "failed",
      problem: expect.stringContaining("remote controllers"),
    });
  });

  it.each<[request: string, send: (source: LiveSource) => Promise<unknown>, ifLate: string]>([
    ["an order", (one) => one.orders.send(HOVER), "may still have arrived: check the command list"],
    [
      "an all stop",
      (one) => one.orders.allStop(),
      "may still have arrived: check the command list",
    ],
    ["a check of an order", (one) => one.orders.check(HOVER), "Try again"],
    ["a zone", (one) => one.station.drawZone(ZONE), "may still have taken effect"],
    ["a survey's start", (one) => one.surveys.start(1, [], false), "may still have taken effect"],
    ["a survey's plan", (one) => one.surveys.plan(SURVEY), "No drone moves"],
    ["a picture", (one) => one.light.groundImage(1), "Try again"],
    ["the timeline", (one) => one.station.timeline(ALL, 50), "Try again"],
    ["a flight's figures", (one) => one.flights.figures("a"), "recon export"],
    ["a flight's file", (one) => one.flights.file("a", "sun.tif"), "recon export"],
    ["the site", (one) => one.site.drawing(), "Nothing was saved"],
    ["a check of the site", (one) => one.site.check(DRAWING), "Nothing was saved"],
    ["a file to import", (one) => one.site.readFile(new File([], "a.kml")), "Nothing was saved"],
    ["the site's save", (one) => one.site.save(DRAWING), "whether it was saved"],
    ["the site's undo", (one) => one.site.undo("r1"), "whether it was saved"],
  ])("states how long it waited for %s, and what to do", async (_, send, ifLate) => {
    const limit = vi.spyOn(AbortSignal, "timeout");
    const late = new DOMException("signal timed out", "TimeoutError");
    const outcome = await send(setUp(() => Promise.reject(late)).source);
    const waited_s = Number(limit.mock.lastCall?.[0]) / 1000;
    limit.mockRestore();
    expect(outcome).toMatchObject({
      problem: expect.stringMatching(`did not answer within ${waited_s} s\\. .*${ifLate}`),
    });
  });

  it("asks for the token when access is denied", async () => {
    const { source } = setUp(() => json({ error: "a token is needed" }, 401));
    expect(await source.orders.allStop()).toMatchObject({
      problem: expect.stringContaining("token"),
    });
  });

  it("returns the actual frame number of a picture", async () => {
    const { source, requests } = setUp(
      () => new Response("png", { headers: { "X-Frame-Id": "8" } }),
    );
    const outcome = await source.vehicles.frame("a/b ?", 7);
    expect(outcome).toMatchObject({ kind: "answered", value: { frameId: 8 } });
    expect(requests[0]?.url).toContain("/api/vehicle/frame.jpg?serial=a%2Fb%20%3F&id=7");
  });

  describe("with a guard beside the station", () => {
    const guardUrl = "http://127.0.0.1:8081/all-stop";

    function withGuard(answer: Answer) {
      const page = setUp(answer);
      const state = station([vehicle(1)]);
      page.sockets[0]?.deliver({
        ...state,
        station: { ...state.station, guard_stop_url: guardUrl },
      });
      return page;
    }

    it("asks the guard when the station does not answer an all stop", async () => {
      const { clock, source, requests } = withGuard((request) =>
        request.url === guardUrl
          ? json({ held: ["Drone 1"], refused: ["Drone 2"] })
          : new Promise<Response>(() => {}),
      );
      const stopped = source.orders.allStop();
      clock.advance(1_000);
      expect(await stopped).toMatchObject({
        kind: "answered",
        value: [
          { vehicle_name: "Drone 1", accepted: true },
          { vehicle_name: "Drone 2", accepted: false, rule: "flying" },
        ],
      });
      expect(posted(requests).map(({ url }) => url)).toEqual([
        "http://127.0.0.1:8080/api/all-stop",
        guardUrl,
      ]);
    });

    it("asks it at once when the station cannot be reached", async () => {
      const { source } = withGuard((request) => {
        if (request.url !== guardUrl) throw new TypeError("connection refused");
        return json({ held: ["Drone 1"], refused: [] });
      });
      expect(await source.orders.allStop()).toMatchObject({ value: [{ vehicle_name: "Drone 1" }] });
    });

    it("leaves it alone when the station answers", async () => {
      const { clock, source, requests } = withGuard(() => json({ results: [] }));
      expect(await source.orders.allStop()).toEqual({ kind: "answered", value: [] });
      clock.advance(5_000);
      expect(posted(requests).map(({ url }) => url)).not.toContain(guardUrl);
    });

    it("gives the station's reason when neither answers", async () => {
      const { source } = withGuard(() => {
        throw new TypeError("connection refused");
      });
      expect(await source.orders.allStop()).toMatchObject({ kind: "failed" });
    });
  });
});
