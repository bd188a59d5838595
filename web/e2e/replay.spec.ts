import { expect, type Page, test } from "@playwright/test";
import { axeFaults } from "./axe";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { type RunningStation, startReplay } from "./stationProcess";
import { applyTheme, THEMES } from "./themes";

let replay: RunningStation;
test.beforeAll(async () => {
  replay = await startReplay("tests/replay/flights/survey.mcap");
});
test.afterAll(() => replay.stop());

const slider = (page: Page) => page.getByRole("slider", { name: "Position in the record" });
const position = (page: Page) => page.getByTestId("replay-position");
/** Where the first vehicle stands on the page, whole pixels. */
const place = (page: Page) =>
  page
    .locator("button.craft")
    .first()
    .evaluate((icon) => {
      const { x, y } = icon.getBoundingClientRect();
      return `${Math.round(x)},${Math.round(y)}`;
    });

test("a recorded flight is played and sought, a drone moves, and nothing can be ordered", async ({
  page,
}) => {
  await page.goto(replay.url);
  await expect(page).toHaveTitle("REPLAY · Recon");
  await expect(page.locator(".bar").getByText("REPLAY", { exact: true })).toBeVisible();
  await expect(page.getByRole("button", { name: /^All stop/ })).toHaveCount(0);

  await test.step("a seek shows the vehicles of that moment", async () => {
    await slider(page).fill("26");
    await expect(position(page)).toHaveText(/^0:2[56] \/ 0:48$/);
    await expect(page.locator("button.craft")).toHaveCount(2);
  });

  await test.step("a drone moves while it plays, and stands while it is paused", async () => {
    await slider(page).fill("4");
    await expect(position(page)).toHaveText(/^0:0[34] /);
    const before = await place(page);
    await page.getByLabel("Replay speed").selectOption("20");
    await page.getByRole("button", { name: "Play the replay" }).click();
    await expect.poll(() => place(page)).not.toBe(before);
    await expect(position(page)).toHaveText("0:48 / 0:48");
    await expect(page.getByRole("button", { name: "Play the replay" })).toBeVisible();
  });

  await test.step("by the keyboard: to the beginning, and to an order", async () => {
    await slider(page).press("Home");
    await expect(position(page)).toHaveText("0:00 / 0:48");
    await slider(page).press("End");
    await expect(position(page)).toHaveText("0:48 / 0:48");
    await page.getByRole("button", { name: "Previous alarm or order" }).press("Enter");
    await expect(position(page)).not.toHaveText("0:48 / 0:48");
    await expect(page.locator(".replay-mark-text")).toContainText(/queued|alarm/);
  });

  await test.step("an order is refused by the page and by the station", async () => {
    await expect(page.getByRole("region", { name: "Orders to the selected vehicles" })).toHaveCount(
      0,
    );
    await page.keyboard.press("Shift+S");
    const refusal = page.getByText("This is a replay: no orders are possible").first();
    await expect(refusal).toBeVisible();
    await expect(refusal).toBeInViewport({ ratio: 1 });
    const answer = await page.request.post(`${replay.url}/api/all-stop`);
    expect(answer.status()).toBe(409);
  });

  await test.step("it is legible at every width and theme, and named for all", async () => {
    for (const theme of THEMES) {
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      await applyTheme(page, theme);
      for (const width of [390, 1024, 1440]) {
        await page.setViewportSize({ width, height: width === 390 ? 844 : 800 });
        await expect(page.locator(".bar").getByText("REPLAY", { exact: true })).toBeVisible();
        expect(await smallTexts(page)).toEqual([]);
        expect(await smallTargets(page)).toEqual([]);
        expect(await faintTexts(page)).toEqual([]);
      }
      expect(await axeFaults(page)).toEqual([]);
    }
  });
});
