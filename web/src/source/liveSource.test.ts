import { describe, expect, it } from "vitest";
import { FakeClock } from "../testing/fakeClock";
import { FakeSocket } from "../testing/fakeSocket";
import { station, vehicle } from "../testing/fakeState";
import { LiveSource, tokenOf } from "./liveSource";

type Answer = (request: Request) => Response | Promise<Response>;

function setUp(answer: Answer, token: string | null = null) {
  const clock = new FakeClock();
  let drawn = 1;
  const sockets: FakeSocket[] = [];
  const requests: Request[] = [];
  const source = new LiveSource({
    origin: "http://127.0.0.1:8080",
    token,
    clock,
    random: (bytes) => bytes.fill(drawn++),
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

const json = (value: unknown, status = 200) => Response.json(value, { status });

describe("the live source", () => {
  it("shows the newest state and how far it is behind", () => {
    const { source, sockets, clock } = setUp(() => json({}));
    expect(source.state()).toBeNull();
    sockets[0]?.say(station([vehicle(1)]));
    clock.advance(400);
    expect(source.state()?.vehicles).toHaveLength(1);
    expect(source.behindS(clock.now())).toBeCloseTo(0.4);
    expect(source.connection().kind).toBe("live");
  });

  it("brings the token as a header and as a subprotocol, never in an address", async () => {
    const { source, sockets, requests } = setUp(() => new Response("png"), "s3cret-token");
    await source.groundImage(7);
    expect(sockets[0]?.protocols).toEqual(["recon.v1", "recon.token.s3cret-token"]);
    expect(requests[0]?.headers.get("Authorization")).toBe("Bearer s3cret-token");
    expect(`${sockets[0]?.url} ${requests[0]?.url}`).not.toContain("s3cret");
  });

  it("opens the stream of the address the page came from", () => {
    const { sockets } = setUp(() => json({}));
    expect(sockets[0]?.url).toBe(`ws://127.0.0.1:8080/api/stream?owner=${"01".repeat(16)}`);
    expect(sockets[0]?.protocols).toEqual(["recon.v1"]);
  });

  it("gives the station's reason when it turns the page away", async () => {
    const { source, sockets, requests } = setUp(() => json({ error: "a token is needed" }, 401));
    sockets[0]?.fail();
    expect(source.connection()).toMatchObject({ reason: "The station cannot be reached." });
    await expect
      .poll(() => source.connection())
      .toMatchObject({
        kind: "lost",
        reason: "The station refuses this page. Open it with its token.",
      });
    expect(requests.map(({ url }) => new URL(url).pathname)).toEqual(["/api/state"]);
  });

  it("names its newest stream as the owner of steered orders, and of no others", async () => {
    const { source, sockets, requests, clock } = setUp(() => json({ results: [] }));
    sockets[0]?.fail();
    clock.advance(1000);
    expect(sockets[1]?.url).toContain("02".repeat(16));
    const place = { latitude_deg: 44.7, longitude_deg: -93.07, height_above_takeoff_m: 40 };
    const goto = { kind: "goto" as const, ...place, speed_mps: 5 };
    await source.check({ serials: ["A"], order: goto });
    await source.order({ serials: ["A"], order: goto });
    await source.order({ serials: ["A"], order: { kind: "hover" } });
    const asked = requests.filter(({ url }) => url.includes("/api/orders"));
    const bodies = await Promise.all(asked.map((request) => request.json()));
    expect(asked.map(({ url }) => new URL(url).pathname)).toEqual([
      "/api/orders/check",
      "/api/orders",
      "/api/orders",
    ]);
    expect(bodies.map(({ owner }) => owner)).toEqual(["02".repeat(16), "02".repeat(16), undefined]);
  });

  it("brings words about one vehicle to the vehicle named, however it is called", async () => {
    const word = { accepted: false, rule: "stale", reason: "it is not heard" };
    const { source, requests } = setUp(() => json(word));
    expect(await source.takeAuthority("a/b", "operator")).toEqual({
      kind: "answered",
      value: word,
    });
    await source.overridePreflight("a/b", "test flight");
    const paths = requests.map(({ url }) => new URL(url).pathname);
    expect(paths).toEqual([
      "/api/vehicles/a%2Fb/authority",
      "/api/vehicles/a%2Fb/preflight/override",
    ]);
    expect(await requests[1]?.json()).toEqual({ reason: "test flight" });
  });

  it("tells why a hazard area was not dismissed", async () => {
    const { source } = setUp(() => json({ error: "'A' is heard" }, 404));
    expect(await source.dismissHazard("A")).toEqual({ kind: "failed", problem: "'A' is heard" });
  });

  it("gives orders to the vehicles named and never allows a takeoff", async () => {
    const { source, requests } = setUp(() => json({ results: [] }));
    await source.order({ serials: ["A", "B"], order: { kind: "land" } });
    const [request] = requests;
    expect(new URL(request?.url ?? "").pathname).toBe("/api/orders");
    expect(await request?.json()).toEqual({
      serials: ["A", "B"],
      order: { kind: "land" },
      takeoff: false,
    });
  });

  it("hands on the results, vehicle by vehicle", async () => {
    const result = {
      serial: "A",
      link_id: 1,
      vehicle_name: "Alder",
      accepted: false,
      command_id: 3,
      rule: "flying",
      reason: "it is on the ground",
    };
    const { source } = setUp(() => json({ results: [result] }));
    expect(await source.allStop()).toEqual({ kind: "answered", value: [result] });
  });

  it("says the station's own sentence when it refuses", async () => {
    const { source } = setUp(() => json({ error: "there is no alarm 9" }, 404));
    expect(await source.acknowledge(9)).toEqual({ kind: "failed", problem: "there is no alarm 9" });
  });

  it("says what to do when the station is not there", async () => {
    const { source } = setUp(() => Promise.reject(new TypeError("fetch failed")));
    const outcome = await source.order({ serials: ["A"], order: { kind: "hover" } });
    expect(outcome).toMatchObject({
      kind: "failed",
      problem: expect.stringContaining("remote controllers"),
    });
  });

  it("says that a late order may have been heard", async () => {
    const late = new DOMException("signal timed out", "TimeoutError");
    const { source } = setUp(() => Promise.reject(late));
    expect(await source.allStop()).toMatchObject({
      problem: expect.stringContaining("may still have heard"),
    });
  });

  it("asks for the token when it is refused", async () => {
    const { source } = setUp(() => json({ error: "a token is needed" }, 401));
    expect(await source.allStop()).toMatchObject({ problem: expect.stringContaining("token") });
  });

  it("tells which frame a picture really is", async () => {
    const { source, requests } = setUp(
      () => new Response("png", { headers: { "X-Frame-Id": "8" } }),
    );
    const outcome = await source.vehicleFrame("a/b ?", 7);
    expect(outcome).toMatchObject({ kind: "answered", value: { frameId: 8 } });
    expect(requests[0]?.url).toContain("/api/vehicles/a%2Fb%20%3F/frame.jpg?id=7");
  });
});

describe("the token in the page's address", () => {
  it.each([
    ["#token=abc", "abc"],
    ["#x=1&token=a%2Bb", "a+b"],
    ["#token=", null],
    ["", null],
    ["#other", null],
  ])("%s holds %s", (fragment, token) => expect(tokenOf(fragment)).toBe(token));
});
