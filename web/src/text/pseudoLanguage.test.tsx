import type { JSX } from "solid-js";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { DisplayedGround } from "../map/groundImageLayer";
import type { OrderResult, StationState } from "../protocol";
import { baseMap, groundImage, surveyEstimate } from "../testing/fakeField";
import { orderResult } from "../testing/fakeState";
import {
  DRAWING,
  FIGURES,
  FLIGHTS,
  fullState,
  PREFLIGHT,
  REPLAY,
  TIMELINE,
  UPWIND,
} from "../testing/fullState";
import { bracketed, bracketInPlace, foreign, unbracketed } from "../testing/pseudoLanguage";
import type { RenderedPage } from "../testing/renderPage";
import { english } from "./en";

// The map itself needs WebGL; what is written on it is below.
vi.mock("../map/MapView", () => ({ MapView: () => null }));
// Before the page is loaded, which reads some of its words then.
bracketInPlace(english);
const { App } = await import("../App");
const { useConsole } = await import("../console");
const { areaText } = await import("../map/areas");
const { GroundImageNote } = await import("../map/GroundImageNote");
const { createDisplayedGround } = await import("../map/groundImageLayer");
const { LayersButton } = await import("../map/LayersButton");
const { padText } = await import("../map/padLayer");
const { sunHereText } = await import("../map/SunHere");
const { targetOf } = await import("../map/targetLayer");
const { VehicleMarker } = await import("../map/vehicleMarker");
const { createNewSite } = await import("../newSite/newSite");
const { NewSitePage } = await import("../newSite/NewSitePage");
const { PANEL_NAMES } = await import("../panels/openPanels");
const { findButton, renderPage, settled } = await import("../testing/renderPage");
const { chooseLengthUnit } = await import("./units");
const { zoneLabel } = await import("./zones");

let page: RenderedPage;
beforeEach(() => chooseLengthUnit("m"));
afterEach(() => page?.dispose());

/** The station's: a flight mode, and answers of the fakes before a test can set them. */
const KNOWN = ["auto landing", "Mini 3 Pro (12 MP)", surveyEstimate().speed_limited_by];

function expectAllBracketed() {
  expect(page.root.textContent).toContain("⟦");
  expect(unbracketed(page.root, KNOWN)).toEqual([]);
}

async function show(component: () => JSX.Element, state: StationState | null) {
  page = renderPage(component, foreign(state));
  page.showPreflight(foreign(PREFLIGHT));
  page.findUpwind(foreign(UPWIND));
  page.estimateWith(foreign(surveyEstimate({ warnings: ["Wind is near the limit"] })));
  page.timeline.entries = foreign(TIMELINE);
  page.showFlights(foreign(FLIGHTS), foreign(FIGURES));
  page.showMaps(foreign({ maps: [baseMap({ title: "Ortho photo" })], note: null }));
  page.showMarks({ marks: [], read_share: 1 });
  await settled();
}

/** The whole page, all its panels open. */
async function showPage(state: StationState | null = fullState()) {
  await show(App, state);
  for (const name of PANEL_NAMES) page.shared.panels.open(name);
  page.clock.advance(3000);
  await settled();
}

const press = (words: string) => findButton(page.root, `⟦${words}⟧`).click();

describe("the brackets", () => {
  it("are around strings, sentences and the words between elements", () => {
    const strong = document.createElement("strong");
    const words = bracketed({
      name: "Map",
      count: (count: number) => `${count} drones`,
      by: (person: JSX.Element): JSX.Element => ["by ", person],
    });
    expect([words.name, words.count(3)]).toEqual(["⟦Map⟧", "⟦3 drones⟧"]);
    expect(words.by(strong)).toEqual(["⟦by ⟧", strong]);
  });

  it("are missed in texts and names, but not in numbers, units and what the station sends", () => {
    const root = document.createElement("div");
    root.innerHTML = `<p title="old">⟦a ⟦nested⟧ one⟧ ${foreign("Alder 2")} 12.5 m ATO · 3 min 20 s</p><b>12 drones</b>`;
    expect(unbracketed(root, [])).toEqual(["<B > 12 drones", "<P > old"]);
  });
});

describe("every word of the page is the catalogue's", () => {
  it("before the first state", async () => {
    await showPage(null);
    expectAllBracketed();
  });

  it("with everything at once, whatever is selected", async () => {
    await showPage();
    expectAllBracketed();
    for (const { key } of page.shared.fleet.vehicles) {
      page.shared.selection.only(key);
      await settled();
      page.clock.advance(3000);
      await settled();
      expectAllBracketed();
    }
    page.shared.selection.all(page.shared.fleet.vehicles.map(({ key }) => key));
    page.shared.largeCamera.toggle(foreign("SN-001"));
    expect(page.root.querySelector(".camera-large")).not.toBeNull();
    expectAllBracketed();
  });

  it("in feet", async () => {
    chooseLengthUnit("ft");
    await showPage();
    page.shared.selection.only(4);
    expectAllBracketed();
  });

  it("in the menus", async () => {
    await showPage();
    for (const opener of page.root.querySelectorAll<HTMLElement>(".popover, [aria-controls]"))
      opener.click();
    press("Search, sort and filter");
    page.nameAs({
      name: "Ａ",
      role: "observer",
      is_logged_in: true,
      fingerprint: "00",
      urls: [],
    });
    expect(page.root.querySelectorAll(".menu-item").length).toBeGreaterThan(10);
    expectAllBracketed();
  });

  it("in a replay", async () => {
    await showPage(fullState({ replay: REPLAY }));
    expectAllBracketed();
    page.receive(foreign(fullState({ replay: { ...REPLAY, is_playing: true } })));
    expectAllBracketed();
    expect(document.title).toMatch(/^⟦/);
  });

  it.each([false, true])("without a connection (login needed: %s)", async (needsLogin) => {
    await showPage();
    page.connect({ kind: "lost", reason: foreign("Reason of station"), attempt: 3, needsLogin });
    page.blockSound("blocked");
    page.tick(1000);
    expectAllBracketed();
  });

  it("in the answers to orders", async () => {
    await showPage();
    page.shared.selection.all([1, 2, 3]);
    const refused = { accepted: false, rule: "flying" };
    const answers: OrderResult[][] = [
      [],
      [orderResult()],
      [orderResult(), orderResult({ ...refused, reason: "Too far" })],
      [
        orderResult({ ...refused, reason: null, vehicle_name: "" }),
        orderResult({ command_id: 14 }),
      ],
    ];
    const { serials, labels } = page.shared.targets();
    for (const answer of answers)
      for (const kind of ["hover", "camera_stop"] as const) {
        page.answerWith(foreign(answer));
        const order = page.shared.orderApi.order({ serials, order: { kind } }, labels);
        expectAllBracketed();
        await order;
        page.root.querySelector<HTMLElement>(".toast-names")?.click();
        expectAllBracketed();
      }
    await page.shared.orderApi.allStop();
    expectAllBracketed();
  });

  it("while an order is held, and in fly here", async () => {
    await showPage();
    page.shared.selection.only(1);
    const land = page.root.querySelector(".order-land");
    land?.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    expect(page.root.querySelector(".orders-to")?.textContent).toContain("⟦Keep holding to ⟧");
    expectAllBracketed();
    page.shared.flyHere.toggle();
    expectAllBracketed();
    page.shared.aim({ lon: -93.07, lat: 44.7 });
    page.clock.advance(1000);
    await settled();
    expectAllBracketed();
    page.shared.flyHere.setSpeed("x");
    expectAllBracketed();
  });

  it("while a zone is drawn", async () => {
    await showPage();
    page.shared.zoneDraft.toggle();
    for (const shape of ["circle", "outline"] as const) {
      page.shared.zoneDraft.setShape(shape);
      for (const lon of [0, 0.001, 0.002, 0.003]) {
        page.shared.aim({ lon, lat: lon ** 2 });
        expectAllBracketed();
      }
    }
  });

  it("in the editor of the site", async () => {
    await showPage();
    page.site.drawing = foreign(DRAWING);
    press("Edit");
    await settled();
    const { siteDraft } = page.shared;
    for (const { id } of siteDraft.features()) {
      siteDraft.select(id);
      expectAllBracketed();
    }
    siteDraft.addAt("survey_regions", { lon: 0, lat: 0 }, 20);
    siteDraft.draw({ layer: "keep_out", hole: true });
    page.site.imported = foreign({
      features: DRAWING.features.map(({ geometry }) => ({ name: "", geometry })),
      left_out: 2,
      reason: null,
    } as typeof page.site.imported);
    await siteDraft.readFile(new File(["x"], "9"));
    expectAllBracketed();
    page.site.response = { ...page.site.response, layers: ["boundary", "keep_out"] };
    page.clock.advance(600);
    await settled();
    expectAllBracketed();
    page.site.response = foreign({ ...page.site.response, drawing: DRAWING });
    await siteDraft.save();
    expectAllBracketed();
    await siteDraft.undoSaved();
    expectAllBracketed();
  });

  it("in the table of the site's vehicles", async () => {
    await showPage();
    const row = { serial: "SN-001", name: null, number: 1, camera: "Mini 9" };
    const undo = foreign(DRAWING.undo);
    const vehicles = foreign([{ ...row, waypoint_altitude: null }]);
    page.site.vehicles = { revision: "r1", vehicles, locked_reason: null, undo };
    await page.shared.vehicleTable.discard();
    expectAllBracketed();
    page.shared.vehicleTable.add("9");
    expectAllBracketed();
    page.site.vehiclesResponse = foreign({
      ...page.site.vehiclesResponse,
      changes: ["Added 9"],
      vehicles: page.site.vehicles,
    });
    page.clock.advance(600);
    await settled();
    expectAllBracketed();
    await page.shared.vehicleTable.save();
    expectAllBracketed();
  });

  it("in the calibration of a camera", async () => {
    await showPage();
    const surveyed = [{ name: "Gate", latitude_deg: 0, longitude_deg: 0, altitude_m: 271 }];
    page.site.frozen = foreign({ ...page.site.frozen, surveyed });
    page.site.fit = {
      ...page.site.fit,
      residuals: [{ name: "P1", col_px: 2, row_px: 1, ground_m: 1 }],
    };
    press("Freeze a frame");
    await settled();
    const { calibration } = page.shared;
    expectAllBracketed();
    calibration.markFrame({ col: 9, row: 9 });
    expectAllBracketed();
    calibration.aim({ lon: 0, lat: 0 });
    page.clock.advance(400);
    await settled();
    expectAllBracketed();
    calibration.select(null);
    calibration.aim({ lon: 0, lat: 0.001 });
    expectAllBracketed();
    await calibration.accept();
    expectAllBracketed();
  });

  it("in the records of flights", async () => {
    await showPage();
    press("Refresh");
    await settled();
    page.root.querySelector<HTMLElement>(".flights-pick")?.click();
    await settled();
    expect(page.root.querySelectorAll(".flights-figures div").length).toBeGreaterThan(5);
    expectAllBracketed();
  });
});

describe("every word of the page that makes a site is the catalogue's", () => {
  const ANSWERS = {
    folder: foreign("/Fields/north"),
    name: foreign("North"),
    reason: null,
    accepted: true,
    features: DRAWING.features,
  };

  it("whatever it has been asked", async () => {
    const newSite = createNewSite({
      fetch: async () => new Response(JSON.stringify(ANSWERS)),
      locate: () => Promise.reject(new Error()),
      wait: async () => {},
      openConsole: () => {},
    });
    await show(() => <NewSitePage newSite={newSite} />, null);
    for (const step of [newSite.begin, newSite.locate, newSite.make]) {
      await step();
      expectAllBracketed();
    }
    await newSite.readFile(new File(["x"], "9"));
    for (const changed of [
      { groundAltitude: "x" },
      { groundAltitude: "9", drones: "x" },
      { drones: "1" },
    ]) {
      newSite.change(changed);
      await newSite.make();
      expectAllBracketed();
    }
    expect(newSite.notice()?.kind).toBe("done");
  });
});

describe("every word on the map is the catalogue's", () => {
  it("in its notes and layers", async () => {
    let ground: DisplayedGround | undefined;
    const Notes = () => {
      ground = createDisplayedGround(useConsole().source);
      return (
        <>
          <LayersButton />
          <GroundImageNote shown={ground.shown()} />
        </>
      );
    };
    await show(Notes, fullState());
    page.root.querySelector("button")?.click();
    await settled();
    expectAllBracketed();
    for (const registration of ["unregistered", "registered", "lost"] as const) {
      ground?.show(groundImage({ frame_id: 12, registration }));
      for (const kind of ["shade", "forecast", "cells"] as const) {
        page.shared.overlay.show(kind);
        expectAllBracketed();
      }
    }
  });

  it("beside vehicles, areas, pads, targets and zones", () => {
    const state = foreign(fullState());
    const root = document.createElement("div");
    for (const vehicle of state.vehicles) {
      const marker = new VehicleMarker(
        vehicle.number,
        { select: () => {}, toggle: () => {} },
        root,
      );
      marker.show(vehicle, 0, false, true);
    }
    const pad = { name: "９", serial: null, altitude_m: 0, latitude_deg: 0, longitude_deg: 0 };
    const light = { number: 1, light: "sun", known_ahead_s: 50, change_chance: 1 } as const;
    const change = { change_after_s: 42, change_early_s: 3, change_late_s: 58 };
    const words = [
      ...(state.site?.areas ?? []).map(areaText),
      ...state.temporary_zones.map((zone) => zoneLabel(zone, 0)),
      ...state.vehicles.flatMap(targetOf).map(({ text }) => text),
      padText(pad, state),
      padText({ ...pad, serial: "9" }, state),
      sunHereText({ ...light, ...change }),
    ];
    root.append(...words.flatMap((one) => [one, document.createElement("br")]));
    expect(words.length).toBeGreaterThan(8);
    expect(unbracketed(root, [])).toEqual([]);
  });
});
