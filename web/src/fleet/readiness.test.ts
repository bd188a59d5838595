import { describe, expect, it } from "vitest";
import type { Connection } from "../protocol";
import { alarm, station, vehicle } from "../testing/fakeState";
import { readiness } from "./readiness";

const LIVE: Connection = { kind: "live" };
const LOST: Connection = { kind: "lost", reason: "No data from the station", attempt: 2 };
const GROUNDED = { is_flying: { value: false, age_s: 0.1 } } as const;

describe("the readiness label", () => {
  it("is Ready when all vehicles are connected, on the ground and without problems", () => {
    const state = station([vehicle(1, GROUNDED), vehicle(2, GROUNDED)]);
    expect(readiness(state, LIVE, 0)).toEqual({
      label: "Ready",
      count: "2 of 2",
      severity: null,
      cause: null,
      reasons: [],
    });
  });

  it("is Warnings for a warning and Not ready for an error", () => {
    const warned = station([vehicle(1, GROUNDED)], { alarms: [alarm(1)] });
    expect(readiness(warned, LIVE, 0)).toMatchObject({ label: "Warnings", severity: "warning" });
    const failed = station([vehicle(1, GROUNDED)], { alarms: [alarm(1, { severity: "error" })] });
    expect(readiness(failed, LIVE, 0)).toMatchObject({ label: "Not ready", severity: "error" });
  });

  it("is Not ready without vehicles, with an instruction", () => {
    const { label, reasons } = readiness(station([]), LIVE, 0);
    expect(label).toBe("Not ready");
    expect(reasons[0]?.text).toContain("companion app");
  });

  it("is Flying or Landing while any vehicle is", () => {
    const flying = station([vehicle(1), vehicle(2, GROUNDED)]);
    expect(readiness(flying, LIVE, 0).label).toBe("Flying");
    const mode = { value: "auto_landing", age_s: 0.1 };
    const landing = station([vehicle(1), vehicle(2, { flight_mode: mode })]);
    expect(readiness(landing, LIVE, 0).label).toBe("Landing");
  });

  it("has a cause where its colour comes from something else", () => {
    const separation = alarm(1, { rule: "separation", severity: "critical" });
    const flying = station([vehicle(1)], { alarms: [alarm(2), separation] });
    expect(readiness(flying, LIVE, 0)).toMatchObject({ label: "Flying", cause: "Separation" });
    expect(readiness(station([vehicle(1)], { alarms: [alarm(2)] }), LIVE, 0).cause).toBeNull();
    const lost = station([vehicle(2, { staleness: "lost", telemetry_age_s: 4 })]);
    expect(readiness(lost, LIVE, 0).cause).toBeNull();
  });

  it("is Contact lost when a flying vehicle sends no telemetry", () => {
    const state = station([vehicle(1), vehicle(2, { staleness: "lost", telemetry_age_s: 4 })]);
    const { label, severity, reasons } = readiness(state, LIVE, 0);
    expect([label, severity]).toEqual(["Contact lost", "critical"]);
    expect(reasons[0]).toMatchObject({
      vehicleName: "Birch",
      text: "No telemetry for 4.0 s.",
    });
  });

  it("is not Contact lost for a vehicle switched off on the ground", () => {
    const off = vehicle(2, { ...GROUNDED, staleness: "silent", telemetry_age_s: 300 });
    expect(readiness(station([vehicle(1, GROUNDED), off]), LIVE, 0).label).toBe("Warnings");
  });

  it("is Station lost when the stream is lost, with the age of the last data", () => {
    const { label, reasons } = readiness(station([vehicle(1, GROUNDED)]), LOST, 7);
    expect(label).toBe("Station lost");
    expect(reasons.some(({ text }) => text.includes("7.0 s ago"))).toBe(true);
  });

  it("is Contact lost when the state is old, before the stream is lost", () => {
    expect(readiness(station([vehicle(1)]), LIVE, 3.5).label).toBe("Contact lost");
  });

  it("lists reasons worst first, with vehicle names", () => {
    const state = station([vehicle(1, { conflict_link_ids: [9] })], {
      alarms: [alarm(1), alarm(2, { severity: "critical", vehicle_name: "Cedar" })],
    });
    const { reasons } = readiness(state, LIVE, 0);
    expect(reasons.map(({ severity }) => severity)).toEqual(["critical", "error", "warning"]);
    expect(reasons.map(({ vehicleName }) => vehicleName)).toEqual(["Cedar", "Alder", "Dogwood"]);
  });

  it("shows a condition with an alarm once, without repeating the name", () => {
    const low = vehicle(4, { battery_warning: { value: "low", age_s: 0.1 } });
    const raised = alarm(1, { rule: "battery", text: "Dogwood: the battery is low" });
    const { reasons } = readiness(station([low], { alarms: [raised] }), LIVE, 0);
    expect(reasons).toEqual([
      { rule: "battery", severity: "warning", vehicleName: "Dogwood", text: "The battery is low" },
    ]);
    expect(readiness(station([low]), LIVE, 0).reasons).toHaveLength(1);
  });

  it("omits inactive alarms", () => {
    const state = station([vehicle(1, GROUNDED)], { alarms: [alarm(1, { is_active: false })] });
    expect(readiness(state, LIVE, 0).label).toBe("Ready");
  });

  it("warns of real and simulated vehicles connected together", () => {
    const state = station([vehicle(1, GROUNDED), vehicle(2, { ...GROUNDED, is_simulated: true })]);
    expect(readiness(state, LIVE, 0)).toMatchObject({ label: "Warnings", severity: "warning" });
  });

  it("is Not ready before the first state, Station lost without a connection", () => {
    expect(readiness(null, { kind: "connecting" }, 0).label).toBe("Not ready");
    expect(readiness(null, LOST, 0).label).toBe("Station lost");
  });
});
