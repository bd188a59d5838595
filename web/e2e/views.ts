import { expect, type Page } from "@playwright/test";
import type { ReplayView, StationState, TimelineEntryView } from "../src/protocol";
import { flownRegion } from "../src/testing/fakeField";
import { photoJob } from "../src/testing/fakeFlights";
import { link, vehicle, zone } from "../src/testing/fakeState";
import { english } from "../src/text/en";
import { busyState } from "./fake/busyState";
import { DRAWING, FIT, FROZEN, REFUSED_VEHICLE, VEHICLES } from "./fake/drawnSite";
import { CHECKLIST, fencedState } from "./fake/fencedState";
import { fieldPicture } from "./fake/picture";
import { FakeStation } from "./fake/station";
import { surveyedState } from "./fake/surveyedState";
import { markOnePoint } from "./markedPoints";
import { openPanel } from "./openPanel";

/** Each panel of the menu: a new one is visited without being named here. */
const { vehicle: _byKey, ...LISTED } = english.panels.titles;
const PANELS = Object.values(LISTED);

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
  fake.flown = { ...fake.flown, regions: [flownRegion({ gaps_m2: 7_000 })] };
  await page.route("**/api/timeline?**", (route) =>
    route.fulfill({ json: { entries: [ENTRY], has_more: true } }),
  );
  const marks = { marks: [], read_share: 1 };
  await page.route("**/api/replay/marks", (route) => route.fulfill({ json: marks }));
  await page.route("**/api/photos", (route) => route.fulfill({ json: { job: photoJob() } }));
  await page.route("**/api/photos/files/*", async (route) =>
    route.fulfill({ body: await fieldPicture(page), contentType: "image/png" }),
  );
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

/** Opens the console and goes through every view; `visit` is called in each. */
export async function visitViews(
  page: Page,
  visit: (view: string) => Promise<void>,
): Promise<void> {
  const { fake, show } = await openConsole(page);
  await visit("Fly");
  await flyViews(page, visit);
  for (const panel of PANELS) await panelViews(page, panel, visit);
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  await visit("Menu");
  await page.keyboard.press("Escape");
  await page.keyboard.press("?");
  await visit("Help");
  await page.keyboard.press("Escape");
  await lock(page);
  await visit("Locked");
  await unlock(page);
  show({ stop_latch: { by: "anna", age_s: 2, released: [] } });
  await expect(page.getByRole("button", { name: /^Release all/ })).toBeVisible();
  await visit("All stop in force");
  show({ stop_latch: null, replay: REPLAY });
  await expect(page.getByRole("slider", { name: "Position in the record" })).toBeVisible();
  await visit("Replay");
  show({ replay: null });
  await expect(page.getByRole("button", { name: /^All stop/ })).toBeVisible();
  await fake.goOffline();
  await expect(page.getByText("No connection to the station.")).toBeVisible();
  await visit("Connection lost");
}

/** Locks the page by its menu, which a phone has too. */
export async function lock(page: Page): Promise<void> {
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  const menu = page.getByRole("region", { name: "Menu", exact: true });
  await menu.getByRole("button", { name: "Lock the page" }).click();
  await expect(page.getByRole("button", { name: /^Unlock/ })).toBeFocused();
}

/** Unlocks it by a held key. */
export async function unlock(page: Page): Promise<void> {
  const button = page.getByRole("button", { name: /^Unlock/ });
  await button.focus();
  await page.keyboard.down("Enter");
  await expect(button).toHaveCount(0);
  await page.keyboard.up("Enter");
}

async function flyViews(page: Page, visit: (view: string) => Promise<void>): Promise<void> {
  await page.keyboard.press("1");
  await page.keyboard.press("d");
  await visit("Vehicle details");
  await page.keyboard.press("d");
  await page.keyboard.press("g");
  await page.getByRole("button", { name: "Use map centre" }).press("Enter");
  await page.getByText("Nudge in small steps").click();
  await visit("Fly here");
  await page.keyboard.press("g");
  await page.keyboard.press("m");
  await page.getByRole("button", { name: "At map centre" }).press("Enter");
  await visit("Mission");
  await page.getByRole("button", { name: "Clear points" }).press("Enter");
  await page.getByRole("button", { name: "Leave the mission" }).press("Enter");
}

async function panelViews(
  page: Page,
  panel: string,
  visit: (view: string) => Promise<void>,
): Promise<void> {
  const panels = page.locator(".dock-right .panel");
  await expect(panels).toHaveCount(0);
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
  await visit(panel);
  if (panel === "Cameras") {
    const large = page.getByRole("region", { name: /^Camera of/ });
    const enlarge = page.getByRole("button", { name: /^Enlarge the picture/ });
    await enlarge.first().click();
    await expect(large.getByRole("img")).toBeVisible();
    await visit("A large picture");
    await page.keyboard.press("Escape");
    await expect(large).toHaveCount(0);
  }
  await panels.getByRole("button", { name: /^Close ./ }).click();
}
