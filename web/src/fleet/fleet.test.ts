import { createRoot } from "solid-js";
import { describe, expect, it } from "vitest";
import { vehicle } from "../testing/fakeState";
import { createSelection, selectedVehicles } from "./selection";
import { worstSeverity } from "./severity";
import {
  reachM,
  simulation,
  stalenessNow,
  stalenessOfAge,
  vehicleKey,
  vehicleStatus,
} from "./vehicleStatus";

describe("staleness", () => {
  it.each([
    [0, "live"],
    [0.99, "live"],
    [1, "late"],
    [2.99, "late"],
    [3, "lost"],
    [9.9, "lost"],
    [10, "silent"],
    [null, "silent"],
  ] as const)("of telemetry %s s old is %s", (ageS, tier) => {
    expect(stalenessOfAge(ageS)).toBe(tier);
  });

  it("gets worse as the state ages, and never better", () => {
    const live = vehicle(1, { staleness: "live", telemetry_age_s: 0.2 });
    expect(stalenessNow(live, 0)).toBe("live");
    expect(stalenessNow(live, 3)).toBe("lost");
    const silent = vehicle(1, { staleness: "silent", telemetry_age_s: 0.2 });
    expect(stalenessNow(silent, 0)).toBe("silent");
  });
});

describe("the reach of a lost vehicle", () => {
  it("grows by at most 15 m/s", () => {
    const ages = [0, 1, 2, 5, 10, 60];
    const reaches = ages.map((ageS) => reachM(ageS, 3, true));
    for (const [index, reach] of reaches.entries()) {
      const ageS = ages[index] ?? 0;
      expect(reach).toBeLessThanOrEqual(3 + 15 * ageS);
      if (index > 0) expect(reach).toBeGreaterThan(reaches[index - 1] ?? 0);
    }
  });

  it("is constant on the ground", () => {
    expect(reachM(100, 0, false)).toBe(reachM(0, 0, false));
  });
});

describe("a vehicle's status", () => {
  const flag = (value: boolean | null) => ({ value, age_s: 0.1 });
  const mode = (value: string | null) => ({ value, age_s: 0.1 });

  it.each([
    ["Flying", null, {}],
    ["On the ground", null, { is_flying: flag(false) }],
    ["Unknown", null, { is_flying: flag(null) }],
    ["Landing", null, { flight_mode: mode("auto_landing") }],
    ["Landing", null, { flight_mode: mode("CONFIRM_LANDING") }],
    ["On the ground", null, { flight_mode: mode("auto_landing"), is_flying: flag(false) }],
    ["Returning", null, { flight_mode: mode("go_home") }],
    ["Flying", "error", { conflict_link_ids: [4] }],
    ["Flying", "warning", { staleness: "late" }],
    ["Unidentified", "warning", { serial: null }],
    ["Contact lost", "critical", { staleness: "lost" }],
    ["Contact lost", "critical", { staleness: "silent", is_flying: flag(null) }],
    ["Contact lost", "warning", { staleness: "silent", is_flying: flag(false) }],
  ] as const)("%s (%s) for %j", (activity, severity, changes) => {
    const changed = vehicle(1, { ...changes, conflict_link_ids: [] });
    const conflicts = "conflict_link_ids" in changes ? [...changes.conflict_link_ids] : [];
    const one = { ...changed, conflict_link_ids: conflicts };
    expect(vehicleStatus(one, 0)).toEqual({ activity, severity });
  });
});

describe("severities", () => {
  it("have a worst one", () => {
    expect(worstSeverity([])).toBeNull();
    expect(worstSeverity(["info", "error", "warning"])).toBe("error");
  });
});

describe("simulated and real vehicles", () => {
  const real = vehicle(1);
  const simulated = vehicle(2, { is_simulated: true });

  it.each([
    [[], "none"],
    [[real], "none"],
    [[simulated], "all"],
    [[real, simulated], "mixed"],
  ] as const)("case %# is classified", (vehicles, kind) => expect(simulation(vehicles)).toBe(kind));
});

describe("the selection", () => {
  it("starts empty and changes only by the operator", () => {
    createRoot((dispose) => {
      const selection = createSelection();
      expect(selection.keys()).toEqual([]);
      selection.keep([1, 2, 3]);
      expect(selection.keys()).toEqual([]);
      dispose();
    });
  });

  it("selects one, adds, removes, and drops absent vehicles", () => {
    createRoot((dispose) => {
      const selection = createSelection();
      selection.only(2);
      selection.toggle(1);
      selection.toggle(3);
      selection.toggle(2);
      expect(selection.keys()).toEqual([1, 3]);
      selection.keep([3, 4]);
      expect(selection.keys()).toEqual([3]);
      selection.clear();
      expect(selection.keys()).toEqual([]);
      dispose();
    });
  });

  it("returns the vehicles in fleet order", () => {
    createRoot((dispose) => {
      const selection = createSelection();
      selection.all([3, 1]);
      const vehicles = [vehicle(1), vehicle(2), vehicle(3)];
      expect(selectedVehicles(vehicles, selection).map(({ number }) => number)).toEqual([1, 3]);
      dispose();
    });
  });
});

describe("a vehicle's key", () => {
  it("differs between unidentified vehicles by their links", () => {
    const keys = [
      vehicle(1),
      vehicle(2, { number: 0, link_id: 1 }),
      vehicle(3, { number: 0, link_id: 2 }),
    ].map(vehicleKey);
    expect(new Set(keys).size).toBe(3);
    expect(keys[0]).toBe(1);
  });
});
