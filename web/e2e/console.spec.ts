import { expect, test } from "@playwright/test";
import type { ShadeLineView } from "../src/protocol";
import { baseMap, shadeLine } from "../src/testing/fakeField";
import { station, vehicle } from "../src/testing/fakeState";
import { fullState } from "../src/testing/fullState";
import { busyState } from "./fake/busyState";
import { fleetState } from "./fake/fleetState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { drawnShare } from "./mapPicture";
import { openPanel } from "./openPanel";
import { inEachTheme } from "./themes";

/** Widths from a phone to a wall display, pixels. */
const WIDTHS = [360, 480, 600, 700, 800, 1024, 1099, 1100, 1440, 2560];

test("is legible at every width in each theme", async ({ page }) => {
  await FakeStation.behind(page, busyState(0));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(5);
  await page.keyboard.press("1");
  await page.locator(".status-button").click();
  await inEachTheme(page, async (theme) => {
    for (const width of [1440, 800, 360]) {
      await page.setViewportSize({ width, height: 1000 });
      const where = `${theme.name}, ${width} px wide`;
      expect(await smallTexts(page), where).toEqual([]);
      expect(await smallTargets(page), where).toEqual([]);
      expect(await faintTexts(page), where).toEqual([]);
      const overflow = await page.evaluate(
        () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
      );
      expect(overflow, where).toBeLessThanOrEqual(0);
      const cut = await page
        .locator(".vehicle-doing")
        .evaluateAll((all) => all.filter((one) => one.scrollWidth > one.clientWidth).length);
      expect(cut, where).toBe(0);
    }
  });
});

test("keeps all stop in the upper right corner at every width in each theme", async ({ page }) => {
  await FakeStation.behind(page, busyState(0));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(5);
  // High contrast has wider letters and lines; the dark theme has the light one's.
  await inEachTheme(
    page,
    async (theme) => {
      for (const width of WIDTHS) {
        await page.setViewportSize({ width, height: 900 });
        const where = `${theme.name}, ${width} px wide`;
        expect(await cornerFaults(page), where).toEqual([]);
        expect(await overlaps(page, "header button, header .tag"), where).toEqual([]);
        expect(await overlaps(page, ".orders button"), where).toEqual([]);
        expect(await smallTargets(page), where).toEqual([]);
      }
    },
    ["light", "sun"],
  );
});

test("gives the whole window to the map at every width, and nothing scrolls", async ({ page }) => {
  await FakeStation.behind(page, busyState(0));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(5);
  await page.keyboard.press("1");
  for (const width of [360, 700, 1024, 2560]) {
    await page.setViewportSize({ width, height: 840 });
    const map = await page.locator(".map-canvas").boundingBox();
    expect(map, `${width} px wide`).toEqual({ x: 0, y: 0, width, height: 840 });
    const scrolled = await page.evaluate(() => {
      const whole = document.querySelector(".page");
      return [whole, document.documentElement].map((one) => (one?.scrollHeight ?? 0) - 840);
    });
    expect(Math.max(...scrolled), `${width} px wide`).toBeLessThanOrEqual(0);
    const hover = page.getByRole("button", { name: /^Hover: 1 Alder/ });
    await expect(hover, `${width} px wide`).toBeInViewport({ ratio: 1 });
    // A middle that nothing covers is left for the map.
    const free = await page.locator(".map-free").boundingBox();
    expect(free?.height ?? 0, `${width} px wide`).toBeGreaterThan(300);
  }
});

test("the times under the forecast leave each other free at every width", async ({ page }) => {
  const lead_s = [0, 15, 30, 45, ...Array.from({ length: 19 }, (_, index) => 60 + 30 * index)];
  const { forecast, ...light } = shadeLine();
  const share = lead_s.map(() => 0.5);
  const tenMinutes = { ...forecast, lead_s, sun_share: share, predicted_share: share };
  const shown = { ...light, forecast: tenMinutes } as ShadeLineView;
  const drones = [vehicle(1), vehicle(2)];
  const fake = await FakeStation.behind(page, station(drones));
  await page.goto("/");
  const places = async () =>
    JSON.stringify(
      await page
        .locator("button.craft")
        .evaluateAll((all) => all.map((one) => one.style.transform)),
    );
  await expect(page.locator("button.craft")).toHaveCount(2);
  await openPanel(page, "Orders");
  await test.step("the view is fitted again when they first take room", async () => {
    const before = await places();
    fake.send(station(drones, { shade: shown }));
    await expect.poll(places).not.toBe(before);
  });
  for (const width of WIDTHS) {
    await page.setViewportSize({ width, height: 900 });
    const ticks = page.locator(".time-ticks span:visible");
    expect(await ticks.count(), `${width} px wide`).toBeGreaterThanOrEqual(4);
    expect(await overlaps(page, ".time-ticks span"), `${width} px wide`).toEqual([]);
  }
});

test("the parts of the bar leave each other free at every width", async ({ page }) => {
  const fake = await FakeStation.behind(page, fullState());
  await page.goto("/");
  await page.keyboard.press("t");
  for (const width of [...WIDTHS, 1200, 1399, 1400]) {
    await page.setViewportSize({ width, height: 800 });
    fake.send(fullState());
    await expect(page.getByTestId("status-count")).toHaveText("1 of 6");
    const parts = ".bar-title, .bar-place > *, .bar-shadows, .bar button";
    const wrong = await overlaps(page, parts);
    expect(wrong, `${width} px`).toEqual([]);
  }
});

test("the tools and notes of a low map leave each other free", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 460 });
  const fake = await FakeStation.behind(page, busyState(0));
  const source = { title: "orthophoto 2025", attribution: "© State survey office" };
  fake.maps = { maps: [baseMap(source)], note: "" };
  await page.goto("/");
  await openPanel(page, "Survey");
  await expect(page.getByText("Map: orthophoto 2025, © State")).toBeVisible();
  expect(await overlaps(page, ".map-notes > *, .map-tools button")).toEqual([]);
});

test("on a phone in landscape panels leave map tools and orders free", async ({ page }) => {
  await FakeStation.behind(page, fullState());
  await page.goto("/");
  await expect(page.locator("button.craft").first()).toBeVisible();
  await page.keyboard.press("1");
  await openPanel(page, "Survey");
  for (const [width, height] of [
    [740, 360],
    [844, 390],
    [932, 430],
  ] as const) {
    await page.setViewportSize({ width, height });
    const where = `${width} x ${height} px`;
    expect(await cornerFaults(page), where).toEqual([]);
    const parts = "header.bar, .map-tools button, .dock-right, .order-hover";
    expect(await overlaps(page, parts), where).toEqual([]);
    await expect(page.locator(".order-hover"), where).toBeInViewport({ ratio: 1 });
  }
});

test("an answer neither moves nor shrinks the map", async ({ page }) => {
  const fake = await FakeStation.behind(page, fleetState(20, 0));
  fake.stopsAll = true;
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(20);
  const places = () =>
    Promise.all([
      page.locator(".map-canvas").boundingBox(),
      page.locator(".map-free").boundingBox(),
      page.locator("button.craft").first().boundingBox(),
    ]);
  const before = await places();
  await page.keyboard.press("Shift+S");
  await expect(page.getByText("All stop: 0 of 18 holding")).toBeVisible();
  expect(await places()).toEqual(before);
  const toast = await page.locator(".toast").boundingBox();
  expect(toast?.height ?? 999).toBeLessThan(80);
  await page.getByRole("button", { name: "Names" }).click();
  await expect(page.getByText("On the ground: Drone 8 and Drone 16")).toBeVisible();
  expect(await places()).toEqual(before);
});

test("draws a plain map, and the ground image if available", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByText("No ground image yet")).toBeVisible();
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.001);
  expect(await drawnShare(page)).toBeLessThan(0.1);
  fake.showPicture(await fieldPicture(page));
  fake.send(busyState(0.1));
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.1);
});

test("shows a lost connection while it lasts, and recovers", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByTestId("status-label")).toHaveText("Flying");
  await fake.goOffline();
  await expect(page.getByText("No connection to the station.")).toBeVisible();
  await expect(page.getByTestId("status-label")).toHaveText("Station lost");
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
  await page.getByRole("checkbox", { name: "Add 2 Birch to the selection" }).press("Space");
  await page.getByRole("checkbox", { name: "Add 3 Cedar to the selection" }).press("Space");
  const land = page.getByRole("button", { name: "Land, hold 1.5 s: 2 Birch and 3 Cedar" });
  await land.click();
  await expect(page.getByText("2 Birch and 3 Cedar selected")).toBeVisible();
  expect(fake.orders).toEqual([]);
  await land.focus();
  await page.keyboard.down("Enter");
  await expect(page.getByText("Land: 0 of 2 landing")).toBeVisible();
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
  await expect(page.getByText("ALL STOP: all flying vehicles hold position")).toBeInViewport();
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
  await expect(page.locator(".vehicle-name")).toHaveText(name);
  expect(await page.evaluate(() => "broken" in window)).toBe(false);
  await expect(page.locator("img")).toHaveCount(0);
});
