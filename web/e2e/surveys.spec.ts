import { expect, type Locator, type Page, test } from "@playwright/test";
import { startStation } from "./stationProcess";

/** The imaging drone renders its first frame before it connects, which is slow on a busy machine. */
const CONNECT_WITHIN_MS = 180_000;
/** Vehicles taking off side by side wait for each other; a refused mission is retried after 15 s. */
const FLIES_WITHIN_MS = 60_000;

async function hold(page: Page, button: Locator, until: () => Promise<void>): Promise<void> {
  await button.focus();
  await page.keyboard.down("Enter");
  await until();
  await page.keyboard.up("Enter");
}

test("plans a survey of a site region, flies it with two vehicles, pauses and aborts it", async ({
  page,
}) => {
  test.setTimeout(600_000);
  const station = await startStation("--no-survey");
  try {
    await page.goto(station.url);
    await expect(page.locator("button.craft")).toHaveCount(4, { timeout: CONNECT_WITHIN_MS });
    const panel = page.getByRole("region", { name: "Survey", exact: true });

    await test.step("planned, nothing moves", async () => {
      // Which drones are simulated is known shortly after where they are; the form folds then.
      await expect(panel.getByRole("region", { name: "Rehearsal" })).toBeVisible();
      await panel.getByText("New survey").click();
      await panel.getByLabel("Region").selectOption("south-east field");
      await panel.getByLabel("Height, m").fill("40");
      await panel.getByLabel("Rows").selectOption("lawnmower_once");
      await panel.getByRole("button", { name: "Plan survey" }).click();
      await expect(panel.getByText("Planned, not started")).toBeVisible();
      await expect(page.getByTestId("status-count")).toHaveText("1 of 4");
    });

    const paths = page.waitForResponse(/\/api\/surveys\/\d+\/paths$/);
    await test.step("two with takeoff allowed fly it", async () => {
      for (const name of ["Drone 1", "Drone 2"]) {
        await page.getByRole("checkbox", { name: new RegExp(name) }).press("Space");
      }
      await panel.getByLabel("Allow takeoff for this start").check();
      const start = panel.getByRole("button", { name: /^Start with selected, .*Drone 1.*Drone 2/ });
      await hold(page, start, () => expect(panel.getByText(/^(Running|Stopped)/)).toBeVisible());
      await expect(page.getByText(/^Surveying · /)).toHaveCount(2, { timeout: FLIES_WITHIN_MS });
      await expect(page.getByTestId("status-count")).toHaveText("3 of 4", {
        timeout: FLIES_WITHIN_MS,
      });
    });

    await test.step("its rows and coverage are on the map", async () => {
      expect((await (await paths).json()).rows.length).toBeGreaterThan(3);
      const cells = page.waitForResponse(/\/api\/surveys\/\d+\/cells\.png/);
      await page.getByRole("button", { name: "Map and overlay" }).click();
      await page.getByLabel("Coverage").check();
      expect((await cells).status()).toBe(200);
    });

    await test.step("a short press pauses it, a long one aborts it", async () => {
      await hold(page, panel.getByRole("button", { name: /^Pause, / }), () =>
        expect(panel.getByText(/^Paused/)).toBeVisible(),
      );
      await hold(page, panel.getByRole("button", { name: /^Abort, / }), () =>
        expect(panel.getByText(/^Aborted/)).toBeVisible(),
      );
      await expect(panel.getByRole("button", { name: /survey south-east field/ })).toHaveCount(0);
    });
  } finally {
    await station.stop();
  }
});
