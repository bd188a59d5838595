import { expect, type Locator, type Page, test } from "@playwright/test";
import { area } from "../src/testing/fakeState";
import { axeFaults } from "./axe";
import { CHECKLIST, fencedState } from "./fake/fencedState";
import { FakeStation } from "./fake/station";
import { cornerFaults, overlaps } from "./layoutFaults";
import { faintTexts, smallTargets, smallTexts } from "./legibility";
import { openPanel } from "./openPanel";
import { inEachTheme } from "./themes";

/** A phone's and a laptop's page, pixels. */
const SIZES = [
  [360, 740],
  [1440, 900],
] as const;

test.use({ viewport: { width: 1440, height: 900 } });

/** Opens the page with a station that keeps sending states. */
async function open(page: Page): Promise<FakeStation> {
  const fake = await FakeStation.behind(page, fencedState(0));
  fake.preflight = CHECKLIST;
  const begin_ms = performance.now();
  const timer = setInterval(
    () => fake.send(fencedState((performance.now() - begin_ms) / 1000)),
    500,
  );
  page.once("close", () => clearInterval(timer));
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

test("draws fences with heights, pads, a hazard area and the target of a steered vehicle", async ({
  page,
}) => {
  await open(page);
  await expect(page.getByText("Boundary", { exact: true })).toBeVisible();
  await expect(page.getByText("Keep out: Barn")).toBeVisible();
  await expect(page.getByText("Height limit: Power line, 45 m to 90 m above ground")).toBeVisible();
  await expect(page.locator(".pad")).toHaveCount(2);
  await expect(page.getByText("2 Birch flying here, ↥ 42 m ATO")).toBeVisible();
  await expect(page.getByText("Separation hold is OFF.")).toBeVisible();
});

test("labels of areas leave each other free on a phone", async ({ page }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  const state = fencedState(0);
  const heights = { floor_m: 45, ceiling_m: 90, datum: "ground" } as const;
  const areas = [
    area("boundary", [0, 0], 190),
    area("height", [150, 160], 60, { name: "Power line", ...heights }),
    area("keep_out", [-150, -160], 60),
  ];
  await FakeStation.behind(page, { ...state, site: state.site && { ...state.site, areas } });
  await page.goto("/");
  await expect(page.getByText("Boundary", { exact: true })).toBeVisible();
  await expect(page.getByText(/^Height limit: Power line/)).toBeVisible();
  await expect(page.getByText("Keep out: Barn")).toBeVisible();
  const frames = await page
    .locator(".area-label")
    .evaluateAll((labels) =>
      labels.map((label) => label.getBoundingClientRect().toJSON() as DOMRect),
    );
  const meet = (a: DOMRect, b: DOMRect) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  for (const [index, frame] of frames.entries())
    expect(frames.slice(index + 1).filter((other) => meet(frame, other))).toEqual([]);
});

test("takes over a vehicle, overrides its checklist and clears a hazard area", async ({ page }) => {
  const fake = await open(page);
  await page.keyboard.press("1");
  await page.keyboard.press("d");
  await hold(page, page.getByRole("button", { name: "Take over, hold briefly: 1 Alder" }), () =>
    expect.poll(() => fake.requests.length).toBe(1),
  );
  await expect(page.getByText("→ Write go_home_height_m")).toBeVisible();
  const override = page.getByRole("button", {
    name: "Override the checklist, hold 1.5 s: 1 Alder",
  });
  await expect(override).toHaveAttribute("aria-disabled", "true");
  await page.getByLabel("Reason for flying missions anyway").fill("height read off the app");
  await hold(page, override, () => expect.poll(() => fake.requests.length).toBe(2));
  await page.keyboard.press("3");
  await hold(
    page,
    page.getByRole("button", { name: "Clear hazard area, hold 1.5 s: 3 Cedar" }),
    () => expect.poll(() => fake.requests.length).toBe(3),
  );
  expect(fake.requests).toEqual([
    ["/api/vehicle/authority?serial=SN-001", { holder: "operator", take_over: false }],
    ["/api/vehicle/preflight/override?serial=SN-001", { reason: "height read off the app" }],
    ["/api/vehicle/hazard/dismiss?serial=SN-003", null],
  ]);
});

test("flies a vehicle to a target on the map only if the gate allows it", async ({ page }) => {
  const fake = await open(page);
  const reason = "path crosses keep-out zone Barn";
  fake.checkResult = { accepted: false, rule: "keep_out", reason };
  await page.keyboard.press("1");
  await page.keyboard.press("g");
  await page.locator(".map-canvas").click({ position: { x: 600, y: 420 } });
  await expect(page.getByText(`Refused: ${reason}`)).toBeVisible();
  await expect(page.locator(".fly-course")).toHaveText(/m, bearing \d{3}°, about/);
  const go = page.getByRole("button", { name: "Fly there and hold, hold 1.5 s: 1 Alder" });
  await expect(go).toHaveAttribute("aria-disabled", "true");
  fake.checkResult = {};
  await expect(page.getByText("Allowed by the safety gate.")).toBeVisible();
  await hold(page, go, () => expect.poll(() => fake.orders.length).toBe(1));
  const [order] = fake.orders;
  expect(order).toMatchObject({ serials: ["SN-001"], takeoff: false, order: { kind: "goto" } });
  expect(order?.owner).toMatch(/^[0-9a-f]{32}$/);
  await page.locator("body").press("Escape");
  await expect(page.locator(".fly")).toBeHidden();

  await test.step("and draws a mission, whose points are dragged", async () => {
    await page.keyboard.press("m");
    const map = page.locator(".map-canvas");
    for (const y of [440, 330]) await map.click({ position: { x: 560, y } });
    const point = page.getByRole("button", { name: /^Point 2, / });
    const before = await point.boundingBox();
    await point.dragTo(map, { targetPosition: { x: 560, y: 410 }, steps: 4 });
    await expect
      .poll(async () => (await point.boundingBox())?.y)
      .toBeGreaterThan((before?.y ?? 0) + 50);
    expect(await axeFaults(page)).toEqual([]);
    const fly = page.getByRole("button", { name: "Fly the mission, hold 1.5 s: 1 Alder" });
    await expect(fly).toHaveAttribute("aria-disabled", "false");
    await hold(page, fly, () => expect.poll(() => fake.orders.length).toBe(2));
    const waypoints = [{}, {}];
    const sent = { serials: ["SN-001"], takeoff: false, order: { kind: "mission", waypoints } };
    expect(fake.orders[1]).toMatchObject(sent);
  });
});

test("returns the fleet in layers and shows waiting and excluded vehicles", async ({ page }) => {
  const fake = await open(page);
  await openPanel(page, "Return in layers");
  await hold(
    page,
    page.getByRole("button", { name: "Return all, hold 1.5 s: every vehicle, in layers" }),
    () => expect.poll(() => fake.requests).toEqual([["/api/fleet-return", { serials: null }]]),
  );
  await expect(page.getByTestId("returning-SN-002")).toContainText("pad in use by Alder");
  await expect(page.getByTestId("returning-SN-003")).toContainText("not included");
});

test("is legible with fences and fly here in each theme", async ({ page }) => {
  await page.setViewportSize({ width: 360, height: 740 });
  await open(page);
  await page.keyboard.press("1");
  await page.keyboard.press("g");
  await page.getByRole("button", { name: "Use map centre" }).click();
  await expect(page.getByText("Allowed by the safety gate.")).toBeVisible();
  await inEachTheme(page, async (theme) => {
    for (const [width, height] of SIZES) {
      await page.setViewportSize({ width, height });
      const where = `${theme.name}, ${width} px wide`;
      expect(await smallTexts(page), where).toEqual([]);
      expect(await smallTargets(page), where).toEqual([]);
      expect(await faintTexts(page), where).toEqual([]);
      expect(await cornerFaults(page), where).toEqual([]);
      expect(await overlaps(page, ".fly button, .orders button"), where).toEqual([]);
    }
  });
});
