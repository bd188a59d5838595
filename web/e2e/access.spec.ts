import { expect, type Page, test } from "@playwright/test";
import { axeFaults } from "./axe";
import { smallTargets } from "./legibility";
import { THEMES } from "./themes";
import { visitViews } from "./views";

/** A laptop's and a phone's page, pixels. */
const SIZES = [
  { width: 1440, height: 900 },
  { width: 390, height: 844 },
] as const;

/** All rules in the first theme; in the others only the colours differ, and those in no width. */
async function faults(page: Page, themes: readonly { name: string }[]): Promise<string[]> {
  const found: string[] = [...(await smallTargets(page))];
  for (const { name } of themes) {
    await page.evaluate((theme) => {
      document.documentElement.dataset["theme"] = theme;
    }, name);
    const wrong = await axeFaults(page, name === THEMES[0].name ? null : ["color-contrast"]);
    found.push(...wrong.map((fault) => `${name}: ${fault}`));
  }
  return found;
}

for (const size of SIZES) {
  test(`every view meets WCAG 2.2 AA in each theme: ${size.width} px`, async ({ page }) => {
    await page.setViewportSize(size);
    // Nothing glides while it is measured.
    await page.emulateMedia({ reducedMotion: "reduce" });
    const wrong: Record<string, string[]> = {};
    await visitViews(page, async (view) => {
      const found = await faults(page, size === SIZES[0] ? THEMES : THEMES.slice(0, 1));
      if (found.length > 0) wrong[view] = found;
    });
    expect(wrong).toEqual({});
  });
}

test("the login meets WCAG 2.2 AA in each theme", async ({ page }) => {
  await page.routeWebSocket(/\/api\/stream/, (socket) =>
    socket.close({ code: 4401, reason: "token missing" }),
  );
  await page.route("**/api/**", (route) => route.abort());
  await page.goto("/");
  await expect(page.getByRole("dialog", { name: "Log in to Recon" })).toBeVisible();
  await page.getByLabel("Token, or the whole address with it").fill("wrong");
  await page.getByRole("button", { name: "Log in" }).click();
  await page.getByRole("button", { name: "Log in" }).focus();
  for (const size of SIZES) {
    await page.setViewportSize(size);
    expect(await faults(page, THEMES), `${size.width} px`).toEqual([]);
  }
});
