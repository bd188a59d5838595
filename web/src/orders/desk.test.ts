import { describe, expect, it } from "vitest";
import type { OrderResult } from "../protocol";
import type { NamedOrder, Outcome } from "../source/stationSource";
import { vehicle } from "../testing/world";
import { createDesk } from "./desk";
import { targetsKey, targetsOf } from "./targets";

type Results = Outcome<readonly OrderResult[]>;

function setUp() {
  const given: NamedOrder[] = [];
  const answers: ((outcome: Results) => void)[] = [];
  const wait = () => new Promise<Results>((resolve) => answers.push(resolve));
  const desk = createDesk({
    order: (order) => {
      given.push(order);
      return wait();
    },
    allStop: wait,
  });
  return { desk, given, answers };
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
