import { describe, expect, it } from "vitest";
import type { StationState } from "../protocol";
import { appFacts, station, vehicle } from "../testing/fakeState";
import { changedState } from "./stateChange";

const base = station([vehicle(1, { app_facts: appFacts({ rtk: "fixed" }) }), vehicle(2)], {
  time_ns: 5_000_000_000,
});
const [first, second] = base.vehicles;

/** The base 250 ms later, with a change. */
function after(state: unknown, timeNs = 5_250_000_000): StationState {
  const change = { since: base.time_ns, time_ns: timeNs, state };
  return changedState(base, change) as StationState;
}

const inFirst = (change: object) => after({ vehicles: { "#": { "0": change } } }).vehicles[0];

describe("a change of a state", () => {
  it("lets ages grow by whole milliseconds, and nothing else change", () => {
    const state = after({});
    expect(state.time_ns).toBe(5_250_000_000);
    expect(state.site).toBe(base.site);
    expect(state.vehicles[0]?.app_facts).toBe(first?.app_facts);
    expect(state.vehicles[0]?.track).toBe(first?.track);
    const was = first?.position.age_s ?? Number.NaN;
    expect(state.vehicles[0]?.position).toEqual({ ...first?.position, age_s: was + 0.25 });
    expect(after({}, 5_000_900_000).vehicles[0]).toBe(first);
  });

  it("replaces values by others, objects by members", () => {
    const changed = inFirst({ name: "Bee", velocity_ned: { north_mps: 3 }, app_facts: null });
    expect(changed?.name).toBe("Bee");
    expect(changed?.velocity_ned.north_mps).toBe(3);
    expect(changed?.velocity_ned.east_mps).toBe(first?.velocity_ned.east_mps);
    expect(changed?.app_facts).toBeNull();
    const facts = appFacts({ rtk: "float" });
    expect(inFirst({ app_facts: { "=": facts } })?.app_facts).toEqual(facts);
  });

  it("renews the ages of one item at once, and those that are given", () => {
    const wasMs = Math.round((first?.position.age_s ?? 0) * 1e3);
    const changed = inFirst({ "@": [[wasMs, 7]], attitude: { age_s: 0.5 } });
    expect(changed?.position.age_s).toBe(0.007);
    expect(changed?.attitude.age_s).toBe(0.5);
    const other = after({ vehicles: { "#": { "0": { "@": [[wasMs, 7]] } } } }).vehicles[1];
    expect(other?.position.age_s).toBeCloseTo((second?.position.age_s ?? 0) + 0.25, 9);
  });

  it("keeps the end of an array, and takes whole ones", () => {
    expect(inFirst({ track: { "+": [2, [9, 9]] } })?.track).toEqual([
      ...(first?.track.slice(-2) ?? []),
      [9, 9],
    ]);
    expect(after({ vehicles: [second] }).vehicles).toEqual([second]);
  });

  it("is none of another state, nor of what is no object", () => {
    expect(changedState(base, { since: 1, time_ns: 2, state: {} })).toBeNull();
    expect(changedState(base, { since: base.time_ns, time_ns: 6e9, state: [1] })).toBeNull();
  });
});
