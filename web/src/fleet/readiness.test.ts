import { describe, expect, it } from "vitest";
import type { Connection } from "../source/stationSource";
import { alarm, station, vehicle } from "../testing/fakeState";
import { readiness } from "./readiness";

const LIVE: Connection = { kind: "live" };
const LOST: Connection = { kind: "lost", reason: "The station says nothing.", attempt: 2 };
const GROUNDED = { is_flying: { value: false, age_s: 0.1 } } as const;

describe("the state word", () => {
  it("is Ready when all are heard, on the ground and well", () => {
    const state = station([vehicle(1, GROUNDED), vehicle(2, GROUNDED)]);
    expect(readiness(state, LIVE, 0)).toEqual({ word: "Ready", severity: null, reasons: [] });
  });

  it("is Warnings for a warning and Not ready for an error", () => {
    const warned = station([vehicle(1, GROUNDED)], { alarms: [alarm(1)] });
    expect(readiness(warned, LIVE, 0)).toMatchObject({ word: "Warnings", severity: "warning" });
    const failed = station([vehicle(1, GROUNDED)], { alarms: [alarm(1, { severity: "error" })] });
    expect(readiness(failed, LIVE, 0)).toMatchObject({ word: "Not ready", severity: "error" });
  });

  it("is Not ready without vehicles, and says what to do", () => {
    const { word, reasons } = readiness(station([]), LIVE, 0);
    expect(word).toBe("Not ready");
    expect(reasons[0]?.text).toContain("companion app");
  });

  it("is Flying or Landing while anything does", () => {
    const flying = station([vehicle(1), vehicle(2, GROUNDED)]);
    expect(readiness(flying, LIVE, 0).word).toBe("Flying");
    const mode = { value: "auto_landing", age_s: 0.1 };
    const landing = station([vehicle(1), vehicle(2, { flight_mode: mode })]);
    expect(readiness(landing, LIVE, 0).word).toBe("Landing");
  });

  it("is Communication lost when one that flies is not heard, whatever the others do", () => {
    const state = station([vehicle(1), vehicle(2, { staleness: "lost", telemetry_age_s: 4 })]);
    const { word, severity, reasons } = readiness(state, LIVE, 0);
    expect([word, severity]).toEqual(["Communication lost", "critical"]);
    expect(reasons[0]).toMatchObject({
      vehicleName: "Birch",
      text: "No telemetry for 4.0 s.",
    });
  });

  it("is not lost for one that was switched off on the ground", () => {
    const off = vehicle(2, { ...GROUNDED, staleness: "silent", telemetry_age_s: 300 });
    expect(readiness(station([vehicle(1, GROUNDED), off]), LIVE, 0).word).toBe("Warnings");
  });

  it("is Communication lost when the stream is, with the age of the last news", () => {
    const { word, reasons } = readiness(station([vehicle(1, GROUNDED)]), LOST, 7);
    expect(word).toBe("Communication lost");
    expect(reasons.some(({ text }) => text.includes("7.0 s ago"))).toBe(true);
  });

  it("does not wait for the stream's loss when news grows old", () => {
    expect(readiness(station([vehicle(1)]), LIVE, 3.5).word).toBe("Communication lost");
  });

  it("lists the worst first, each with its vehicle's name", () => {
    const state = station([vehicle(1, { conflict_link_ids: [9] })], {
      alarms: [alarm(1), alarm(2, { severity: "critical", vehicle_name: "Cedar" })],
    });
    const { reasons } = readiness(state, LIVE, 0);
    expect(reasons.map(({ severity }) => severity)).toEqual(["critical", "error", "warning"]);
    expect(reasons.map(({ vehicleName }) => vehicleName)).toEqual(["Cedar", "Alder", "Dogwood"]);
  });

  it("says once what the station raised an alarm for, without the name twice", () => {
    const low = vehicle(4, { battery_warning: { value: "low", age_s: 0.1 } });
    const raised = alarm(1, { rule: "battery", text: "Dogwood: the battery is low" });
    const { reasons } = readiness(station([low], { alarms: [raised] }), LIVE, 0);
    expect(reasons).toEqual([
      { severity: "warning", vehicleName: "Dogwood", text: "The battery is low" },
    ]);
    expect(readiness(station([low]), LIVE, 0).reasons).toHaveLength(1);
  });

  it("leaves out alarms that ended", () => {
    const state = station([vehicle(1, GROUNDED)], { alarms: [alarm(1, { is_active: false })] });
    expect(readiness(state, LIVE, 0).word).toBe("Ready");
  });

  it("warns of real and simulated vehicles together", () => {
    const state = station([vehicle(1, GROUNDED), vehicle(2, { ...GROUNDED, is_simulated: true })]);
    expect(readiness(state, LIVE, 0)).toMatchObject({ word: "Warnings", severity: "warning" });
  });

  it("waits for the first news, and says when there is none", () => {
    expect(readiness(null, { kind: "connecting" }, 0).word).toBe("Not ready");
    expect(readiness(null, LOST, 0).word).toBe("Communication lost");
  });
});
