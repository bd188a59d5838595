import { describe, expect, it } from "vitest";
import type { StationState } from "../protocol";
import { FakeClock } from "../testing/fakeClock";
import { FakeSocket } from "../testing/fakeSocket";
import { station } from "../testing/fakeState";
import type { Connection } from "./stationSource";
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
    newest().say(station([]));
    newest().say(station([]));
    newest().fail();
    clock.advance(RECONNECT_DELAYS_MS[0]);
    newest().say(station([]));
    expect(states.map(({ isFirst }) => isFirst)).toEqual([true, false, true]);
    expect(connections.map(({ kind }) => kind)).toEqual(["connecting", "live", "lost", "live"]);
  });

  it("says that the page lives as it shows states, and no longer when none come", () => {
    const { stream, newest, clock } = setUp();
    stream.open();
    newest().accept();
    for (let message = 0; message < 20; message += 1) {
      newest().say(station([]));
      clock.advance(100);
    }
    expect(newest().sent).toHaveLength(5);
    clock.advance(1500);
    expect(newest().sent).toHaveLength(5);
  });

  it("waits longer after each failure, up to a limit, and soon again after a success", () => {
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
    newest().say(station([]));
    const before = sockets.length;
    newest().fail();
    clock.advance(RECONNECT_DELAYS_MS[0]);
    expect(sockets.length).toBe(before + 1);
  });

  it("takes silence for a loss, though the socket looks alive", () => {
    const { stream, newest, sockets, connections, clock } = setUp();
    stream.open();
    newest().accept();
    newest().say(station([]));
    clock.advance(SILENCE_MS - 1);
    expect(connections.at(-1)?.kind).toBe("live");
    clock.advance(1);
    expect(connections.at(-1)?.kind).toBe("lost");
    expect(sockets[0]?.isClosed).toBe(true);
  });

  it("gives up an attempt that neither opens nor fails", () => {
    const { stream, sockets, clock } = setUp();
    stream.open();
    clock.advance(OPENING_MS + RECONNECT_DELAYS_MS[0]);
    expect(sockets).toHaveLength(2);
    expect(sockets[0]?.isClosed).toBe(true);
  });

  it("does not hear a socket it has let go of", () => {
    const { stream, newest, states, clock } = setUp();
    stream.open();
    const old = newest();
    clock.advance(OPENING_MS);
    old.say(station([]));
    expect(states).toHaveLength(0);
  });

  it("says the station's own reason, or what to do", () => {
    const { stream, newest, connections } = setUp();
    stream.open();
    newest().fail(1013, "32 readers are connected already");
    expect(connections.at(-1)).toMatchObject({
      reason: "The station closed the stream: 32 readers are connected already",
    });
  });

  it("counts something unreadable as a loss", () => {
    const { stream, newest, connections } = setUp();
    stream.open();
    newest().sayText("<html>");
    expect(connections.at(-1)).toMatchObject({ kind: "lost", attempt: 1 });
  });

  it("says so when a socket cannot even be made", () => {
    const clock = new FakeClock();
    const connections: Connection[] = [];
    const open = () => {
      throw new DOMException("a subprotocol has a blank", "SyntaxError");
    };
    const listener = { onState: () => {}, onConnection: (c: Connection) => connections.push(c) };
    new Stream(open, clock, listener).open();
    expect(connections.at(-1)).toMatchObject({ kind: "lost" });
    expect(clock.pending).toBe(1);
  });

  it("leaves nothing behind when it is closed", () => {
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

  it("takes a whole state", () => {
    expect(readState(JSON.stringify(station([])))?.vehicles).toEqual([]);
  });
});
