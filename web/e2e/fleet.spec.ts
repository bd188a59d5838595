import { expect, test } from "@playwright/test";
import { fleetState } from "./fake/fleetState";
import { FakeStation } from "./fake/station";

test("64 drones stay readable: list, alarms by cause, clusters", async ({ page }) => {
  const fake = await FakeStation.behind(page, fleetState(64, 0));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(64);
  await expect(page.getByTestId("status-label")).toHaveText("Contact lost");
  await expect(page.getByTestId("status-count")).toHaveText("2 of 64");

  await test.step("the list is searched, sorted and filtered", async () => {
    const rows = page.locator(".vehicle");
    await expect(rows).toHaveCount(64);
    await page.getByLabel("Search by number, name or serial").fill("Drone 64");
    await expect(rows).toHaveCount(1);
    await page.getByLabel("Search by number, name or serial").fill("");
    await page.getByLabel("Show").selectOption("With a problem");
    await expect(rows).toHaveCount(2);
    await page.getByLabel("Show").selectOption("All");
    await page.getByLabel("Group by").selectOption("What they do");
    await expect(page.getByRole("heading", { name: "On the ground 8" })).toBeVisible();
  });

  await test.step("31 alarms of one cause have one acknowledgement", async () => {
    await page.getByRole("button", { name: "1 alarm", exact: true }).click();
    await page.getByRole("button", { name: "OK: acknowledge Separation: 31 pairs" }).click();
    await expect.poll(() => fake.acknowledged.length).toBe(31);
  });

  await test.step("drones that would hide each other are one number, but none that is lost", async () => {
    for (let press = 0; press < 5; press += 1) await page.keyboard.press("Escape");
    const zoomOut = page.getByRole("button", { name: "Zoom out" });
    // A click while the map still moves zooms by less than a level.
    await expect(async () => {
      await zoomOut.click();
      expect(await page.locator("button.craft:visible").count()).toBeLessThan(40);
    }).toPass({ intervals: [500] });
    await expect(page.locator(".craft-cluster").first()).toBeVisible();
    await expect(page.getByRole("button", { name: /vehicle 11 Drone 11/ })).toBeVisible();
  });
  await page.screenshot({ path: "screens/fleet-64-clusters.png" });
});
