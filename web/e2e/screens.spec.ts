import { expect, test } from "@playwright/test";
import { busyState } from "./fake/busyState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { drawnShare } from "./mapPicture";
import { applyTheme, THEMES } from "./themes";

/** Screenshots for review: `npm run screens`, then `web/screens/`. */
const SIZES = [
  { width: 1440, height: 900 },
  { width: 1024, height: 768 },
  { width: 800, height: 1200 },
  { width: 480, height: 900 },
  { width: 360, height: 740 },
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
  await expect(page.getByText(/^Accepted: /)).toBeVisible();
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
