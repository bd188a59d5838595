import { describe, expect, it } from "vitest";
import type { OrderResult } from "../protocol";
import type { NamedOrder, Outcome } from "../source/stationSource";
import { FakeClock } from "../testing/fakeClock";
import { orderResult, vehicle } from "../testing/fakeState";
import { ALL_WELL_FOR_MS, createDesk } from "./orderApi";
import { targetsKey, targetsOf } from "./targets";

const REFUSED = orderResult({
  serial: "A",
  accepted: false,
  command_id: 3,
  rule: "flying",
  reason: "it is on the ground",
});

type Results = Outcome<readonly OrderResult[]>;

function setUp() {
  const clock = new FakeClock();
  const given: NamedOrder[] = [];
  const answers: ((outcome: Results) => void)[] = [];
  const wait = () => new Promise<Results>((resolve) => answers.push(resolve));
  const desk = createDesk(
    {
      order: (order) => {
        given.push(order);
        return wait();
      },
      allStop: wait,
      fleetReturn: wait,
    },
    clock,
  );
  return { desk, given, answers, clock };
}

describe("the desk", () => {
  it("shows that it waits, then the answer", async () => {
    const { desk, answers } = setUp();
    const done = desk.order({ serials: ["A"], order: { kind: "land" } }, ["1 Alder"]);
    expect(desk.last()).toEqual({
      what: "Land",
      labels: ["1 Alder"],
      outcome: { kind: "waiting" },
    });
    answers[0]?.({ kind: "answered", value: [] });
    await done;
    expect(desk.last()?.outcome).toEqual({ kind: "answered", value: [] });
  });

  it("gives no order that names nobody", async () => {
    const { desk, given } = setUp();
    await desk.order({ serials: [], order: { kind: "land" } }, []);
    expect(given).toEqual([]);
    expect(desk.last()).toBeNull();
  });

  it("puts an answer away by itself when nothing was refused, and only then", async () => {
    const { desk, answers, clock } = setUp();
    const result = { ...REFUSED, accepted: true };
    for (const [accepted, remains] of [
      [true, false],
      [false, true],
    ] as const) {
      const done = desk.allStop();
      answers.at(-1)?.({ kind: "answered", value: [{ ...result, accepted }] });
      await done;
      clock.advance(ALL_WELL_FOR_MS);
      expect(desk.last() !== null).toBe(remains);
    }
  });

  it("keeps a late answer from standing under a newer order", async () => {
    const { desk, answers } = setUp();
    const first = desk.order({ serials: ["A"], order: { kind: "land" } }, ["1 Alder"]);
    const second = desk.allStop();
    answers[1]?.({ kind: "answered", value: [] });
    await second;
    answers[0]?.({ kind: "failed", problem: "too late" });
    await first;
    expect(desk.last()).toMatchObject({ what: "All stop", outcome: { kind: "answered" } });
    desk.dismiss();
    expect(desk.last()).toBeNull();
  });
});

describe("whom an order goes to", () => {
  it("names the selected vehicles and those it cannot reach", () => {
    const unknown = vehicle(3, { number: 0, serial: null, name: "link 7" });
    const targets = targetsOf([vehicle(1), unknown, vehicle(2)]);
    expect(targets.serials).toEqual(["SN-001", "SN-002"]);
    expect(targets.labels).toEqual(["1 Alder", "2 Birch"]);
    expect(targets.unreachable).toEqual(["? link 7"]);
  });

  it("has a key that is empty exactly when there is nobody", () => {
    expect(targetsKey(targetsOf([]))).toBe("");
    expect(targetsKey(targetsOf([vehicle(1, { serial: null })]))).toBe("");
    expect(targetsKey(targetsOf([vehicle(1)]))).not.toBe(targetsKey(targetsOf([vehicle(2)])));
  });

  it("does not take two serials for one with a comma in it", () => {
    const two = targetsOf([vehicle(1, { serial: "a" }), vehicle(2, { serial: "b" })]);
    expect(targetsKey(two)).not.toBe(targetsKey(targetsOf([vehicle(1, { serial: 'a","b' })])));
  });
});
