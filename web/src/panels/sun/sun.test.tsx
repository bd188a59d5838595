import { afterEach, describe, expect, it } from "vitest";
import type { LightSensorView, SideStepView, UpwindPlaceView } from "../../protocol";
import { groundImage, shadeLine } from "../../testing/fakeField";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { lightPercents } from "../../text/light";
import { vehicleLabel } from "../../text/names";
import { GUARD_MS } from "../guard/GuardButton";
import { SunPanel } from "./SunPanel";

let page: RenderedPage;
afterEach(() => page.dispose());

function show(changes: Parameters<typeof shadeLine>[0] = {}) {
  page = renderPage(SunPanel, station([vehicle(1)], { shade: shadeLine(changes) }));
}

const GATE: LightSensorView = {
  name: "gate",
  source: "10.0.0.9",
  latitude_deg: 41.9,
  longitude_deg: -93.6,
  value: 1480,
  age_s: 0.5,
  is_live: true,
  shows: "sun",
  map_says: "shade",
  right: 3,
  compared: 4,
};

function showSensors(...sensors: LightSensorView[]) {
  const light_sensors = {
    sensors,
    refused_lines: 1,
    problem: "10.0.0.9: line 4: no number",
    problem_age_s: 61,
  };
  page = renderPage(SunPanel, station([vehicle(1)], { shade: shadeLine(), light_sensors }));
}

describe("light sensors", () => {
  it("shows each one's value and light beside the map's, and how often the map was right", () => {
    showSensors(GATE);
    expect(find(page.root, ".light-sensors").textContent).toBe(
      "gate1480In sun. Map: shade. Right in 75\u00a0% of 4 maps.",
    );
    expect(page.root.textContent).toContain("10.0.0.9: line 4: no number (1 min 1 s ago)");
    page.age(9);
    expect(page.root.textContent).toContain("no number (1 min 10 s ago)");
  });

  it("shows a silent one as stale and never its light", () => {
    showSensors({ ...GATE, is_live: false, shows: "unknown", age_s: 61, compared: 0, right: 0 });
    expect(find(page.root, ".light-sensors").textContent).toContain("stale, 1 min 1 s ago");
    expect(page.root.textContent).not.toContain("1480");
  });

  it("says of one with a wrong clock that its clock is ahead", () => {
    showSensors({ ...GATE, is_live: false, shows: "unknown", age_s: -7200 });
    expect(find(page.root, ".light-sensors").textContent).toContain("stale, clock 2 h 0 min ahead");
  });

  it("shows none as live while the station is silent", () => {
    showSensors(GATE);
    page.age(11);
    expect(find(page.root, ".light-sensors").textContent).not.toContain("In sun");
    expect(find(page.root, ".light-sensors .is-unknown")).toBeTruthy();
  });

  it("is absent without a logger", () => {
    show();
    expect(page.root.textContent).not.toContain("Light sensors");
  });
});

describe("sun and shade", () => {
  it("shows the shares of the ground in view in sun, in shade and unknown, and their age", () => {
    show();
    expect(find(page.root, ".light-legend").textContent).toBe(
      "Sun 56\u00a0%Shade 34\u00a0%Light unknown 10\u00a0%",
    );
    expect(page.root.textContent).toContain("of the ground in view, 1.5 s ago");
    page.age(4);
    expect(page.root.textContent).toContain("5.5 s ago");
  });

  it("shows a scene of which nothing is known as unknown, not as shade", () => {
    const map = shadeLine().map;
    if (map === null) throw new Error("expected a shade map in the fake state");
    show({ map: { ...map, sunlit_share: null, in_view: { sun: 0, shade: 0, unknown: 1 } } });
    expect(find(page.root, ".light-legend").textContent).toBe(
      "Sun 0\u00a0%Shade 0\u00a0%Light unknown 100\u00a0%",
    );
    expect(find<HTMLElement>(page.root, ".light-bar .is-unknown").style.width).toBe("100%");
  });

  it("shows the motion of the shadows, if known", () => {
    show();
    expect(page.root.textContent).toContain("Shadows move at 5.1\u00a0m/s, bearing 079°.");
    page.dispose();
    const forecast = shadeLine().forecast;
    if (forecast === null) throw new Error("expected a forecast in the fake state");
    show({ forecast: { ...forecast, shadows_east_mps: null, shadows_north_mps: null } });
    expect(page.root.textContent).toContain("Motion of the shadows unknown.");
  });

  it("shows whether an earlier flight's knowledge of the land is used", () => {
    show({ reference: "of an earlier flight, with the sun 3 degrees from where it is now" });
    expect(page.root.textContent).toContain(
      "Land in full sun: of an earlier flight, with the sun 3 degrees from where it is now.",
    );
    page.dispose();
    show();
    expect(page.root.textContent).not.toContain("Land in full sun");
  });

  it("shows a camera that is not locked as such", () => {
    page = renderPage(
      SunPanel,
      station([vehicle(1)], {
        ground_image: groundImage({ exposure_locked: true }),
        shade: shadeLine({ lock_problem: "exposure changed by 30% within 20 s" }),
      }),
    );
    expect(page.root.textContent).toContain("exposure not locked");
  });

  it("shows why there is no shade map", () => {
    show({ rejected: "expected a picture, got black", map: null, forecast: null });
    expect(page.root.textContent).toContain("expected a picture, got black");
    expect(page.root.textContent).toContain("No shade map yet");
  });

  it("reports a site without an imaging drone", () => {
    page = renderPage(SunPanel, station([vehicle(1)]));
    expect(page.root.textContent).toContain("No imaging drone at this site");
  });
});

describe("side-step", () => {
  const view: SideStepView = {
    serial: "SN-001",
    vehicle_name: "Alder",
    stage: "aside",
    since_age_s: 3,
    begun_by: "anna (127.0.0.1)",
    begun_age_s: 3,
    bearing_deg: 123,
    reason: null,
    survey_id: null,
  };

  function showImager(sideStep: SideStepView | null, isImager = true) {
    const vehicles = [vehicle(1, { is_imager: isImager })];
    page = renderPage(SunPanel, station(vehicles, { shade: shadeLine(), side_step: sideStep }));
  }

  const button = () => find<HTMLButtonElement>(page.root, "section[aria-label='Side-step'] button");

  it("is ordered by a held button that names the imaging drone", () => {
    showImager(null);
    expect(button().getAttribute("aria-label")).toContain("25\u00a0m aside and back");
    button().dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(GUARD_MS);
    expect(page.requests).toEqual([{ sideStep: "SN-001" }]);
  });

  it("has a button for each of several imaging drones", () => {
    const vehicles = [1, 2].map((number) => vehicle(number, { is_imager: true }));
    page = renderPage(SunPanel, station(vehicles, { shade: shadeLine() }));
    const buttons = page.root.querySelectorAll("section[aria-label='Side-step'] button");
    expect(buttons).toHaveLength(2);
    expect(buttons[1]?.textContent).toContain(`Side-step: ${vehicleLabel(vehicle(2))}`);
    buttons[1]?.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(GUARD_MS);
    expect(page.requests).toEqual([{ sideStep: "SN-002" }]);
  });

  it("is not offered while one is under way, or without the imaging drone", () => {
    showImager(view);
    expect(button().getAttribute("aria-disabled")).toBe("true");
    page.dispose();
    showImager(null, false);
    expect(button().getAttribute("aria-disabled")).toBe("true");
    page.dispose();
    showImager({ ...view, stage: "done" });
    expect(button().getAttribute("aria-disabled")).toBe("false");
  });

  it("shows its stage and why it waits or has stopped", () => {
    showImager({ ...view, stage: "stopped", reason: "hover, ordered by bob" });
    const text = find(page.root, "[data-testid=side-step]").textContent;
    expect(text).toContain("Alder stopped its side-step, bearing 123°");
    expect(text).toContain("hover, ordered by bob");
  });
});

describe("view upwind", () => {
  const place: UpwindPlaceView = {
    serial: "SN-001",
    latitude_deg: 41.9,
    longitude_deg: -93.6,
    height_above_takeoff_m: 118,
    yaw_deg: 250,
    speed_mps: 8,
    distance_m: 224,
    takes_s: 28,
    here: { now: 0.98, in_30_s: 0.45, in_60_s: 0.02, in_90_s: 0 },
    there: { now: 0.62, in_30_s: 0.9, in_60_s: 0.55, in_90_s: 0.16 },
    sentence: "sees 98 % of the region now; 224 m away, in 28 s, it would see 62 % of it",
  };

  async function showPlace(changes: Partial<UpwindPlaceView>) {
    page = renderPage(SunPanel, station([vehicle(1, { is_imager: true })], { shade: shadeLine() }));
    page.findUpwind({ ...place, ...changes });
    await settled();
    page.clock.advance(10_000);
    await settled();
  }

  const text = () => find(page.root, "[data-testid=upwind-place]").textContent;
  const buttons = () =>
    page.root.querySelectorAll<HTMLButtonElement>("section[aria-label='View upwind'] button");

  it("states what the flight costs and what is seen from there", async () => {
    await showPlace({});
    expect(text()).toContain(`Alder ${place.sentence}.`);
  });

  it("sends the drone there by a held button, with its heading", async () => {
    await showPlace({});
    buttons()[0]?.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(GUARD_MS);
    const { latitude_deg, longitude_deg, height_above_takeoff_m, yaw_deg, speed_mps } = place;
    const order = { latitude_deg, longitude_deg, height_above_takeoff_m, yaw_deg, speed_mps };
    expect(page.orders).toEqual([{ serials: ["SN-001"], order: { kind: "goto", ...order } }]);
  });

  it("offers no flight from the best place", async () => {
    await showPlace({ distance_m: 0, there: place.here });
    expect(buttons()).toHaveLength(0);
  });

  it("shows a flight automatically, and offers no side-step meanwhile", () => {
    const moving = {
      serial: "SN-001",
      vehicle_name: "Alder",
      stage: "upwind" as const,
      since_age_s: 3,
      begun_by: "anna (127.0.0.1)",
      begun_age_s: 3,
      reason: null,
      survey_id: 7,
      place,
    };
    const vehicles = [vehicle(1, { is_imager: true })];
    page = renderPage(SunPanel, station(vehicles, { shade: shadeLine(), move_upwind: moving }));
    const shown = find(page.root, "[data-testid=move-upwind]").textContent;
    expect(shown).toContain("Alder flies upwind automatically, 224\u00a0m since 3");
    const aside = find(page.root, "section[aria-label='Side-step'] button");
    expect(aside.getAttribute("aria-disabled")).toBe("true");
  });

  it("shows why no place is known", async () => {
    page = renderPage(SunPanel, station([vehicle(1, { is_imager: true })], { shade: shadeLine() }));
    await settled();
    expect(text()).toContain("No upwind position for ");
    expect(text()).toContain("Alder: no region in this test.");
    expect(buttons()).toHaveLength(0);
  });
});

describe("whole per cents", () => {
  it.each([
    [
      { sun: 0.999, shade: 0.0005, unknown: 0.0005 },
      { sun: 99, shade: 0, unknown: 1 },
    ],
    [
      { sun: 0.333, shade: 0.333, unknown: 0.334 },
      { sun: 33, shade: 33, unknown: 34 },
    ],
    [
      { sun: 1, shade: 0, unknown: 0 },
      { sun: 100, shade: 0, unknown: 0 },
    ],
  ])("of %o never read better known than they are", (shares, percents) => {
    expect(lightPercents(shares)).toEqual(percents);
  });
});
