import { expect, test } from "@playwright/test";
import type { StationState } from "../src/protocol";
import { station, vehicle, zone } from "../src/testing/fakeState";
import { FakeStation } from "./fake/station";
import { faintTexts, smallTargets } from "./legibility";
import { inEachTheme } from "./themes";

function zoned(elapsed_s: number): StationState {
  const zones = [
    zone(1, [50, 40]),
    zone(2, [-70, -40], { kind: "crewed_aircraft", ceiling_m: null, ends_in_s: 480, age_s: 20 }),
  ];
  return station([vehicle(1), vehicle(2)], {
    time_ns: 1e9 * (1 + elapsed_s),
    temporary_zones: zones,
  });
}

test("a zone is drawn with the keyboard alone", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(1);
  await page.keyboard.press("z");
  await page.getByRole("button", { name: "Use map centre" }).press("Enter");
  await page.getByLabel("Reason").fill("checks a sprinkler");
  await page.keyboard.press("Enter");
  await expect.poll(() => fake.requests.length).toBe(1);
  const [path, zoneSent] = fake.requests[0] ?? ["", {}];
  expect(path).toBe("/api/zones");
  expect(zoneSent).toMatchObject({ kind: "person", reason: "checks a sprinkler" });
  expect(zoneSent).toHaveProperty("circle.radius_m", 20);
});

test("zones in force and one being drawn are legible in each theme", async ({ page }) => {
  const fake = await FakeStation.behind(page, zoned(0));
  const begin_ms = performance.now();
  const timer = setInterval(() => fake.send(zoned((performance.now() - begin_ms) / 1000)), 500);
  page.once("close", () => clearInterval(timer));
  await page.goto("/");
  await expect(page.getByText("Person 1, 2 min: keep out, up to 30 m above ground")).toBeVisible();
  await expect(page.getByText("Crewed aircraft 2, new: keep out, all heights")).toBeVisible();
  await page.keyboard.press("z");
  await page.locator(".map-canvas").click({ position: { x: 600, y: 420 } });
  await expect(page.getByRole("button", { name: "Keep clear now" })).toBeEnabled();
  await inEachTheme(page, async (theme) => {
    expect(await faintTexts(page), theme.name).toEqual([]);
    expect(await smallTargets(page), theme.name).toEqual([]);
  });
});
