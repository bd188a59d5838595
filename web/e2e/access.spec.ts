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

/** All rules in the first theme; in the others only the colours differ. */
async function faults(page: Page): Promise<string[]> {
  const found: string[] = [...(await smallTargets(page))];
  for (const { name } of THEMES) {
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
    const wrong: Record<string, string[]> = {};
    await visitViews(page, async (view) => {
      const found = await faults(page);
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
    expect(await faults(page), `${size.width} px`).toEqual([]);
  }
});
