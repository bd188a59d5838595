import { expect, type Page, test } from "@playwright/test";
import { drawnShare } from "./mapPicture";
import { type RunningStation, startStation } from "./runningStation";

/** From 50 m a vehicle needs most of a minute to be down. */
const LANDS_WITHIN_MS = 120_000;

/** The eye draws its first frame before it connects, which takes a busy machine a while. */
const CONNECT_WITHIN_MS = 60_000;

let station: RunningStation;

test.beforeAll(async () => {
  test.setTimeout(120_000);
  station = await startStation();
});

test.afterAll(async () => {
  await station?.stop();
});

/** Everything the page asked for, and everything it complained of. */
function watch(page: Page) {
  const seen = { hosts: new Set<string>(), complaints: [] as string[] };
  const note = (url: string) => {
    if (!/^(blob|data):/.test(url)) seen.hosts.add(new URL(url).hostname);
  };
  page.on("request", (request) => note(request.url()));
  page.on("websocket", (socket) => note(socket.url()));
  page.on("pageerror", (error) => seen.complaints.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") seen.complaints.push(message.text());
  });
  return seen;
}

test("shows four vehicles over their field, and lands one that is told to", async ({ page }) => {
  test.setTimeout(LANDS_WITHIN_MS + CONNECT_WITHIN_MS + 60_000);
  const seen = watch(page);
  await page.goto(station.url);

  await test.step("four vehicles are on the map, and those that fly rows move", async () => {
    const vehicles = page.locator("button.craft");
    await expect(vehicles).toHaveCount(4, { timeout: CONNECT_WITHIN_MS });
    const places = () =>
      vehicles.evaluateAll((all) => all.map((one) => (one as HTMLElement).style.transform));
    const before = await places();
    await expect
      .poll(async () => (await places()).filter((place, index) => place !== before[index]).length)
      .toBeGreaterThan(1);
  });

  await test.step("each is listed, marked as simulated", async () => {
    const list = page.getByRole("complementary", { name: "Vehicles" }).locator("li");
    await expect(list).toHaveCount(4);
    await expect(list.getByText("SIM", { exact: true })).toHaveCount(4);
    await expect(page.getByText("SIMULATION")).toBeVisible();
  });

  await test.step("the ground image lies under them", async () => {
    await expect(page.getByText(/Ground image: frame \d+/)).toBeVisible();
    await expect.poll(() => drawnShare(page)).toBeGreaterThan(0.2);
  });

  await test.step("a land order is confirmed by holding, and then by telemetry", async () => {
    await page
      .getByRole("button", { name: /Drone 1/, pressed: false })
      .first()
      .click();
    const land = page.getByRole("button", { name: /^Land \d+ Drone 1: hold/ });
    await land.hover();
    await page.mouse.down();
    await expect(page.getByText(/^Accepted: Drone 1 SIM \(command \d+\)$/)).toBeVisible();
    await page.mouse.up();
    const command = page.getByTestId(/^command-\d+$/).filter({ hasText: "Land Drone 1" });
    await expect(command).toHaveCount(1);
    const phase = command.getByTestId("phase");
    await expect(phase).toHaveText("Confirmed", { timeout: LANDS_WITHIN_MS });
    await expect(command.getByLabel("Its life so far")).toHaveText(
      /queued .*sent .*acknowledged .*confirmed/,
    );
  });

  await test.step("all stop reaches everything that still flies", async () => {
    const count = /^(\d) of 4 flying$/.exec(
      (await page.getByText("of 4 flying").textContent()) ?? "",
    );
    await page.getByRole("button", { name: /^All stop/ }).click();
    const accepted = page.getByRole("status").getByText(/^Accepted: /);
    await expect(accepted).toHaveText(new RegExp(`^([^(]+\\(command \\d+\\)){${count?.[1]}}$`));
  });

  expect([...seen.hosts]).toEqual(["127.0.0.1"]);
  expect(seen.complaints).toEqual([]);
});
