import { describe, expect, it } from "vitest";
import type { Connection, StationState } from "../protocol";
import { FakeClock } from "../testing/fakeClock";
import { FakeSocket } from "../testing/fakeSocket";
import { station, vehicle } from "../testing/fakeState";
import { OPENING_MS, RECONNECT_DELAYS_MS, readState, SILENCE_MS, Stream } from "./stream";

function setUp() {
  const clock = new FakeClock();
  const sockets: FakeSocket[] = [];
  const connections: Connection[] = [];
  const states: { state: StationState; isFirst: boolean }[] = [];
  const open = () => {
    const socket = new FakeSocket();
    sockets.push(socket);
    return socket;
  };
  const stream = new Stream(open, clock, {
    onState: (state, isFirst) => states.push({ state, isFirst }),
    onConnection: (connection) => connections.push(connection),
  });
  const newest = () => {
    const socket = sockets.at(-1);
    if (socket === undefined) throw new Error("no socket was opened");
    return socket;
  };
  return { clock, sockets, connections, states, stream, newest };
}

describe("the stream", () => {
  it("hands out states and marks the first of each connection", () => {
    const { stream, newest, states, connections, clock } = setUp();
    stream.open();
    newest().accept();
    newest().deliver(station([]));
    newest().deliver(station([]));
    newest().fail();
    clock.advance(RECONNECT_DELAYS_MS[0]);
    newest().deliver(station([]));
    expect(states.map(({ isFirst }) => isFirst)).toEqual([true, false, true]);
    expect(connections.map(({ kind }) => kind)).toEqual(["connecting", "live", "lost", "live"]);
  });

  it("puts changes on the state before, and reconnects at one of another state", () => {
    const { stream, newest, states, connections } = setUp();
    stream.open();
    newest().accept();
    newest().deliver(station([vehicle(1), vehicle(2)], { time_ns: 1 }));
    const named = { vehicles: { "#": { "1": { name: "Bee" } } } };
    newest().deliver({ since: 1, time_ns: 2, state: named } as never);
    expect(states[1]?.state.vehicles.map(({ name }) => name)).toEqual([vehicle(1).name, "Bee"]);
    expect(states[1]?.state.time_ns).toBe(2);
    newest().deliver({ since: 8, time_ns: 9, state: {} } as never);
    expect(states).toHaveLength(2);
    expect(connections.at(-1)?.kind).toBe("lost");
  });

  it("begins each connection with a whole state", () => {
    const { stream, newest, states, clock, connections } = setUp();
    stream.open();
    newest().deliver(station([], { time_ns: 1 }));
    newest().fail();
    clock.advance(RECONNECT_DELAYS_MS[0]);
    newest().deliver({ since: 1, time_ns: 2, state: {} } as never);
    expect(states).toHaveLength(1);
    expect(connections.at(-1)?.kind).toBe("lost");
  });

  it("sends keepalives while it receives states, and none without", () => {
    const { stream, newest, clock } = setUp();
    stream.open();
    newest().accept();
    for (let message = 0; message < 20; message += 1) {
      newest().deliver(station([]));
      clock.advance(100);
    }
    expect(newest().sent).toHaveLength(5);
    clock.advance(1500);
    expect(newest().sent).toHaveLength(5);
  });

  it("waits longer after each failure, up to a limit, and starts over after a success", () => {
    const { stream, newest, sockets, clock } = setUp();
    stream.open();
    for (const delay_ms of [...RECONNECT_DELAYS_MS, RECONNECT_DELAYS_MS.at(-1) ?? 0]) {
      const before = sockets.length;
      newest().fail();
      clock.advance(delay_ms - 1);
      expect(sockets.length).toBe(before);
      clock.advance(1);
      expect(sockets.length).toBe(before + 1);
    }
    newest().deliver(station([]));
    const before = sockets.length;
    newest().fail();
    clock.advance(RECONNECT_DELAYS_MS[0]);
    expect(sockets.length).toBe(before + 1);
  });

  it("treats silence as a lost connection although the socket is open", () => {
    const { stream, newest, sockets, connections, clock } = setUp();
    stream.open();
    newest().accept();
    newest().deliver(station([]));
    clock.advance(SILENCE_MS - 1);
    expect(connections.at(-1)?.kind).toBe("live");
    clock.advance(1);
    expect(connections.at(-1)?.kind).toBe("lost");
    expect(sockets[0]?.isClosed).toBe(true);
  });

  it("ends an attempt that neither opens nor fails", () => {
    const { stream, sockets, clock } = setUp();
    stream.open();
    clock.advance(OPENING_MS + RECONNECT_DELAYS_MS[0]);
    expect(sockets).toHaveLength(2);
    expect(sockets[0]?.isClosed).toBe(true);
  });

  it("ignores a socket it has closed", () => {
    const { stream, newest, states, clock } = setUp();
    stream.open();
    const old = newest();
    clock.advance(OPENING_MS);
    old.deliver(station([]));
    expect(states).toHaveLength(0);
  });

  it("reports the station's reason", () => {
    const { stream, newest, connections } = setUp();
    stream.open();
    newest().fail(1013, "32 readers are connected already");
    expect(connections.at(-1)).toMatchObject({
      reason: "Stream closed by the station: 32 readers are connected already",
    });
  });

  it("waits for a login when the station wants a token", () => {
    const { stream, newest, connections, clock } = setUp();
    stream.open();
    newest().fail(4401, "token wrong: it was renewed");
    expect(connections.at(-1)).toMatchObject({
      kind: "lost",
      reason: "Token wrong: it was renewed",
      needsLogin: true,
    });
    expect(clock.pending).toBe(0);
  });

  it("treats unreadable data as a lost connection", () => {
    const { stream, newest, connections } = setUp();
    stream.open();
    newest().deliverText("<html>");
    expect(connections.at(-1)).toMatchObject({ kind: "lost", attempt: 1 });
  });

  it("reports a socket that cannot be created", () => {
    const clock = new FakeClock();
    const connections: Connection[] = [];
    const open = () => {
      throw new DOMException("invalid subprotocol", "SyntaxError");
    };
    const listener = { onState: () => {}, onConnection: (c: Connection) => connections.push(c) };
    new Stream(open, clock, listener).open();
    expect(connections.at(-1)).toMatchObject({ kind: "lost" });
    expect(clock.pending).toBe(1);
  });

  it("leaves no timer running after close", () => {
    const { stream, newest, clock } = setUp();
    stream.open();
    newest().accept();
    stream.close();
    expect(newest().isClosed).toBe(true);
    expect(clock.pending).toBe(0);
  });
});

describe("reading a state", () => {
  it.each(["", "null", "[]", '"text"', '{"time_ns":1}', '{"vehicles":[]}', "{"])(
    "refuses %j",
    (text) => expect(readState(text)).toBeNull(),
  );

  it("refuses bytes", () => expect(readState(new ArrayBuffer(4))).toBeNull());

  it("accepts a complete state", () => {
    expect(readState(JSON.stringify(station([])))?.vehicles).toEqual([]);
  });
});
