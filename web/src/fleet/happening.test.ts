import { expect, it } from "vitest";
import type { StationState } from "../protocol";
import { shadeLine, survey } from "../testing/fakeField";
import { station, vehicle } from "../testing/fakeState";
import { formatMinuteOfDay } from "../text/replay";
import { happening } from "./happening";

const GROUNDED = { is_flying: { value: false, age_s: 0 } };
const field = (changes: Partial<StationState>) =>
  happening(station([vehicle(1), vehicle(2)], changes), 0);
const forecast = (sun_share: number[], predicted_share: number[]) => {
  const line = shadeLine();
  const lead_s = [0, 60, 120];
  return {
    ...line,
    forecast: line.forecast && { ...line.forecast, lead_s, sun_share, predicted_share },
  };
};

it("names who flies, and when more sun comes", () => {
  const surveys = [survey(7)];
  const at = formatMinuteOfDay(1e3 + 60_000);
  expect(field({ surveys, shade: forecast([0.3, 0.6, 0.9], [1, 0.8, 0.2]) })).toBe(
    `Alder flies rows, sunlit ones first; more of the field has sun at ${at}.`,
  );
  expect(field({ surveys, shade: forecast([0.6, 0.62, 0.6], [1, 1, 1]) })).toBe(
    "Alder flies rows, sunlit ones first.",
  );
  expect(field({ surveys })).toBe("Alder flies rows; the light is not known yet.");
  expect(field({ surveys: [survey(7, { planner: "lawnmower_once" })] })).toBe("Alder flies rows.");
});

it("tells why nobody flies, and that a survey is paused", () => {
  const vehicles = survey(7).vehicles.map((one) => ({ ...one, is_flying_rows: false }));
  const [first] = vehicles;
  const decision = "waits: no sun is expected on its rows for 5 min";
  const waiting = first === undefined ? [] : [{ ...first, decision }];
  expect(field({ surveys: [survey(7, { vehicles: waiting })] })).toBe(`Alder ${decision}.`);
  expect(field({ surveys: [survey(7, { phase: "paused" })] })).toBe("The survey is paused.");
});

it("tells of the end, and that a demonstration goes on", () => {
  const surveys = [survey(7, { phase: "done" })];
  expect(field({ surveys })).toBe("The survey is complete. Alder and Birch are still flying.");
  const landed = station([vehicle(1, GROUNDED)], { surveys });
  expect(happening(landed, 0)).toBe("The survey is complete.");
  const demo = { ...landed, station: { ...landed.station, repeats_surveys: true } };
  expect(happening(demo, 0)).toBe(
    "The survey is complete. Another one begins when all batteries are good.",
  );
  expect(field({ surveys: [] })).toBeNull();
});
