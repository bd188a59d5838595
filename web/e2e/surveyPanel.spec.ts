import { expect, test } from "@playwright/test";
import { flownRegion } from "../src/testing/fakeField";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { surveyedState, WAYS } from "./fake/surveyedState";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { inEachTheme } from "./themes";

/** A laptop's and a phone's page, pixels. */
const SIZES = [
  [1440, 900],
  [360, 740],
] as const;

test("is legible during surveys in each theme", async ({ page }) => {
  const fake = await FakeStation.behind(page, surveyedState(0));
  fake.paths = WAYS;
  fake.flown = { ...fake.flown, regions: [flownRegion({ region: "orchard", is_simulated: true })] };
  fake.showPicture(await fieldPicture(page));
  await page.goto("/");
  const begin_ms = performance.now();
  const timer = setInterval(
    () => fake.send(surveyedState((performance.now() - begin_ms) / 1000)),
    500,
  );
  page.once("close", () => clearInterval(timer));
  await page.keyboard.press("3");
  const panel = page.getByRole("region", { name: "Survey", exact: true });
  await expect(panel.getByText("recalled")).toBeVisible();
  await panel.getByText("Resume a survey").click();
  await panel.getByText("New survey").click();
  await inEachTheme(page, async (theme) => {
    for (const [width, height] of SIZES) {
      await page.setViewportSize({ width, height });
      const where = `${theme.name}, ${width} px wide`;
      expect(await smallTexts(page), where).toEqual([]);
      expect(await smallTargets(page), where).toEqual([]);
      expect(await faintTexts(page), where).toEqual([]);
      expect(await cornerFaults(page), where).toEqual([]);
      expect(await overlaps(page, ".survey-form label, .section-buttons button")).toEqual([]);
    }
  });
});
