import { expect, type Page, test } from "@playwright/test";
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
    await expect(rows.first(), "lost ones come first").toContainText("Drone 11");
    for (const key of ["4", "7", "Enter"]) await page.keyboard.press(key);
    await expect(page.locator(".vehicle.is-selected")).toHaveText(/Drone 47/);
    await page.getByLabel("Search by number, name or serial").fill("Drone 64");
    await expect(rows).toHaveCount(1);
    await page.keyboard.press("Enter");
    await expect(page.locator(".vehicle.is-selected")).toHaveText(/Drone 64/);
    await page.getByLabel("Search by number, name or serial").fill("");
    await page.getByLabel("Show").selectOption("With a problem");
    await expect(rows).toHaveCount(2);
    await page.getByLabel("Show").selectOption("All");
    await page.getByLabel("Group by").selectOption("What they do");
    await expect(page.getByRole("heading", { name: "On the ground 8" })).toBeVisible();
  });

  await test.step("31 alarms of one cause have one acknowledgement", async () => {
    await page.getByRole("button", { name: "31 alarms", exact: true }).click();
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
    await expect(page.getByRole("button", { name: /vehicle Drone 11/ })).toBeVisible();
  });
});

test("a height on the map is in sight as a whole or not shown, wherever the map is moved", async ({
  page,
}) => {
  await page.setViewportSize({ width: 390, height: 844 });
  await FakeStation.behind(page, fleetState(12, 0));
  await page.goto("/");
  const map = page.getByRole("region", { name: "Map" }).first();
  await expect(page.locator("button.craft")).toHaveCount(12);
  await page.getByRole("button", { name: "Zoom in" }).click();
  await expect(
    page.getByRole("button", { name: /out of sight: .*Move the map there/i }).first(),
  ).toBeVisible();
  let shown = 0;
  for (const key of ["ArrowLeft", "ArrowUp", "ArrowRight", "ArrowRight", "ArrowDown"]) {
    await map.locator("canvas").first().press(key);
    await expect(async () => {
      const { count, cut } = await cutLabels(page);
      expect(cut).toEqual([]);
      shown += count;
    }).toPass();
  }
  expect(shown).toBeGreaterThan(5);
});

/** The heights on the map, and those of them that the window's edge or a panel or button cuts. */
function cutLabels(page: Page): Promise<{ count: number; cut: string[] }> {
  return page.evaluate(() => {
    const boxes = (selector: string) =>
      [...document.querySelectorAll<HTMLElement>(selector)].filter((one) => one.checkVisibility());
    const covers = boxes(".card, .map-tools .button, .map-notes > *").map((one) =>
      one.getBoundingClientRect(),
    );
    const labels = boxes(".craft-label");
    const isCut = ({ left, top, right, bottom }: DOMRect) =>
      left < 0 ||
      top < 0 ||
      right > innerWidth ||
      bottom > innerHeight ||
      covers.some((c) => left < c.right && c.left < right && top < c.bottom && c.top < bottom);
    return {
      count: labels.length,
      cut: labels.filter((one) => isCut(one.getBoundingClientRect())).map((one) => one.innerText),
    };
  });
}
