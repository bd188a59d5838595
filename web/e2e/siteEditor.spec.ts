import { expect, type Page, test } from "@playwright/test";
import { axeFaults } from "./axe";
import { DRAWING, HERE, REFUSED, sendAges } from "./fake/drawnSite";
import { FakeStation } from "./fake/station";
import { smallTargets } from "./legibility";
import { openPanel } from "./openPanel";
import { applyTheme, THEMES } from "./themes";

function panelOf(page: Page) {
  return page.getByRole("region", { name: "Edit site", exact: true });
}

test("is drawn, checked and changed with the keyboard alone", async ({ page }) => {
  const fake = await FakeStation.behind(page, HERE);
  fake.drawing = { ...DRAWING, features: [] };
  fake.drawingResult = { ...fake.drawingResult, layers: ["boundary"] };
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(1);
  await openPanel(page, "Edit site");
  const panel = panelOf(page);
  await panel.getByRole("button", { name: "Edit", exact: true }).press("Enter");
  await panel.getByRole("button", { name: "At map centre" }).press("Enter");
  await panel.getByText("Outline: 4 corners").press("Enter");
  await expect(panel.getByRole("button", { name: "Save, in force at once" })).toBeInViewport({
    ratio: 1,
  });
  const corner = panel.getByLabel("Corner 1: latitude, longitude");
  await corner.fill("41.95, -93.65");
  await corner.press("Enter");
  await expect(panel.getByText("Ready to save. Changes: boundary.")).toBeVisible();
  await panel.getByRole("button", { name: "Redo" }).focus();
  await page.keyboard.press("Control+z");
  await expect(corner).not.toHaveValue("41.9500000, -93.6500000");
  await page.keyboard.press("Control+y");
  await expect(corner).toHaveValue("41.9500000, -93.6500000");
});

test("is legible and accessible in each theme", async ({ page }) => {
  const fake = await FakeStation.behind(page, HERE);
  fake.drawing = DRAWING;
  fake.drawingResult = REFUSED;
  sendAges(page, fake);
  await page.setViewportSize({ width: 390, height: 844 });
  await page.goto("/");
  await openPanel(page, "Edit site");
  const panel = panelOf(page);
  await panel.getByRole("button", { name: "Edit", exact: true }).click();
  await panel.getByRole("button", { name: /farmyard/ }).click();
  await panel.getByLabel("Ceiling, m").fill("25");
  await panel.getByLabel("Ceiling, m").press("Enter");
  await expect(panel.getByText(/edges do not meet/)).toBeVisible();
  // The key of the sun theme is a letter in a text field.
  await panel.getByRole("button", { name: /^farmyard/ }).focus();
  for (const theme of THEMES) {
    await page.emulateMedia({ colorScheme: theme.colorScheme });
    await applyTheme(page, theme);
    expect(await axeFaults(page), theme.name).toEqual([]);
  }
  expect(await smallTargets(page)).toEqual([]);
});
