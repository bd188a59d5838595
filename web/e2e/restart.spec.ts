import { mkdtemp, rm } from "node:fs/promises";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, test } from "@playwright/test";
import { runRecon, startStation } from "./stationProcess";

/** A port that is free now, so that the station can have it again after a restart. */
function freePort(): Promise<number> {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.on("error", reject);
    server.listen(0, "127.0.0.1", () => {
      const address = server.address();
      const port = typeof address === "object" && address !== null ? address.port : 0;
      server.close(() => resolve(port));
    });
  });
}

test("a station is restarted while the page is open: it recovers, and each drone keeps its number", async ({
  page,
}) => {
  const folder = await mkdtemp(join(tmpdir(), "recon-restart-"));
  await runRecon("site", "new", folder, "--at", "41.9012,-93.6034", "--ground-altitude-m", "275");
  const ports = ["--http-port", String(await freePort()), "--link-port", String(await freePort())];
  let station = await startStation("--site", folder, ...ports);
  try {
    await page.goto(station.url);
    const list = page.getByRole("complementary", { name: "Vehicles" }).locator("li");
    await expect(list).toHaveCount(3);
    const named = () =>
      list
        .getByRole("checkbox")
        .evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
    const numbered = [1, 2, 3].map((number) => `Add ${number} Drone ${number} to the selection`);
    await expect.poll(named).toEqual(numbered);
    await page.keyboard.press("2");

    await station.stop();
    await expect(page.getByText("No connection to the station.")).toBeVisible();

    station = await startStation("--site", folder, ...ports);
    await expect(page.getByText("No connection to the station.")).toHaveCount(0);
    await expect(list).toHaveCount(3);
    await expect.poll(named).toEqual(numbered);
    await page.keyboard.press("2");
    await expect(page.getByRole("checkbox", { name: /Drone 2/ })).toBeChecked();
  } finally {
    await station.stop();
    await rm(folder, { recursive: true });
  }
});
