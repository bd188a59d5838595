import { expect, type Page, test } from "@playwright/test";
import { drawnShare } from "./mapPicture";
import { openPanel } from "./openPanel";
import { type RunningStation, startStation } from "./stationProcess";

/** Landing from 50 m takes most of a minute. */
const LANDS_WITHIN_MS = 120_000;

/** The imaging drone renders its first frame before it connects, which is slow on a busy machine. */
const CONNECT_WITHIN_MS = 180_000;

let station: RunningStation;

test.beforeAll(async () => {
  test.setTimeout(240_000);
  station = await startStation();
});

test.afterAll(async () => {
  await station?.stop();
});

/** Records the hosts the page contacts and its errors. */
function record(page: Page) {
  const recorded = { hosts: new Set<string>(), errors: [] as string[] };
  const note = (url: string) => {
    if (!/^(blob|data):/.test(url)) recorded.hosts.add(new URL(url).hostname);
  };
  page.on("request", (request) => note(request.url()));
  page.on("websocket", (socket) => note(socket.url()));
  page.on("pageerror", (error) => recorded.errors.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") recorded.errors.push(message.text());
  });
  return recorded;
}

test("shows four vehicles over their field, and lands one on command", async ({ page }) => {
  test.setTimeout(LANDS_WITHIN_MS + CONNECT_WITHIN_MS + 60_000);
  const recorded = record(page);
  await page.goto(station.url);

  await test.step("four vehicles are on the map, and those flying rows move", async () => {
    const vehicles = page.locator("button.craft");
    await expect(vehicles).toHaveCount(4, { timeout: CONNECT_WITHIN_MS });
    const places = () =>
      vehicles.evaluateAll((all) => all.map((one) => (one as HTMLElement).style.transform));
    const before = await places();
    await expect
      .poll(async () => (await places()).filter((place, index) => place !== before[index]).length)
      .toBeGreaterThan(1);
  });

  await openPanel(page, "Orders");
  await test.step("each is listed, and the bar says that they are simulated", async () => {
    const list = page.getByRole("complementary", { name: "Vehicles" }).locator("li");
    await expect(list).toHaveCount(4);
    await expect(page.locator(".bar-simulation")).toHaveText("Simulation");
  });

  await test.step("the ground image is below them", async () => {
    await expect(page.getByText(/Ground image: frame \d+/)).toBeVisible();
    await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.1);
  });

  await test.step("a land order is confirmed by a hold, then by telemetry", async () => {
    const row = page.locator(".vehicle").filter({ hasText: "Drone 1" });
    await expect(row).toContainText(/Surveying|Flying|Holding/, { timeout: CONNECT_WITHIN_MS });
    await page
      .getByRole("button", { name: /Drone 1/, pressed: false })
      .first()
      .click();
    const land = page.getByRole("button", { name: /^Land, hold 1.5 s: Drone 1$/ });
    await land.hover();
    await page.mouse.down();
    const command = page.getByTestId(/^command-\d+$/).filter({ hasText: "Land Drone 1" });
    await expect(command).toHaveCount(1);
    await page.mouse.up();
    // A busy station may answer later than the page waits for; the command list shows the order.
    await expect(page.getByText(/^Land Drone 1: |did not answer within/)).toBeVisible();
    const phase = command.getByTestId("phase");
    await expect(phase).toHaveText(/Confirmed|Done/, { timeout: LANDS_WITHIN_MS });
    await expect(command.getByLabel("Command history")).toHaveText(
      /queued .*sent .*acknowledged .*confirmed/,
    );
  });

  await test.step("all stop reaches all flying vehicles", async () => {
    // The bar counts what its word says, here perhaps those that land: the list tells who flies.
    const doing = await page.locator(".vehicle-doing").allTextContents();
    const flying = doing.filter((text) => !text.startsWith("On the ground")).length;
    await page.getByRole("button", { name: /^All stop/ }).click();
    // Of a busy station that answers late the guard is asked too: then each vehicle has two.
    const stops = page.getByTestId(/^command-\d+$/).filter({ hasText: /^Hover / });
    const stopped = async () => {
      const texts = await stops.allTextContents();
      return new Set(texts.map((text) => /^Hover (Drone \d|Imager)/.exec(text)?.[1])).size;
    };
    await expect.poll(stopped).toBe(flying);
  });

  expect([...recorded.hosts]).toEqual(["127.0.0.1"]);
  expect(recorded.errors).toEqual([]);
});
