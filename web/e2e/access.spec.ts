import { expect, type Page, test } from "@playwright/test";
import type { ReplayView, StationState, TimelineEntryView } from "../src/protocol";
import { link, vehicle, zone } from "../src/testing/fakeState";
import { axeFaults } from "./axe";
import { busyState } from "./fake/busyState";
import { DRAWING, FIT, FROZEN, REFUSED_VEHICLE, VEHICLES } from "./fake/drawnSite";
import { CHECKLIST, fencedState } from "./fake/fencedState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { surveyedState } from "./fake/surveyedState";
import { smallTargets } from "./legibility";
import { markOnePoint } from "./markedPoints";
import { openPanel } from "./openPanel";
import { THEMES } from "./themes";

/** A laptop's and a phone's page, pixels. */
const SIZES = [
  { width: 1440, height: 900 },
  { width: 390, height: 844 },
] as const;

const PANELS = [
  "Alarms",
  "Survey",
  "Cameras",
  "Imaging drone",
  "Temporary zones",
  "Edit site",
  "Site vehicles",
  "Calibrate camera",
  "Return in layers",
  "Orders",
  "Timeline",
  "Links",
  "After the flight",
  "Station and site",
] as const;

/** An app that waits to be admitted. */
const WAITING = link(7, {
  status: "waiting",
  claimed_serial: null,
  waiting: { serial: "SN-007", age_s: 42, reason: "its serial is not listed", is_flying: true },
});

const REPLAY = {
  file: "flight-20250620T160412Z.mcap",
  duration_s: 7200,
  position_s: 600,
  speed: 1,
  is_playing: false,
  trouble: null,
} satisfies ReplayView;

/** Something in every panel at once. */
function fullState(): StationState {
  const busy = busyState(0);
  const surveyed = surveyedState(0);
  const fenced = fencedState(0);
  return {
    ...surveyed,
    site: fenced.site,
    vehicles: [
      ...surveyed.vehicles,
      vehicle(5, { ...busy.vehicles[4], number: 5 }),
      vehicle(6, {
        ...fenced.vehicles[2],
        number: 6,
        serial: "SN-006",
        name: "Fir",
        frame: busy.vehicles[0]?.frame ?? null,
      }),
    ],
    links: [...busy.links, WAITING],
    alarms: busy.alarms,
    commands: [...busy.commands, ...fenced.commands],
    fleet_return: fenced.fleet_return,
    temporary_zones: [zone(1, [50, 40]), zone(2, [-70, -40], { kind: "crewed_aircraft" })],
  };
}

const ENTRY: TimelineEntryView = {
  n: 1,
  utc: "2026-05-01T12:00:00.5Z",
  kind: "order.sent",
  by: "anna (10.0.0.2)",
  serial: "SN-001",
  vehicle: "Alder",
  text: "hover 1: sent",
};

const FLIGHT = {
  name: "flight-20250620T160412Z",
  size_bytes: 55_204_853,
  changed_at_unix_ms: 0,
  is_recording: false,
};

/** Opens the console; `show` changes the states sent from then on. */
async function openConsole(page: Page) {
  let state = fullState();
  const fake = await FakeStation.behind(page, state);
  fake.drawing = DRAWING;
  fake.vehicles = VEHICLES;
  fake.frozen = FROZEN;
  fake.fit = FIT;
  fake.showPicture(await fieldPicture(page));
  fake.vehiclesResult = REFUSED_VEHICLE;
  fake.preflight = CHECKLIST;
  await page.route("**/api/timeline?**", (route) =>
    route.fulfill({ json: { entries: [ENTRY], has_more: true } }),
  );
  const marks = { marks: [], read_share: 1 };
  await page.route("**/api/replay/marks", (route) => route.fulfill({ json: marks }));
  await page.route("**/api/flights", (route) => route.fulfill({ json: [FLIGHT] }));
  await page.addInitScript(() => localStorage.setItem("recon.panels", ""));
  await page.goto("/");
  const begin_ms = performance.now();
  const timer = setInterval(() => {
    fake.send({ ...state, time_ns: state.time_ns + (performance.now() - begin_ms) * 1e6 });
  }, 500);
  page.once("close", () => clearInterval(timer));
  await expect(page.locator("button.craft")).toHaveCount(state.vehicles.length);
  const show = (changes: Partial<StationState>) => {
    state = { ...state, ...changes };
  };
  return { fake, show };
}

/** All rules in the first theme; in the others only the colours differ. */
async function faults(page: Page): Promise<string[]> {
  const found: string[] = [...(await smallTargets(page))];
  for (const { name } of THEMES) {
    await page.evaluate((theme) => {
      document.documentElement.dataset["theme"] = theme;
    }, name);
    const wrong = await axeFaults(page, name === THEMES[0].name ? null : ["color-contrast"]);
    found.push(...wrong.map((fault) => `${name}: ${fault}`));
  }
  return found;
}

for (const size of SIZES) {
  test(`every view meets WCAG 2.2 AA in each theme: ${size.width} px`, async ({ page }) => {
    await page.setViewportSize(size);
    const { fake, show } = await openConsole(page);
    const wrong: Record<string, string[]> = {};
    const check = async (view: string) => {
      const found = await faults(page);
      if (found.length > 0) wrong[view] = found;
    };
    const panels = page.locator(".dock-right .panel");
    await page.keyboard.press("1");
    await page.keyboard.press("d");
    await check("Fly, vehicle details");
    await page.keyboard.press("d");
    await page.keyboard.press("g");
    await page.getByRole("button", { name: "Use map centre" }).press("Enter");
    await page.getByText("Nudge in small steps").click();
    await check("Fly here");
    await page.keyboard.press("g");
    await expect(panels).toHaveCount(0);
    for (const panel of PANELS) {
      await openPanel(page, panel);
      await expect(panels).toHaveCount(1);
      if (panel === "Edit site") {
        await page.getByRole("button", { name: "Edit", exact: true }).click();
        await page.getByRole("button", { name: /^farmyard/ }).click();
      }
      if (panel === "Site vehicles") {
        await page.getByRole("textbox", { name: "Name of SN-009" }).fill("Birch");
        await page.getByRole("textbox", { name: "Number of SN-009" }).fill("1");
        await page.keyboard.press("Tab");
        await expect(page.getByText("Number: 1 is the number of Alder too")).toBeVisible();
      }
      if (panel === "Calibrate camera") await markOnePoint(page);
      await check(panel);
      if (panel === "Cameras") {
        await page
          .getByRole("button", { name: /^Enlarge the picture/ })
          .first()
          .click();
        await expect(page.getByRole("region", { name: /^Camera of/ })).toBeVisible();
        await check("A large picture");
        await page.keyboard.press("Escape");
        await expect(page.getByRole("region", { name: /^Camera of/ })).toHaveCount(0);
      }
      await panels.getByRole("button", { name: /^Close ./ }).click();
    }
    await page.getByRole("button", { name: "Menu", exact: true }).click();
    await check("Menu");
    await page.keyboard.press("Escape");
    await page.keyboard.press("?");
    await check("Help");
    await page.keyboard.press("Escape");
    show({ stop_latch: { by: "anna", age_s: 2, released: [] } });
    await expect(page.getByRole("button", { name: /^Release all/ })).toBeVisible();
    await check("All stop in force");
    show({ stop_latch: null, replay: REPLAY });
    await expect(page.getByRole("slider", { name: "Position in the record" })).toBeVisible();
    await check("Replay");
    show({ replay: null });
    await expect(page.getByRole("button", { name: /^All stop/ })).toBeVisible();
    await fake.goOffline();
    await expect(page.getByText("No connection to the station.")).toBeVisible();
    await check("Connection lost");
    expect(wrong).toEqual({});
  });
}

test("the login meets WCAG 2.2 AA in each theme", async ({ page }) => {
  await page.routeWebSocket(/\/api\/stream/, (socket) =>
    socket.close({ code: 4401, reason: "token missing" }),
  );
  await page.route("**/api/**", (route) => route.abort());
  await page.goto("/");
  await expect(page.getByRole("dialog", { name: "Log in to Recon" })).toBeVisible();
  await page.getByLabel("Token, or the whole address with it").fill("wrong");
  await page.getByRole("button", { name: "Log in" }).click();
  await page.getByRole("button", { name: "Log in" }).focus();
  for (const size of SIZES) {
    await page.setViewportSize(size);
    expect(await faults(page), `${size.width} px`).toEqual([]);
  }
});
