import { expect, test } from "@playwright/test";
import { at, station, vehicle } from "../src/testing/fakeState";
import { busyState } from "./fake/busyState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { LOOKS, wear } from "./looks";
import { drawnShare } from "./mapPicture";

/** From a phone in the hand to a wall. */
const WIDTHS = [360, 480, 600, 700, 800, 1024, 1099, 1100, 1440, 2560];

for (const look of LOOKS) {
  for (const width of [1440, 800, 360]) {
    test(`is legible: ${look.name}, ${width} px wide`, async ({ page }) => {
      await page.setViewportSize({ width, height: 1000 });
      await page.emulateMedia({ colorScheme: look.colorScheme });
      await FakeStation.behind(page, busyState(0));
      await page.goto("/");
      await expect(page.locator("button.craft")).toHaveCount(5);
      await page.keyboard.press("1");
      await wear(page, look);
      await page.locator(".status-button").click();
      expect(await smallTexts(page)).toEqual([]);
      expect(await smallTargets(page)).toEqual([]);
      expect(await faintTexts(page)).toEqual([]);
      const overflow = await page.evaluate(
        () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
      );
      expect(overflow).toBeLessThanOrEqual(0);
    });
  }
}

for (const look of LOOKS) {
  test(`keeps all stop in the upper right corner at every width: ${look.name}`, async ({
    page,
  }) => {
    await page.emulateMedia({ colorScheme: look.colorScheme });
    await FakeStation.behind(page, busyState(0));
    await page.goto("/");
    await expect(page.locator("button.craft")).toHaveCount(5);
    await wear(page, look);
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
  await page.getByRole("checkbox", { name: "Select 1 Alder too" }).check();
  await page.getByRole("heading", { name: "Station" }).scrollIntoViewIfNeeded();
  expect(await page.locator(".page").evaluate((element) => element.scrollTop)).toBeGreaterThan(200);
  expect(await cornerFaults(page)).toEqual([]);
  await expect(page.getByRole("button", { name: /^Hover 1 Alder/ })).toBeInViewport({ ratio: 1 });
});

test("keeps the labels of vehicles close together apart", async ({ page }) => {
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
  const before = await places();
  for (let message = 1; message <= 10; message += 1) {
    fake.say(station(close, { time_ns: 1e9 + message * 1e8 }));
  }
  await page.evaluate(() => new Promise(requestAnimationFrame));
  expect(await places()).toEqual(before);
});

test("draws a plain map, and the ground image when there is one", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByText("No ground image yet")).toBeVisible();
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.001);
  expect(await drawnShare(page)).toBeLessThan(0.2);
  fake.showPicture(await fieldPicture(page));
  fake.say(busyState(0.1));
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.2);
});

test("says that contact is lost for as long as it is, and finds back", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  await expect(page.getByTestId("status-button")).toHaveText("Flying");
  await fake.vanish();
  await expect(page.getByText("No contact with the station.")).toBeVisible();
  await expect(page.getByTestId("status-button")).toHaveText("Communication lost");
  await expect(page.locator(".vehicle.is-stale")).toHaveCount(1);
  await expect(page.locator(".craft.is-stale")).toHaveCount(1);
  fake.comeBack();
  await expect(page.getByText("No contact with the station.")).toBeHidden();
  await expect(page.getByTestId("status-button")).toHaveText("Flying");
});

test("gives an order only to whom it names, and only when held", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1), vehicle(2), vehicle(3)]));
  const talk = setInterval(() => fake.say(station([vehicle(1), vehicle(2), vehicle(3)])), 100);
  await page.goto("/");
  await page.getByRole("checkbox", { name: "Select 2 Birch too" }).check();
  await page.getByRole("checkbox", { name: "Select 3 Cedar too" }).check();
  const land = page.getByRole("button", { name: "Land 2 Birch and 3 Cedar: hold for 1.5 seconds" });
  await land.click();
  await expect(page.getByText("Orders go to 2 Birch and 3 Cedar")).toBeVisible();
  expect(fake.orders).toEqual([]);
  await land.focus();
  await page.keyboard.down("Enter");
  await expect(page.getByText("Accepted: Birch (command 40) and Cedar (command 41)")).toBeVisible();
  await page.keyboard.up("Enter");
  clearInterval(talk);
  expect(fake.orders).toEqual([
    { serials: ["SN-002", "SN-003"], order: { kind: "land" }, takeoff: false },
  ]);
});

test("stops all with one key, even while the help is open", async ({ page }) => {
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

test("keeps hostile text harmless on the map as well", async ({ page }) => {
  const name = `<img src=x onerror="window.broken=1">`;
  await FakeStation.behind(page, station([vehicle(1, { name, serial: "../..\u0007" })]));
  await page.goto("/");
  await expect(page.locator(".craft-name")).toHaveText(name);
  expect(await page.evaluate(() => "broken" in window)).toBe(false);
  await expect(page.locator("img")).toHaveCount(0);
});
