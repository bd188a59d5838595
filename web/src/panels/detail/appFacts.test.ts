import { expect, it } from "vitest";
import { appFacts, vehicle } from "../../testing/fakeState";
import { appFactsOf } from "./appFacts";

it("shows nothing of a plain app", () => {
  expect(appFactsOf(vehicle(1))).toEqual([]);
});

it("shows what the app knows, with its age", () => {
  const facts = appFacts({ go_home_height_m: 60, failsafe: "hover", exposure_locked: false });
  const shown = appFactsOf(vehicle(1, { app_facts: facts, app_facts_age_s: 4 }));
  expect(shown.map(({ name, text }) => `${name}: ${text}`)).toEqual([
    "Go-home height: 60\u00a0m",
    "Controller lost: hovers",
    "Exposure: automatic",
  ]);
  expect(shown[0]?.ageS).toBe(4);
});

it("shows photos, and those without a report", () => {
  const photos = { count: 41, missing: 2 };
  expect(appFactsOf(vehicle(1, { photos })).map(({ text }) => text)).toEqual([
    "41, of which 2 without a report",
  ]);
});

it("shows the least and greatest cell, and the home point", () => {
  const facts = appFacts({
    battery_cells_v: [3.91, 3.84, 3.9],
    home_latitude_deg: 44.7,
    home_longitude_deg: -93.07,
  });
  const shown = appFactsOf(vehicle(1, { app_facts: facts })).map(({ text }) => text);
  expect(shown).toEqual(["44.70000\u00a0°, \u221293.07000\u00a0°", "3 cells, 3.84 to 3.91 V"]);
});
