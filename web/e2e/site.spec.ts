import { cp, mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, type Page, test } from "@playwright/test";
import { axeFaults } from "./axe";
import { smallTargets } from "./legibility";
import { openPanel } from "./openPanel";
import { DEMO_SITE, runRecon, startStation } from "./stationProcess";
import { THEMES } from "./themes";

const CONNECT_WITHIN_MS = 180_000;

const RING = [
  [-93.6044, 41.9006],
  [-93.6024, 41.9006],
  [-93.6024, 41.9018],
  [-93.6044, 41.9018],
  [-93.6044, 41.9006],
];
const KML = `<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><name>north</name><Polygon><outerBoundaryIs>
<LinearRing><coordinates>${RING.map((corner) => corner.join(",")).join(" ")}</coordinates></LinearRing>
</outerBoundaryIs></Polygon></Placemark></kml>`;

/** Presses at places of the map, in shares of its width and height. */
async function pressMap(page: Page, ...places: (readonly [number, number])[]) {
  const { width, height } = page.viewportSize() ?? { width: 0, height: 0 };
  for (const [x, y] of places) await page.mouse.click(x * width, y * height);
}

test("an empty folder and a KML become a rehearsal with sun and forecast, in four presses", async ({
  page,
}) => {
  test.setTimeout(480_000);
  // As docs/how-to/draw-a-site.md begins: a folder with nothing in it.
  const folder = await mkdtemp(join(tmpdir(), "recon-site-"));
  const began_ms = Date.now();
  const station = await startStation("--site", folder);
  let presses = 0;
  try {
    await page.goto(station.url);
    await expect(page.getByRole("heading", { name: "Where is your field?" })).toBeVisible();
    const waited_ms = await test.step("the page is readable in each theme", async () => {
      const looked_ms = Date.now();
      expect(await smallTargets(page)).toEqual([]);
      for (const { name } of THEMES) {
        await page.evaluate((theme) => {
          document.documentElement.dataset["theme"] = theme;
        }, name);
        expect(await axeFaults(page)).toEqual([]);
      }
      return Date.now() - looked_ms;
    });
    await test.step("a site is made of the field's outline", async () => {
      presses += 2; // the button, and the file in the dialog
      await page
        .getByLabel("Read it from a file")
        .setInputFiles({ name: "fields.kml", mimeType: "text/xml", buffer: Buffer.from(KML) });
      await expect(page.getByRole("checkbox", { name: /^north, \d/ })).toBeChecked();
      await expect(page.getByRole("img", { name: /^The field, the boundary/ })).toBeVisible();
      await expect(page.getByLabel("Height above sea level")).toBeFocused();
      await page.keyboard.type("275");
      presses += 1;
      await page.getByRole("button", { name: "Make the site" }).click();
    });
    const survey = page.getByRole("region", { name: "Survey", exact: true });
    const rehearse = survey.getByRole("button", { name: /^Rehearse, hold 1.5 s/ });
    await test.step("one button plans the survey and takes off", async () => {
      await expect(page.locator("button.craft")).not.toHaveCount(0, { timeout: CONNECT_WITHIN_MS });
      await expect(survey.getByText(/^3 simulated drones take off/)).toBeVisible();
      presses += 1;
      await rehearse.hover();
      await page.mouse.down();
      await expect(survey.getByText(/^Running/)).toBeVisible();
      await page.mouse.up();
    });
    await test.step("all fly, with sun and forecast", async () => {
      await expect(page.getByText(/^Sun now · \d+\s%/)).toBeVisible({ timeout: CONNECT_WITHIN_MS });
      await expect(page.getByRole("slider", { name: "Time of the forecast" })).toBeVisible();
      await expect(page.getByTestId("status-count")).toHaveText("4 of 4");
      await expect(survey.getByText(/does not fly rows/)).toHaveCount(0);
    });
    const minutes = (Date.now() - began_ms - waited_ms) / 60_000;
    console.log(`rehearsal from an empty folder: ${presses} presses, ${minutes.toFixed(2)} min`);
    expect(presses).toBe(4);

    await test.step("while a drone flies, a fence stays, and the refusal names it", async () => {
      await openPanel(page, "Edit site");
      const panel = page.getByRole("region", { name: "Edit site", exact: true });
      await panel.getByRole("button", { name: "Edit", exact: true }).click();
      await panel.getByRole("button", { name: /^Drone 3 Landing pad/ }).click();
      await panel.getByRole("button", { name: "Remove Drone 3" }).click();
      await panel.getByRole("button", { name: /^Save/ }).click();
      await expect(
        panel.getByText(/^Not saved: Boundary, zones and pads change only/),
      ).toContainText("Drone 1");
      await openPanel(page, "Site vehicles");
      const table = page.getByRole("region", { name: "Site vehicles", exact: true });
      const reference = table.getByRole("combobox", { name: "Altitude reference of SIM-1" });
      await reference.selectOption("WGS84 ellipsoid");
      await expect(table.getByText(/change, and it is added or removed, only while/)).toContainText(
        "Drone 1. Land first",
      );
    });
  } finally {
    await station.stop();
    await rm(folder, { recursive: true });
  }
});

test("a site is drawn and imported in the browser, in force at once", async ({ page }) => {
  test.setTimeout(480_000);
  const folder = await mkdtemp(join(tmpdir(), "recon-site-"));
  await runRecon(
    "site",
    "new",
    folder,
    "--at",
    "41.9012,-93.6034",
    "--drones",
    "2",
    "--ground-above-sea-level",
    "275m",
    "--name",
    "North",
  );
  const station = await startStation("--site", folder);
  try {
    await page.goto(station.url);
    await expect(page.locator("button.craft")).toHaveCount(3, { timeout: CONNECT_WITHIN_MS });
    await expect(page.getByRole("banner").getByText("North")).toBeVisible();
    await openPanel(page, "Edit site");
    const panel = page.getByRole("region", { name: "Edit site", exact: true });
    const save = panel.getByRole("button", { name: /^Save/ });
    await panel.getByRole("button", { name: "Edit", exact: true }).click();
    for (let step = 0; step < 3; step += 1)
      await page.getByRole("button", { name: "Zoom out" }).click();

    await test.step("the boundary is drawn, a corner dragged, and in force when saved", async () => {
      await panel.getByRole("button", { name: "Draw on map" }).click();
      await expect(panel.getByText(/Press the corners of the boundary/)).toBeVisible();
      await pressMap(page, [0.33, 0.2], [0.63, 0.2], [0.63, 0.8], [0.33, 0.8], [0.33, 0.2]);
      await expect(panel.getByText("Outline: 4 corners")).toBeVisible();
      const size = panel.getByRole("button", { name: /^boundary .* ha$/ });
      const before = await size.textContent();
      const { width, height } = page.viewportSize() ?? { width: 0, height: 0 };
      await page.mouse.move(0.63 * width, 0.2 * height);
      await page.mouse.down();
      await page.mouse.move(0.65 * width, 0.17 * height, { steps: 4 });
      await page.mouse.up();
      await expect(size).not.toHaveText(before ?? "");
      await expect(panel.getByText("Ready to save. Changes: boundary.")).toBeVisible();
      await expect(page.locator(".area-label-boundary")).toHaveCount(0);
      await save.click();
      await expect(panel.getByText("Saved: boundary. In force now")).toBeVisible();
      await expect(page.locator(".area-label-boundary")).toHaveCount(1);
    });

    await test.step("a KML's field becomes a region to survey", async () => {
      await panel
        .getByLabel("Import a file")
        .setInputFiles({ name: "fields.kml", mimeType: "text/xml", buffer: Buffer.from(KML) });
      await panel.getByRole("button", { name: "Add 1 feature" }).click();
      await save.click();
      await expect(panel.getByText("Saved: survey regions. In force now")).toBeVisible();
    });

    const table = page.getByRole("region", { name: "Site vehicles", exact: true });
    const saveTable = table.getByRole("button", { name: /^Save/ });
    await test.step("vehicles are edited in a table, in force at once, and undone", async () => {
      await openPanel(page, "Site vehicles");
      await table.getByRole("textbox", { name: "Name of SIM-2" }).fill("Birch");
      const number = table.getByRole("textbox", { name: "Number of SIM-2" });
      await number.fill("1");
      await number.press("Tab");
      await expect(table.getByText("Number: 1 is the number of Drone 1 too")).toBeVisible();
      await number.fill("12");
      await table.getByRole("textbox", { name: "Serial, as the app shows it" }).fill("NEW-9");
      await table.getByRole("button", { name: "Add vehicle" }).click();
      await expect(table.getByText(/^Ready to save: SIM-2 name Drone 2 -> Birch/)).toBeVisible();
      await saveTable.click();
      await expect(table.getByText("Saved: 2 vehicles. In force now")).toBeVisible();
      await expect(page.getByRole("checkbox", { name: /Birch/ })).toBeVisible();
      await table.getByRole("button", { name: "Remove SIM-2" }).click();
      await saveTable.click();
      await expect(table.getByText("Saved: 1 vehicle. In force now")).toBeVisible();
      await table.getByRole("button", { name: "Add SIM-2" }).click();
      await expect(table.getByRole("row", { name: "SIM-2" })).toBeVisible();
      await table.getByRole("button", { name: "Discard" }).click();
      await table.getByRole("button", { name: /^Undo last save: vehicles/ }).click();
      await expect(table.getByText("Undone. In force now")).toBeVisible();
      await expect(page.getByRole("checkbox", { name: /Birch/ })).toBeVisible();
    });
  } finally {
    await station.stop();
    await rm(folder, { recursive: true });
  }
});

test("the imaging drone is calibrated on a frozen frame, residuals at once", async ({ page }) => {
  test.setTimeout(480_000);
  const folder = await mkdtemp(join(tmpdir(), "recon-calibration-"));
  await cp(DEMO_SITE, folder, { recursive: true });
  const before = await readFile(join(folder, "GCPs.txt"), "utf-8");
  const marks = before
    .split("\n")
    .filter((line) => line !== "" && !line.startsWith("#"))
    .map((line) => line.split(",").map((part) => part.trim()));
  const station = await startStation("--site", folder);
  try {
    await page.goto(station.url);
    await openPanel(page, "Calibrate camera");
    const panel = page.getByRole("region", { name: "Calibrate camera", exact: true });
    const points = panel.getByRole("list", { name: "Control points" });
    const accept = panel.getByRole("button", { name: "Accept and save" });
    // Until there is a frame; each answer is awaited, for a late one would take the marks away.
    await expect(async () => {
      const answer = page.waitForResponse(/\/calibration\/freeze$/);
      await panel.getByRole("button", { name: /^Freeze/ }).click();
      expect(await (await answer).json()).toMatchObject({ accepted: true });
    }).toPass({ timeout: CONNECT_WITHIN_MS });
    await expect(panel.getByAltText(/^The frozen frame/)).toBeVisible();
    await panel.getByRole("button", { name: /^Use the site's 8 surveyed points/ }).click();
    const picture = panel.getByAltText(/^The frozen frame/);
    const [cols, rows] = [3840, 2160];
    const mark = async ([name = "", col = "", row = ""]: string[]) => {
      await points.getByRole("button", { name: new RegExp(`^${name}\\b`) }).click();
      await picture.scrollIntoViewIfNeeded();
      const box = await picture.boundingBox();
      const { x = 0, y = 0, width = 0, height = 0 } = box ?? {};
      const at = [(Number(col) + 0.5) / cols, (Number(row) + 0.5) / rows] as const;
      await page.mouse.click(x + at[0] * width, y + at[1] * height);
    };
    await test.step("three points are too few, and the reason is shown", async () => {
      for (const one of marks.slice(0, 3)) await mark(one);
      await expect(panel.getByText(/expected at least 4 control points, got 3/)).toBeVisible();
      await expect(accept).toBeDisabled();
    });
    await test.step("more points give the camera, with the residual of each", async () => {
      for (const one of marks.slice(3)) await mark(one);
      await expect(panel.getByText(/^RMS \d\.\d+\spx · 1[12]\d\.\d\sm above ground/)).toBeVisible();
      await expect(points.getByRole("button", { name: /px · .*m$/ })).toHaveCount(8);
    });
    await test.step("accepted, the points are saved and undone", async () => {
      await accept.click();
      await expect(panel.getByText(/^Saved\. The next frames/)).toBeVisible();
      expect(await readFile(join(folder, "GCPs.txt"), "utf-8")).not.toBe(before);
      expect(await readFile(join(folder, "site.toml"), "utf-8")).toContain("[1280, 720]");
      await openPanel(page, "Edit site");
      const site = page.getByRole("region", { name: "Edit site", exact: true });
      await site.getByRole("button", { name: "Edit", exact: true }).click();
      await site.getByRole("button", { name: /^Undo last save: calibration/ }).click();
      await expect(site.getByText("Undone: calibration. In force now")).toBeVisible();
      expect(await readFile(join(folder, "GCPs.txt"), "utf-8")).toBe(before);
    });
  } finally {
    await station.stop();
    await rm(folder, { recursive: true });
  }
});
