import { expect, test } from "@playwright/test";
import { at, station, vehicle } from "../src/testing/fakeState";
import { busyState } from "./fake/busyState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { drawnShare } from "./mapPicture";
import { applyTheme, THEMES } from "./themes";

/** Widths from a phone to a wall display, pixels. */
const WIDTHS = [360, 480, 600, 700, 800, 1024, 1099, 1100, 1440, 2560];

for (const theme of THEMES) {
  test(`is legible at every width: ${theme.name}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: theme.colorScheme });
    await FakeStation.behind(page, busyState(0));
    await page.goto("/");
    await expect(page.locator("button.craft")).toHaveCount(5);
    await page.keyboard.press("1");
    await applyTheme(page, theme);
    await page.locator(".status-button").click();
    for (const width of [1440, 800, 360]) {
      await page.setViewportSize({ width, height: 1000 });
      const where = `${width} px wide`;
      expect(await smallTexts(page), where).toEqual([]);
      expect(await smallTargets(page), where).toEqual([]);
      expect(await faintTexts(page), where).toEqual([]);
      const overflow = await page.evaluate(
        () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
      );
      expect(overflow, where).toBeLessThanOrEqual(0);
    }
  });
}

for (const theme of THEMES) {
  test(`keeps all stop in the upper right corner at every width: ${theme.name}`, async ({
    page,
  }) => {
    await page.emulateMedia({ colorScheme: theme.colorScheme });
    await FakeStation.behind(page, busyState(0));
    await page.goto("/");
    await expect(page.locator("button.craft")).toHaveCount(5);
    await applyTheme(page, theme);
    for (const width of WIDTHS) {
      await page.setViewportSize({ width, height: 900 });
      expect(await cornerFaults(page), `${width} px wide`).toEqual([]);
      expect(await overlaps(page, "header button, header .tag, header .bar-count")).toEqual([]);
      expect(await overlaps(page, ".orders button")).toEqual([]);
      expect(await smallTargets(page), `${width} px wide`).toEqual([]);
    }
  });
}

test("keeps all stop and the orders in reach while a phone's page is scrolled", async ({
  page,
}) => {
  await page.setViewportSize({ width: 360, height: 740 });
  await FakeStation.behind(page, busyState(0));
  await page.goto("/");
  await page.getByRole("checkbox", { name: "Add 1 Alder to the selection" }).check();
  await page.getByRole("heading", { name: "Station" }).scrollIntoViewIfNeeded();
  expect(await page.locator(".page").evaluate((element) => element.scrollTop)).toBeGreaterThan(200);
  expect(await cornerFaults(page)).toEqual([]);
  await expect(page.getByRole("button", { name: /^Hover 1 Alder/ })).toBeInViewport({ ratio: 1 });
});

test("keeps the labels of close vehicles apart", async ({ page }) => {
  const close = [1, 2, 3, 4].map((number) => {
    const [longitude_deg, latitude_deg] = at(4 * number, 2 * number);
    return vehicle(number, {
      position: { longitude_deg, latitude_deg, age_s: 0.1 },
      track: [],
      is_simulated: true,
    });
  });
  const fake = await FakeStation.behind(page, station(close));
  await page.goto("/");
  const labels = page.locator(".craft-label");
  await expect(labels).toHaveCount(4);
  await expect.poll(() => overlaps(page, ".craft-label")).toEqual([]);
  await expect(page.locator(".craft-label-line:visible")).not.toHaveCount(0);
  const places = () => labels.evaluateAll((all) => all.map((one) => one.style.transform));
  const frame = () => page.evaluate(() => new Promise(requestAnimationFrame));
  let second = 1;
  // A label grows by the age of old telemetry, and on a busy machine any telemetry gets old. What
  // moved labels with every message would do so in each try.
  await expect(async () => {
    fake.send(station(close, { time_ns: second * 1e9 }));
    await expect(page.locator(".craft-label.is-stale")).toHaveCount(0);
    await frame();
    const before = await places();
    for (let message = 1; message <= 10; message += 1) {
      fake.send(station(close, { time_ns: second * 1e9 + message * 1e8 }));
    }
    second += 2;
    await frame();
    expect(await places()).toEqual(before);
  }).toPass({ timeout: 20_000 });
});

test("draws a plain map, and the ground image if available", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByText("No ground image yet")).toBeVisible();
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.001);
  expect(await drawnShare(page)).toBeLessThan(0.2);
  fake.showPicture(await fieldPicture(page));
  fake.send(busyState(0.1));
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.2);
});

test("shows a lost connection while it lasts, and recovers", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByTestId("status-label")).toHaveText("Flying");
  await fake.goOffline();
  await expect(page.getByText("No connection to the station.")).toBeVisible();
  await expect(page.getByTestId("status-label")).toHaveText("Communication lost");
  await expect(page.locator(".vehicle.is-stale")).toHaveCount(1);
  await expect(page.locator(".craft.is-stale")).toHaveCount(1);
  fake.goOnline();
  await expect(page.getByText("No connection to the station.")).toBeHidden();
  await expect(page.getByTestId("status-label")).toHaveText("Flying");
});

test("sends an order only to the named vehicles, and only when held", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1), vehicle(2), vehicle(3)]));
  const timer = setInterval(() => fake.send(station([vehicle(1), vehicle(2), vehicle(3)])), 100);
  await page.goto("/");
  await page.getByRole("checkbox", { name: "Add 2 Birch to the selection" }).check();
  await page.getByRole("checkbox", { name: "Add 3 Cedar to the selection" }).check();
  const land = page.getByRole("button", { name: "Land 2 Birch and 3 Cedar: hold for 1.5 seconds" });
  await land.click();
  await expect(page.getByText("Orders go to 2 Birch and 3 Cedar")).toBeVisible();
  expect(fake.orders).toEqual([]);
  await land.focus();
  await page.keyboard.down("Enter");
  await expect(page.getByText("Accepted: Birch and Cedar")).toBeVisible();
  await page.keyboard.up("Enter");
  clearInterval(timer);
  expect(fake.orders).toEqual([
    { serials: ["SN-002", "SN-003"], order: { kind: "land" }, takeoff: false },
  ]);
});

test("stops all with one key, even with the help open", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(1);
  await page.keyboard.press("?");
  await expect(page.getByRole("dialog", { name: "Help" })).toBeVisible();
  await page.keyboard.press("Shift+S");
  await expect.poll(() => fake.allStops).toBe(1);
  await page.keyboard.press("Escape");
  await expect(page.getByRole("dialog", { name: "Help" })).toBeHidden();
  expect(fake.orders).toEqual([]);
});

test("displays hostile text on the map as text", async ({ page }) => {
  const name = `<img src=x onerror="window.broken=1">`;
  await FakeStation.behind(page, station([vehicle(1, { name, serial: "../..\u0007" })]));
  await page.goto("/");
  await expect(page.locator(".craft-name")).toHaveText(name);
  expect(await page.evaluate(() => "broken" in window)).toBe(false);
  await expect(page.locator("img")).toHaveCount(0);
});
