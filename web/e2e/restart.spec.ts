import { mkdtemp, rm } from "node:fs/promises";
import { type AddressInfo, createServer, type Server } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, test } from "@playwright/test";
import { runRecon, startStation } from "./stationProcess";

/** Listens on a port, 0 for any; undefined if it is taken. */
function listening(port: number): Promise<Server | undefined> {
  return new Promise((resolve) => {
    const server = createServer();
    server.once("error", () => resolve(undefined));
    server.listen(port, "127.0.0.1", () => resolve(server));
  });
}

function portOf(server: Server | undefined): number {
  return (server?.address() as AddressInfo | null | undefined)?.port ?? 0;
}

/** Ports for the console and for apps, free now with the guard's, so that they can be had again. */
async function freePorts(): Promise<[number, number]> {
  const held: (Server | undefined)[] = [];
  try {
    for (;;) {
      const http = await listening(0);
      // The guard's port is the one beside the console's.
      const guard = await listening(portOf(http) + 1);
      const apps = await listening(0);
      held.push(http, guard, apps);
      if (http && guard && apps) return [portOf(http), portOf(apps)];
    }
  } finally {
    for (const server of held) server?.close();
  }
}

test("a station is restarted while the page is open: it recovers, and each drone keeps its number", async ({
  page,
}) => {
  const folder = await mkdtemp(join(tmpdir(), "recon-restart-"));
  await runRecon("site", "new", folder, "--at", "41.9012,-93.6034", "--ground-altitude-m", "275");
  const [httpPort, linkPort] = await freePorts();
  const ports = ["--http-port", `${httpPort}`, "--link-port", `${linkPort}`];
  let station = await startStation("--site", folder, ...ports);
  try {
    await page.goto(station.url);
    const list = page.getByRole("complementary", { name: "Vehicles" }).locator("li");
    await expect(list).toHaveCount(3);
    const named = () =>
      list
        .getByRole("checkbox")
        .evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
    const numbered = [1, 2, 3].map((number) => `Add Drone ${number} to the selection`);
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
