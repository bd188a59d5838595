import { describe, expect, it } from "vitest";
import type { NamedOrder, OrderResult, Outcome } from "../protocol";
import { FakeClock } from "../testing/fakeClock";
import { orderResult, vehicle } from "../testing/fakeState";
import { ACCEPTED_SHOWN_MS, createOrderApi } from "./orderApi";
import { targetsKey, targetsOf } from "./targets";

const REFUSED = orderResult({
  serial: "A",
  accepted: false,
  command_id: 3,
  rule: "flying",
  reason: "on the ground",
});

type Results = Outcome<readonly OrderResult[]>;

function setUp() {
  const clock = new FakeClock();
  const sent: NamedOrder[] = [];
  const answers: ((outcome: Results) => void)[] = [];
  const wait = () => new Promise<Results>((resolve) => answers.push(resolve));
  const orderApi = createOrderApi(
    {
      send: (order) => {
        sent.push(order);
        return wait();
      },
      allStop: wait,
      fleetReturn: wait,
    },
    clock,
  );
  return { orderApi, sent, answers, clock };
}

describe("the order API", () => {
  it("shows that it is waiting, then the answer", async () => {
    const { orderApi, answers } = setUp();
    const done = orderApi.order({ serials: ["A"], order: { kind: "land" } }, ["1 Alder"]);
    expect(orderApi.lastAnswer()).toEqual({
      order: "Land",
      labels: ["1 Alder"],
      outcome: { kind: "waiting" },
    });
    answers[0]?.({ kind: "answered", value: [] });
    await done;
    expect(orderApi.lastAnswer()?.outcome).toEqual({ kind: "answered", value: [] });
  });

  it("sends no order without vehicles", async () => {
    const { orderApi, sent } = setUp();
    await orderApi.order({ serials: [], order: { kind: "land" } }, []);
    expect(sent).toEqual([]);
    expect(orderApi.lastAnswer()).toBeNull();
  });

  it("hides an answer after a while only if nothing was refused", async () => {
    const { orderApi, answers, clock } = setUp();
    const result = { ...REFUSED, accepted: true };
    for (const [accepted, remains] of [
      [true, false],
      [false, true],
    ] as const) {
      const done = orderApi.allStop();
      answers.at(-1)?.({ kind: "answered", value: [{ ...result, accepted }] });
      await done;
      clock.advance(ACCEPTED_SHOWN_MS);
      expect(orderApi.lastAnswer() !== null).toBe(remains);
    }
  });

  it("does not show a late answer for a newer order", async () => {
    const { orderApi, answers } = setUp();
    const first = orderApi.order({ serials: ["A"], order: { kind: "land" } }, ["1 Alder"]);
    const second = orderApi.allStop();
    answers[1]?.({ kind: "answered", value: [] });
    await second;
    answers[0]?.({ kind: "failed", problem: "too late" });
    await first;
    expect(orderApi.lastAnswer()).toMatchObject({
      order: "All stop",
      outcome: { kind: "answered" },
    });
    orderApi.dismiss();
    expect(orderApi.lastAnswer()).toBeNull();
  });
});

describe("the targets of an order", () => {
  it("are the selected vehicles, without unidentified ones", () => {
    const unknown = vehicle(3, { number: 0, serial: null, name: "link 7" });
    const targets = targetsOf([vehicle(1), unknown, vehicle(2)]);
    expect(targets.serials).toEqual(["SN-001", "SN-002"]);
    expect(targets.labels).toEqual(["1 Alder", "2 Birch"]);
    expect(targets.unreachable).toEqual(["? link 7"]);
  });

  it("have a key that is empty only without vehicles", () => {
    expect(targetsKey(targetsOf([]))).toBe("");
    expect(targetsKey(targetsOf([vehicle(1, { serial: null })]))).toBe("");
    expect(targetsKey(targetsOf([vehicle(1)]))).not.toBe(targetsKey(targetsOf([vehicle(2)])));
  });

  it("have distinct keys for two serials and one containing a comma", () => {
    const two = targetsOf([vehicle(1, { serial: "a" }), vehicle(2, { serial: "b" })]);
    expect(targetsKey(two)).not.toBe(targetsKey(targetsOf([vehicle(1, { serial: 'a","b' })])));
  });
});
