import { expect, type Locator, type Page, test } from "@playwright/test";
import { CHECKLIST, fencedState } from "./fake/fencedState";
import { FakeStation } from "./fake/station";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { LOOKS, wear } from "./looks";

/** Opens the page over a station that goes on speaking. */
async function open(page: Page): Promise<FakeStation> {
  const fake = await FakeStation.behind(page, fencedState(0));
  fake.preflight = CHECKLIST;
  const begin_ms = performance.now();
  const talk = setInterval(() => fake.say(fencedState((performance.now() - begin_ms) / 1000)), 100);
  page.once("close", () => clearInterval(talk));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(4);
  return fake;
}

async function hold(page: Page, button: Locator, until: () => Promise<void>): Promise<void> {
  await button.focus();
  await page.keyboard.down("Enter");
  await until();
  await page.keyboard.up("Enter");
}

test("draws fences with their heights, pads, a hazard area and a steered vehicle's target", async ({
  page,
}) => {
  await open(page);
  await expect(page.getByText("Boundary", { exact: true })).toBeVisible();
  await expect(page.getByText("Keep out: Barn")).toBeVisible();
  await expect(page.getByText("Heights: Power line, 45 m to 90 m above ground")).toBeVisible();
  await expect(page.locator(".pad")).toHaveCount(2);
  await expect(page.getByText("2 Birch flies here, ↥ 42 m")).toBeVisible();
  await expect(page.getByText("Separation holds are OFF.")).toBeVisible();
});

test("takes a vehicle over, overrides its checklist and dismisses a hazard area", async ({
  page,
}) => {
  const fake = await open(page);
  await page.keyboard.press("1");
  await hold(page, page.getByRole("button", { name: "Take over 1 Alder" }), () =>
    expect.poll(() => fake.said.length).toBe(1),
  );
  await expect(page.getByText("→ Write go_home_height_m")).toBeVisible();
  const override = page.getByRole("button", { name: "Override the checklist of 1 Alder" });
  await expect(override).toHaveAttribute("aria-disabled", "true");
  await page.getByLabel("Fly missions all the same, because").fill("height read off the app");
  await hold(page, override, () => expect.poll(() => fake.said.length).toBe(2));
  await page.keyboard.press("3");
  await hold(page, page.getByRole("button", { name: "Dismiss the hazard of 3 Cedar" }), () =>
    expect.poll(() => fake.said.length).toBe(3),
  );
  expect(fake.said).toEqual([
    ["/api/vehicles/SN-001/authority", { holder: "operator" }],
    ["/api/vehicles/SN-001/preflight/override", { reason: "height read off the app" }],
    ["/api/vehicles/SN-003/hazard/dismiss", null],
  ]);
});

test("flies a vehicle to a press on the map only when the gate allows it", async ({ page }) => {
  const fake = await open(page);
  const reason = "the way leads through the keep-out zone Barn";
  fake.check = { accepted: false, rule: "keep_out", reason };
  await page.keyboard.press("1");
  await page.keyboard.press("g");
  await page.locator(".map-canvas").click({ position: { x: 420, y: 120 } });
  await expect(page.getByText(`Refused (keep out): ${reason}`)).toBeVisible();
  await expect(page.locator(".fly-course")).toHaveText(/m towards \d{3}°, about/);
  const go = page.getByRole("button", { name: "Fly 1 Alder there and hold" });
  await expect(go).toHaveAttribute("aria-disabled", "true");
  fake.check = {};
  await expect(page.getByText("The safety gate allows it as of now.")).toBeVisible();
  await hold(page, go, () => expect.poll(() => fake.orders.length).toBe(1));
  const [given] = fake.orders;
  expect(given).toMatchObject({ serials: ["SN-001"], takeoff: false, order: { kind: "goto" } });
  expect(given?.owner).toMatch(/^[0-9a-f]{32}$/);
  await page.locator("body").press("Escape");
  await expect(page.locator(".fly")).toBeHidden();
});

test("calls the fleet home in layers and tells who waits and who is left out", async ({ page }) => {
  const fake = await open(page);
  await hold(page, page.getByRole("button", { name: "Return all vehicles in layers" }), () =>
    expect.poll(() => fake.said).toEqual([["/api/fleet-return", { serials: null }]]),
  );
  await expect(page.getByTestId("returning-SN-002")).toContainText("its pad is in use by Alder");
  await expect(page.getByTestId("returning-SN-003")).toContainText("is left out");
});

for (const look of LOOKS) {
  for (const [width, height] of [
    [1440, 900],
    [360, 740],
  ] as const) {
    test(`is legible with all of it: ${look.name}, ${width} px wide`, async ({ page }) => {
      await page.setViewportSize({ width, height });
      await page.emulateMedia({ colorScheme: look.colorScheme });
      await open(page);
      await wear(page, look);
      await page.keyboard.press("1");
      await page.keyboard.press("g");
      await page.getByRole("button", { name: "Aim at the map's middle" }).click();
      await expect(page.getByText("The safety gate allows it as of now.")).toBeVisible();
      await expect(page.getByText("→ Write go_home_height_m")).toBeVisible();
      expect(await smallTexts(page)).toEqual([]);
      expect(await smallTargets(page)).toEqual([]);
      expect(await faintTexts(page)).toEqual([]);
      expect(await cornerFaults(page)).toEqual([]);
      expect(await overlaps(page, ".fly button, .orders button")).toEqual([]);
      await page.screenshot({ path: `screens/fences-${look.name}-${width}.png` });
    });
  }
}
