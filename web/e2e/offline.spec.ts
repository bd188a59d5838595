import { expect, test } from "@playwright/test";

test.use({ serviceWorkers: "allow" });

test("opens without a station, says so, and has kept nothing that a station said", async ({
  page,
  context,
}) => {
  await page.goto("/");
  await page.waitForFunction(() => navigator.serviceWorker.controller !== null);
  await context.setOffline(true);
  await page.reload();
  await expect(page.getByText("No connection to the station.")).toBeVisible();
  await expect(page.getByText("No data received yet.")).toBeVisible();
  await expect(page.locator("button.craft")).toHaveCount(0);
  const kept = await page.evaluate(async () => {
    const all = await Promise.all((await caches.keys()).map((name) => caches.open(name)));
    const requests = await Promise.all(all.map((cache) => cache.keys()));
    return requests.flat().map(({ url }) => new URL(url).pathname);
  });
  expect(kept).toContain("/index.html");
  expect(kept.filter((path) => path.includes("/api"))).toEqual([]);
});
