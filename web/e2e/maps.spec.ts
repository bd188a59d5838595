import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, type Page, test } from "@playwright/test";
import { axeFaults } from "./axe";
import { startTileServer } from "./fake/tileServer";
import { smallTargets, smallTexts } from "./legibility";
import { drawnShare } from "./mapPicture";
import { runRecon, startReplay, startStation } from "./stationProcess";
import { applyTheme, THEMES } from "./themes";

const CONNECT_WITHIN_MS = 180_000;
/** Two drones and the imaging drone. */
const VEHICLES = 3;
const RING = [
  [-93.6054, 41.9],
  [-93.6014, 41.9],
  [-93.6014, 41.9024],
  [-93.6054, 41.9024],
  [-93.6054, 41.9],
];
const BOUNDARY = {
  type: "FeatureCollection",
  features: [
    {
      type: "Feature",
      properties: { name: "farm" },
      geometry: { type: "Polygon", coordinates: [RING] },
    },
  ],
};

/** A lines-only map has a few hundredths. */
const MOSTLY_DRAWN = 0.5;

// One folder of maps for the file.
test.describe.configure({ mode: "default" });

let folder: string;
test.beforeAll(async () => {
  // As docs/how-to/bring-a-map.md does it.
  folder = await mkdtemp(join(tmpdir(), "recon-maps-"));
  const place = ["--at", "41.9012,-93.6034", "--ground-altitude-m", "275"];
  await runRecon("site", "new", folder, ...place, "--drones", "2");
  const boundary = join(folder, "drawn.json");
  await writeFile(boundary, JSON.stringify(BOUNDARY));
  await runRecon("site", "import", folder, boundary, "--as", "boundary");
  const server = await startTileServer();
  const words = ["--zoom", "13-18", "--name", "farm", "--attribution", "'made tiles'"];
  await runRecon("maps", "fetch", folder, "--url", `'${server.template}'`, ...words);
  await server.stop();
  await runRecon("maps", "check", folder);
});
test.afterAll(() => rm(folder, { recursive: true, force: true }));

const layersButton = (page: Page) => page.getByRole("button", { name: "Map and overlay" });
const mapNote = (page: Page) => page.getByText("Map: farm, made tiles");

test("a map that was fetched before leaving is below everything, without its server", async ({
  page,
}) => {
  const station = await startStation("--site", folder);
  const hosts = new Set<string>();
  const errors: string[] = [];
  page.on("request", (request) => {
    if (!/^(blob|data):/.test(request.url())) hosts.add(new URL(request.url()).host);
  });
  page.on("pageerror", (error) => errors.push(error.message));
  try {
    await page.goto(station.url);
    await expect(page.locator("button.craft")).toHaveCount(VEHICLES, {
      timeout: CONNECT_WITHIN_MS,
    });
    await expect(mapNote(page)).toBeVisible();
    await expect.poll(() => drawnShare(page)).toBeGreaterThan(MOSTLY_DRAWN);

    await test.step("the list states what it covers of the site", async () => {
      await layersButton(page).click();
      const shown = page.getByRole("radio", { name: /^farm covers 100 % of the site to zoom 18/ });
      await expect(shown).toBeChecked();
      await expect(page.getByText("(0.44\u00a0m a pixel)")).toBeVisible();
    });

    await test.step("it is legible in each theme", async () => {
      for (const theme of THEMES) {
        await page.emulateMedia({ colorScheme: theme.colorScheme });
        await applyTheme(page, theme);
        expect(await axeFaults(page), theme.name).toEqual([]);
      }
      expect(await smallTexts(page)).toEqual([]);
      expect(await smallTargets(page)).toEqual([]);
    });

    await test.step("none is chosen, and kept when the page is loaded again", async () => {
      await page.getByRole("radio", { name: "None", exact: true }).check();
      await expect(mapNote(page)).toHaveCount(0);
      await expect.poll(() => drawnShare(page)).toBeLessThan(MOSTLY_DRAWN);
      await page.reload();
      await expect(page.locator("button.craft")).toHaveCount(VEHICLES);
      await layersButton(page).click();
      await expect(page.getByRole("radio", { name: "None", exact: true })).toBeChecked();
      await page.getByRole("radio", { name: /^farm covers/ }).check();
      await expect.poll(() => drawnShare(page)).toBeGreaterThan(MOSTLY_DRAWN);
    });

    // Nothing but the station was asked.
    expect([...hosts]).toEqual([new URL(station.url).host]);
    expect(errors).toEqual([]);
  } finally {
    await station.stop();
  }
});

test("a replay shows the maps of the folder it is given, else states what to do", async ({
  page,
}) => {
  const record = "tests/replay/flights/survey.mcap";
  const replay = await startReplay(record, "--site", folder);
  try {
    await page.goto(replay.url);
    await expect(page.locator(".bar").getByText("REPLAY", { exact: true })).toBeVisible();
    await expect(mapNote(page)).toBeVisible();
  } finally {
    await replay.stop();
  }
  const alone = await startReplay(record);
  try {
    await page.goto(alone.url);
    await layersButton(page).click();
    await expect(page.getByText(/start recon replay with --site FOLDER/)).toBeVisible();
  } finally {
    await alone.stop();
  }
});
