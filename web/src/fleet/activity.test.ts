import { describe, expect, it } from "vitest";
import { survey } from "../testing/fakeField";
import { vehicle } from "../testing/fakeState";
import { doing, surveyPart } from "./activity";

const still = { north_mps: 0.2, east_mps: 0.1, down_mps: 0, age_s: 0.1 };

describe("what a vehicle is doing", () => {
  it.each([
    ["Flying · 45\u00a0m\u00a0ATO · 4\u00a0m/s", {}],
    ["Holding · 45\u00a0m\u00a0ATO", { velocity_ned: still }],
    ["All stop · 45\u00a0m\u00a0ATO", { is_stopped: true, velocity_ned: still }],
    ["On the ground", { is_flying: { value: false, age_s: 0.1 } }],
    ["On the ground · all stop", { is_flying: { value: false, age_s: 0.1 }, is_stopped: true }],
    [
      "Landing · 45\u00a0m\u00a0ATO · 4\u00a0m/s",
      { flight_mode: { value: "auto_landing", age_s: 0.1 } },
    ],
    ["Contact lost · 6.0 s", { staleness: "lost", telemetry_age_s: 6 }],
    ["Flight state unknown", { is_flying: { value: null, age_s: 0.1 } }],
    ["Waiting for serial number", { serial: null }],
  ] as const)("is %j", (text, changes) => {
    expect(doing(vehicle(1, changes), null, 0)).toBe(text);
  });

  it("may take off while it stands, with the permission to", () => {
    const running = survey(1, { phase: "running" });
    const [first, ...others] = running.vehicles;
    if (first === undefined) throw new Error("expected a vehicle");
    const vehicles = [{ ...first, takes_off_automatically: true }, ...others];
    const part = surveyPart([{ ...running, vehicles }], "SN-001");
    const onGround = vehicle(1, { is_flying: { value: false, age_s: 0.1 } });
    expect(doing(onGround, part, 0)).toBe("On the ground · may take off");
    expect(doing({ ...onGround, is_stopped: true }, part, 0)).toBe("On the ground · all stop");
  });

  it("is surveying while it flies rows of a survey that runs", () => {
    const part = surveyPart([survey(1, { phase: "running" })], "SN-001");
    expect(doing(vehicle(1), part, 0)).toContain("Surveying · ");
    const over = surveyPart([survey(1, { phase: "done" })], "SN-001");
    expect(doing(vehicle(1), over, 0)).toContain("Flying · ");
  });
});
