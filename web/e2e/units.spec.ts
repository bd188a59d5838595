import { expect, test } from "@playwright/test";
import { fencedState } from "./fake/fencedState";
import { FakeStation } from "./fake/station";

test("feet are shown and typed, metres are sent, and the choice is kept", async ({ page }) => {
  const fake = await FakeStation.behind(page, fencedState(0));
  const timer = setInterval(() => fake.send(fencedState(0)), 500);
  page.once("close", () => clearInterval(timer));
  await page.goto("/");
  await expect(page.getByText("Height limit: Power line, 45 m to 90 m above ground")).toBeVisible();
  await page.keyboard.press("1");
  await page.keyboard.press("g");
  const card = page.locator(".fly");
  await card.getByLabel("Above takeoff, m").fill("40");
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  await page.getByLabel("Units").selectOption("Feet");
  await page.keyboard.press("Escape");
  // What was typed in metres is the same height, and the map follows without a new site.
  await expect(card.getByLabel("Above takeoff, ft")).toHaveValue("131");
  await expect(
    page.getByText("Height limit: Power line, 148 ft to 295 ft above ground"),
  ).toBeVisible();
  await expect(page.locator(".map-scale-bar")).toHaveText(/^\d+ ft$/);
  await card.getByLabel("Above takeoff, ft").fill("100");
  await page.getByRole("button", { name: "Use map centre" }).press("Enter");
  await expect(page.getByText("Allowed by the safety gate.")).toBeVisible();
  await page.getByRole("button", { name: /^Fly there and hold/ }).focus();
  await page.keyboard.down("Enter");
  await expect.poll(() => fake.orders.length).toBe(1);
  await page.keyboard.up("Enter");
  expect(fake.orders[0]?.order).toMatchObject({ kind: "goto", height_above_takeoff_m: 30.48 });
  await page.reload();
  await expect(
    page.getByText("Height limit: Power line, 148 ft to 295 ft above ground"),
  ).toBeVisible();
  await expect(page.getByText("2 Birch flying here, ↥ 138 ft ATO")).toBeVisible();
});
