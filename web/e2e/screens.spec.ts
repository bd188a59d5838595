import { cp, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, test } from "@playwright/test";
import type { StationState } from "../src/protocol";
import { alarm, link, station, vehicle } from "../src/testing/fakeState";
import { busyState } from "./fake/busyState";
import {
  DRAWING,
  FIT,
  FROZEN,
  HERE,
  REFUSED,
  REFUSED_VEHICLE,
  sendAges,
  VEHICLES,
} from "./fake/drawnSite";
import { fleetState } from "./fake/fleetState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { startTileServer } from "./fake/tileServer";
import { drawnShare } from "./mapPicture";
import { markOnePoint } from "./markedPoints";
import { openPanel } from "./openPanel";
import {
  DEMO_SITE,
  type RunningStation,
  runRecon,
  startReplay,
  startStation,
} from "./stationProcess";
import { applyTheme, THEMES } from "./themes";
import { visitViews } from "./views";

/** Screenshots for review: `npm run screens`, then `web/screens/`. */
const SIZES = [
  { width: 1440, height: 900 },
  { width: 1024, height: 768 },
  { width: 390, height: 844 },
] as const;

for (const theme of THEMES) {
  for (const size of SIZES) {
    test(`${theme.name} at ${size.width}x${size.height}`, async ({ page }) => {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      const fake = await FakeStation.behind(page, busyState(0));
      fake.showPicture(await fieldPicture(page));
      const begin_ms = performance.now();
      await page.goto("/");
      const timer = setInterval(
        () => fake.send(busyState((performance.now() - begin_ms) / 1000)),
        100,
      );
      await applyTheme(page, theme);
      await page.getByRole("button", { name: /^vehicle 1 Alder/ }).waitFor();
      await page.keyboard.press("1");
      await page.keyboard.press("Shift+Digit2");
      await page.getByText("frame 12").first().waitFor();
      await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.1);
      await page.screenshot({ path: `screens/${theme.name}-${size.width}.png` });
      clearInterval(timer);
    });
  }
}

/** All views of a theme and size on one sheet, `screens/views-*.jpg`; they are kept in `docs/images/`. */
const TILE_HEIGHT = 300;
const SHEET_WIDTH = 2000;

for (const theme of THEMES) {
  for (const size of SIZES) {
    test(`sheet of all views, ${theme.name} at ${size.width}`, async ({ page, context }) => {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      await page.addInitScript((chosen) => localStorage.setItem("recon.theme", chosen), theme.name);
      const tiles: string[] = [];
      await visitViews(page, async (view) => {
        await page.waitForTimeout(400);
        const picture = (await page.screenshot({ type: "jpeg", quality: 90 })).toString("base64");
        const image = `<img height="${TILE_HEIGHT}" src="data:image/jpeg;base64,${picture}">`;
        tiles.push(`<figure>${image}<figcaption>${view}</figcaption></figure>`);
      });
      const sheet = await context.newPage();
      await sheet.setViewportSize({ width: SHEET_WIDTH, height: 600 });
      const style =
        "body{margin:8px;display:flex;flex-wrap:wrap;gap:8px;font:18px system-ui}" +
        "figure{margin:0}img{display:block;border:1px solid #888}";
      await sheet.setContent(`<style>${style}</style>${tiles.join("")}`);
      const path = `screens/views-${theme.name}-${size.width}.jpg`;
      await sheet.screenshot({ path, type: "jpeg", quality: 70, fullPage: true });
    });
  }
}

for (const theme of THEMES) {
  test(`64 drones, ${theme.name}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: theme.colorScheme });
    const fake = await FakeStation.behind(page, fleetState(64, 0));
    await page.goto("/");
    await applyTheme(page, theme);
    await expect(page.locator("button.craft")).toHaveCount(64);
    for (let step = 1; step <= 5; step += 1) fake.send(fleetState(64, step / 10));
    await page.waitForTimeout(1500);
    await page.screenshot({ path: `screens/fleet-${theme.name}.png` });
  });
}

/**
 * The pictures of a replay in the documents: `recon demo` for seven minutes, then
 * `RECON_REPLAY=RECORD.mcap npm run screens -- -g documents`, and `web/screens/replay-*.png` to `docs/images/`.
 */
const REPLAYED = process.env["RECON_REPLAY"] ?? "";
const REPLAYED_AT_S = process.env["RECON_REPLAY_AT_S"] ?? "300";

for (const theme of THEMES.filter(({ sun }) => !sun)) {
  test(`a replay for the documents, ${theme.name}`, async ({ page }) => {
    test.skip(REPLAYED === "", "RECON_REPLAY names no record");
    const replay = await startReplay(REPLAYED);
    try {
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      await page.goto(replay.url);
      await page.getByRole("slider", { name: "Position in the record" }).fill(REPLAYED_AT_S);
      await expect(page.getByRole("region", { name: "Sun forecast" })).toBeVisible();
      await page.keyboard.press("f");
      await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.1);
      await expect(page.locator(".replay-alarms")).toHaveAttribute("d", /M/);
      await page.waitForTimeout(2000);
      await page.screenshot({ path: `screens/replay-${theme.name}.png` });
    } finally {
      await replay.stop();
    }
  });
}

test("a base map for the documents", async ({ page }) => {
  const folder = await mkdtemp(join(tmpdir(), "recon-screens-"));
  const server = await startTileServer();
  let station: RunningStation | null = null;
  try {
    await cp(DEMO_SITE, folder, { recursive: true });
    const words = ["--zoom", "13-18", "--name", "'orthophoto 2025'"];
    const source = ["--url", `'${server.template}'`, "--attribution", "'© survey office'"];
    await runRecon("maps", "fetch", folder, ...source, ...words);
    station = await startStation("--site", folder);
    for (const theme of THEMES) {
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      await page.goto(station.url);
      await applyTheme(page, theme);
      await page.getByText(/Ground image: frame .* aligned to/).waitFor();
      for (const size of [...SIZES].reverse()) {
        await page.setViewportSize(size);
        await page.waitForTimeout(1000);
        await page.keyboard.press("f");
        await page.getByRole("button", { name: "Map and overlay" }).click();
        await page.getByRole("radio", { name: /^orthophoto 2025 covers 100 %/ }).waitFor();
        await page.waitForTimeout(2000);
        await page.screenshot({ path: `screens/base-map-${theme.name}-${size.width}.png` });
        await page.keyboard.press("Escape");
      }
    }
  } finally {
    await server.stop();
    await station?.stop();
    await rm(folder, { recursive: true });
  }
});

/** A drone that another person operates, and an app that waits to be admitted. */
function sharedState(): StationState {
  const alder = vehicle(1, { lease: { person: "anna", age_s: 74, absent_s: null } });
  const birch = vehicle(2, { lease: { person: "local-operator", age_s: 30, absent_s: null } });
  const waits = link(7, {
    status: "waiting",
    claimed_serial: null,
    waiting: {
      serial: "1581F5BKD22BJ00A",
      age_s: 42,
      reason: "its serial is expected from 192.168.8.21",
      is_flying: true,
    },
  });
  return station([alder, birch], {
    links: [link(1), link(2), waits],
    alarms: [
      alarm(7, {
        rule: "lease_ended",
        serial: "SN-001",
        vehicle_name: "Alder",
        text: "Alder: taken over by anna from local-operator",
      }),
    ],
  });
}

for (const theme of THEMES) {
  test(`another person and a waiting app, ${theme.name}`, async ({ page }) => {
    await page.setViewportSize({ width: 1440, height: 1000 });
    await page.emulateMedia({ colorScheme: theme.colorScheme });
    const fake = await FakeStation.behind(page, sharedState());
    fake.showPicture(await fieldPicture(page));
    await page.goto("/");
    await applyTheme(page, theme);
    await page.getByRole("button", { name: /^vehicle 1 Alder/ }).click();
    await page.keyboard.press("d");
    await openPanel(page, "Links");
    await expect(page.getByText("Take over from anna")).toBeVisible();
    await page.screenshot({ path: `screens/shared-${theme.name}.png` });
    const waiting = page.getByLabel("Admit 1581F5BKD22BJ00A", { exact: true });
    await waiting.scrollIntoViewIfNeeded();
    await waiting.screenshot({ path: `screens/waiting-${theme.name}.png` });
    await page
      .getByLabel("Control authority")
      .screenshot({ path: `screens/lease-${theme.name}.png` });
  });
}

test("connection lost, help and a held button", async ({ page }) => {
  const fake = await FakeStation.behind(page, busyState(0));
  fake.showPicture(await fieldPicture(page));
  await page.goto("/");
  await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.2);
  await page.keyboard.press("Control+a");
  await page.keyboard.down("Shift");
  await page.keyboard.down("L");
  await expect(page.getByText("Keep holding to land")).toBeVisible();
  await page.screenshot({ path: "screens/holding.png" });
  await expect(page.getByText(/^Land: \d of \d landing/)).toBeVisible();
  await page.keyboard.up("L");
  await page.keyboard.up("Shift");
  await page.screenshot({ path: "screens/answer.png" });
  await fake.goOffline();
  await expect(page.getByText("No connection to the station.")).toBeVisible();
  await page.locator(".status-button").click();
  await page.screenshot({ path: "screens/lost.png" });
  await page.locator(".status-button").click();
  await page.keyboard.press("?");
  await page.screenshot({ path: "screens/help.png" });
});

for (const theme of THEMES) {
  for (const size of SIZES) {
    test(`site editor, ${theme.name} at ${size.width}x${size.height}`, async ({ page }) => {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      const fake = await FakeStation.behind(page, HERE);
      fake.drawing = DRAWING;
      fake.drawingResult = REFUSED;
      sendAges(page, fake);
      await page.goto("/");
      await applyTheme(page, theme);
      await openPanel(page, "Edit site");
      const panel = page.getByRole("region", { name: "Edit site", exact: true });
      await panel.getByRole("button", { name: "Edit", exact: true }).click();
      await panel.getByRole("button", { name: /farmyard/ }).click();
      await panel.getByLabel("Ceiling, m").fill("25");
      await panel.getByLabel("Ceiling, m").press("Enter");
      await panel.getByText(/edges do not meet/).waitFor();
      await page.waitForTimeout(1000);
      await page.screenshot({ path: `screens/site-${theme.name}-${size.width}.png` });
    });

    test(`calibration, ${theme.name} at ${size.width}x${size.height}`, async ({ page }) => {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      const fake = await FakeStation.behind(page, HERE);
      fake.frozen = FROZEN;
      fake.fit = FIT;
      fake.showPicture(await fieldPicture(page));
      sendAges(page, fake);
      await page.goto("/");
      await applyTheme(page, theme);
      await openPanel(page, "Calibrate camera");
      await markOnePoint(page);
      await page.screenshot({ path: `screens/calibration-${theme.name}-${size.width}.png` });
    });

    test(`site vehicles, ${theme.name} at ${size.width}x${size.height}`, async ({ page }) => {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      const fake = await FakeStation.behind(page, HERE);
      fake.vehicles = VEHICLES;
      fake.vehiclesResult = REFUSED_VEHICLE;
      sendAges(page, fake);
      await page.goto("/");
      await applyTheme(page, theme);
      await openPanel(page, "Site vehicles");
      await page.getByRole("textbox", { name: "Number of SN-009" }).fill("1");
      await page.keyboard.press("Tab");
      await page.getByText("Number: 1 is the number of Alder too").waitFor();
      await page.screenshot({ path: `screens/vehicles-${theme.name}-${size.width}.png` });
    });
  }
}
