import { afterEach, describe, expect, it, vi } from "vitest";
import type { ImagerReliefView, SurveyLightView, SurveyView, VehicleView } from "../../protocol";
import { survey, surveyLight } from "../../testing/fakeField";
import { area, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { formatMinuteOfDay } from "../../text/replay";
import { sharePercent, shownSurvey, timeLeft } from "../../text/survey";
import { SurveyPanel } from "./SurveyPanel";

let page: RenderedPage;
afterEach(() => {
  page?.dispose();
  vi.restoreAllMocks();
});

function show(...surveys: SurveyView[]) {
  page = renderPage(SurveyPanel, station([vehicle(1), vehicle(2)], { surveys }));
}

function button(name: string): HTMLButtonElement {
  const buttons = [...page.root.querySelectorAll("button")];
  const found = buttons.find((each) => each.textContent === name);
  if (found === undefined) throw new Error(`no button ${name}`);
  return found;
}

function hold(name: string, ms: number) {
  const button = find(page.root, `[aria-label^='${name}']`);
  button.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
  page.clock.advance(ms);
  button.dispatchEvent(new PointerEvent("pointerup", { bubbles: true, button: 0 }));
}

describe("a survey in the list", () => {
  it("shows the area photographed in sun, in shade and remaining", () => {
    show(survey(7));
    const text = find(page.root, "[data-testid=survey-7]").textContent;
    expect(text).toContain("south field");
    expect(text).not.toContain("7 south field");
    expect(text).toContain("Running");
    expect(text).not.toContain("round 1");
    expect(text).toContain("40 % in sun · 10 % in shade · 50 % to fly · 2.0\u00a0ha");
    expect(text).toContain("Alder flies rows");
    expect(text).toContain("battery too low");
  });

  it("needs longer for what is to be in sun than for rows in any light", () => {
    const { figures } = survey(7);
    if (figures === null) throw new Error("expected figures");
    const flown = { age_s: 600, figures: { ...figures, not_yet_m2: 2_000, in_shade_m2: 10_000 } };
    expect(timeLeft(survey(7, { ...flown, planner: "lawnmower_once" }))).toBe("≈ 1 min left");
    expect(timeLeft(survey(7, { ...flown, planner: "sunlit_first" }))).toBe("≈ 15 min left");
    const shaded = { ...figures, not_yet_m2: 2_000, in_shade_m2: 18_000, in_sun_m2: 0 };
    expect(timeLeft(survey(7, { ...flown, planner: "sunlit_first", figures: shaded }))).toBeNull();
  });

  it("states how much of the region shade maps do not show, while it is flown", () => {
    const { figures } = survey(7);
    if (figures === null) throw new Error("expected figures");
    const part = { figures: { ...figures, not_shown_m2: 3_000 } };
    show(survey(7, part), survey(8), survey(9, { ...part, phase: "done" }));
    const text = (id: number) => find(page.root, `[data-testid=survey-${id}]`).textContent;
    expect(text(7)).toContain(
      "0.3\u00a0ha (15 %) not shown by shade maps: flown once, light unknown.",
    );
    expect(text(8)).not.toContain("shade maps");
    expect(text(9)).not.toContain("shade maps");
  });

  it("that flies stands above those that are planned or over", () => {
    show(survey(9, { phase: "created" }), survey(8, { phase: "paused" }), survey(7));
    const shown = [...page.root.querySelectorAll("[data-testid^=survey-]")];
    expect(shown.map((each) => each.getAttribute("data-testid"))).toEqual([
      "survey-7",
      "survey-8",
      "survey-9",
    ]);
  });

  it("is started by a long press with the selected vehicles, and takes off only if allowed", () => {
    show(survey(7, { phase: "created", vehicles: [] }));
    hold("Start with selected", 2000);
    expect(page.requests).toEqual([]);
    page.shared.selection.only(2);
    hold("Start with selected, hold 1.5 s: 2 Birch", 1400);
    expect(page.requests).toEqual([]);
    hold("Start with selected, hold 1.5 s: 2 Birch", 1600);
    find<HTMLInputElement>(page.root, "input[type=checkbox]").click();
    hold("Start with selected, hold 1.5 s: 2 Birch", 1600);
    expect(page.requests).toEqual([
      { startedSurvey: 7, serials: ["SN-002"], takeoff: false },
      { startedSurvey: 7, serials: ["SN-002"], takeoff: true },
    ]);
  });

  it("shows what it will take before its start, for the selected drones", async () => {
    show(survey(7, { phase: "created", vehicles: [] }));
    await settled();
    const text = () => find(page.root, "[data-testid=estimate-7]").textContent;
    expect(text()).toContain("With one drone");
    expect(text()).toContain("Time6\u00a0min");
    expect(text()).toContain("Photos on rows62");
    expect(text()).toContain("Batteries2");
    expect(text()).toContain("Pixel on the ground1.6\u00a0cm");
    expect(text()).toContain("7.1\u00a0m/s: 70% front overlap");
    const refusal = "a full battery gives 240 s for rows";
    page.estimateWith({ refusal, time_s: null, batteries: null, warnings: ["9 m/s is too fast"] });
    page.shared.selection.only(2);
    await settled();
    expect(text()).toContain("With the selected drones");
    expect(text()).toContain("Time\u2014");
    expect(text()).toContain(refusal);
    expect(text()).toContain("9 m/s is too fast");
  });

  it("shows its height with the reference, and the range above the ground before its start", async () => {
    show(survey(7, { phase: "created", vehicles: [] }));
    page.estimateWith({ least_height_above_ground_m: 21.6, most_height_above_ground_m: 71.2 });
    page.shared.selection.only(2);
    await settled();
    const shown = () => find(page.root, "[data-testid=survey-7]").textContent;
    expect(shown()).toContain("50\u00a0m above takeoff");
    expect(shown()).toContain("Height above ground22\u00a0m to 71\u00a0m");
    page.dispose();
    show(survey(7, { height_above_takeoff_m: null, height_above_ground_m: 40 }));
    expect(shown()).toContain("40\u00a0m above ground");
  });

  it("says once how it ended, and why where that says more", () => {
    show(
      survey(7, { phase: "aborted", reason: "aborted" }),
      survey(8, { phase: "paused", reason: "no vehicle left" }),
      survey(9, { phase: "created", reason: "not started yet" }),
    );
    const shown = (id: number) => find(page.root, `[data-testid=survey-${id}]`).textContent;
    expect(shown(7).match(/aborted/gi)).toHaveLength(1);
    expect(shown(8)).toContain("Paused: no vehicle left");
    expect(shown(9)).not.toContain("not started yet");
  });

  it("says who stopped a drone, and how it resumes", () => {
    const stopped = (by: string) => {
      const why = `mission stopped: hover, ordered by ${by} (10.0.0.7)`;
      const [one] = survey(7).vehicles;
      if (one === undefined) throw new Error("no vehicle");
      show(survey(7, { vehicles: [{ ...one, is_flying_rows: false, not_flying_reason: why }] }));
      page.nameAs({ name: "bob", role: "pilot", is_logged_in: true, urls: [], fingerprint: null });
      return find(page.root, "[data-testid=survey-7]").textContent;
    };
    const line = "does not fly rows: hover, ordered by";
    expect(stopped("anna")).toContain(`${line} anna. Select it to resume`);
    page.dispose();
    expect(stopped("bob")).toContain(`${line} you. Select it to resume`);
  });

  it("offers its flights as files for other programs before its start", async () => {
    const saved: string[] = [];
    vi.spyOn(HTMLAnchorElement.prototype, "click").mockImplementation(function (
      this: HTMLAnchorElement,
    ) {
      saved.push(this.download);
    });
    show(survey(7, { phase: "created", vehicles: [] }));
    await settled();
    expect(page.root.querySelector("[data-testid=exports-7]")).toBeNull();
    button("Export plan").click();
    await settled();
    const shown = find(page.root, "[data-testid=exports-7]");
    expect(shown.textContent).toContain("neither watches nor stops");
    expect(shown.textContent).toContain("a .kmz names its aircraft");
    expect(shown.textContent).toContain("the end: set it to return home");
    expect(button("DJI Pilot 2: .kmz").disabled).toBe(true);
    button("Litchi: .csv").click();
    const choice = find<HTMLSelectElement>(shown, "select");
    choice.value = "Matrice 350, H20T";
    choice.dispatchEvent(new Event("change", { bubbles: true }));
    await settled();
    button("DJI Pilot 2: .kmz").click();
    await settled();
    const model = { aircraft: "Matrice 350", payload: "H20T" };
    expect(page.requests).toEqual([
      { savedPlan: 7, kind: "csv", serials: [], model: null },
      { savedPlan: 7, kind: "kmz", serials: [], model },
    ]);
    expect(saved).toEqual(["survey-7.csv.zip", "survey-7.kmz"]);
  });

  it("that flies shows no estimate", () => {
    show(survey(7));
    expect(page.root.querySelector("[data-testid=estimate-7]")).toBeNull();
  });

  it("is paused by a short press and aborted by a long one", () => {
    show(survey(7));
    hold("Pause, hold briefly: survey south field", 500);
    hold("Abort, hold 1.5 s: survey south field", 500);
    expect(page.requests).toEqual([{ stoppedSurvey: 7, word: "pause" }]);
    hold("Abort, hold 1.5 s: survey south field", 1600);
    expect(page.requests[1]).toEqual({ stoppedSurvey: 7, word: "abort" });
  });

  it("says for whom a drone waits, and keeps the gate's sentence behind Why", () => {
    const sentence = "Birch: on its way to the first waypoint it must keep 18 m from Alder";
    const waiting = survey(7);
    const [first, second] = waiting.vehicles;
    if (first === undefined || second === undefined) throw new Error("a survey of two drones");
    const birch = { ...second, not_flying_reason: null, refused: sentence, waits_for: "Alder" };
    show({ ...waiting, vehicles: [first, birch] });
    const line = [...page.root.querySelectorAll(".survey-decisions li")].at(-1);
    expect(line?.querySelector("details")?.open).toBe(false);
    expect(line?.querySelector("details")?.textContent).toBe(`Why${sentence}`);
    expect(line?.textContent).toBe(`Birch waits for Alder to clear its wayWhy${sentence}`);
  });

  it("shows why a request was refused", async () => {
    show(survey(7));
    page.answerRequestsWith({ accepted: false, rule: "survey", reason: "survey 7 has ended" });
    hold("Pause, hold briefly: survey south field", 500);
    await Promise.resolve();
    await Promise.resolve();
    expect(page.root.textContent).toContain("survey 7 has ended");
  });

  it("that is complete holds its returning vehicles by a short press", () => {
    show(survey(7, { phase: "done" }));
    hold("Hold returning drones, hold briefly: survey south field", 500);
    expect(page.requests).toEqual([{ stoppedSurvey: 7, word: "abort" }]);
  });

  it("shows what a vehicle does and why", () => {
    const decision = "flies rows 3 to 5: probability of sun 0.9";
    const vehicles = survey(7).vehicles.map((one) => ({ ...one, decision }));
    show(survey(7, { vehicles }));
    const lines = [...page.root.querySelectorAll(".survey-decisions li")].map((e) => e.textContent);
    expect(lines).toEqual([`Alder ${decision}`, "Birch does not fly rows: battery too low"]);
  });

  it("that is over has no buttons", () => {
    const home = { is_flying_rows: false, not_flying_reason: null };
    const vehicles = survey(7).vehicles.map((one) => ({ ...one, ...home }));
    show(survey(7, { phase: "done", vehicles }));
    expect(page.root.querySelectorAll("[data-testid=survey-7] .guard")).toHaveLength(0);
  });
});

describe("the light of a running survey", () => {
  const cedar = vehicle(3, { is_imager: true });
  const dogwood = vehicle(4, { is_imager: true, is_flying: { value: false, age_s: 0 } });
  const text = () => find(page.root, "[data-testid=survey-light]").textContent;

  function showLight(changes: Partial<SurveyLightView>, relief: ImagerReliefView | null = null) {
    const running = survey(7, { light: surveyLight(changes) });
    const state = station([vehicle(1), cedar, dogwood], {
      surveys: [running],
      imager_relief: relief,
    });
    page = renderPage(SurveyPanel, { ...state, time_ns: NOON_NS });
  }

  it("states when the imaging drone must return and how long light is then unknown", () => {
    showLight({});
    const time = (minutes: number) => formatMinuteOfDay(NOON_NS / 1e6 + minutes * 60_000);
    expect(text()).toContain(
      `Cedar must return at ${time(9)}; the survey needs until about ${time(18)}.`,
    );
    expect(text()).toContain("light is unknown from then on, for about 9 min");
  });

  it("states only the return where the survey is done before, or its end is not known", () => {
    showLight({ needs_s: 300, unknown_in_s: null, unknown_for_s: null });
    expect(text()).toMatch(/Cedar must return at \d\d:\d\d\./);
    expect(text()).not.toContain("unknown");
    page.dispose();
    showLight({ needs_s: null, unknown_for_s: null });
    expect(text()).toContain("Without a second imaging drone, light is unknown from then on.");
  });

  it("states why the return is not known", () => {
    const unknown = "endurance unknown";
    const imagers = [{ serial: "SN-003", vehicle_name: "Cedar", return_due_in_s: null, unknown }];
    showLight({ imagers, unknown_in_s: null });
    expect(text()).toContain("When Cedar must return is not known: endurance unknown.");
  });

  it("has the spare relieve it by a long press, with takeoff from the ground", () => {
    showLight({});
    hold("Relieve by 4 Dogwood", 1400);
    expect(page.requests).toEqual([]);
    hold("Relieve by 4 Dogwood", 1600);
    expect(page.requests).toEqual([{ relieved: "SN-003", spare: "SN-004", takeoff: true }]);
  });

  it("shows the relief under way, and takes no other order meanwhile", () => {
    showLight({}, { ...RELIEF, stage: "maps" });
    expect(text()).toContain("Dogwood is at the place of Cedar, waits for its shade maps");
    hold("Relieve by 4 Dogwood", 1600);
    expect(page.requests).toEqual([]);
  });

  it("states what is flown without light, and sends the drone back", () => {
    const absent = [
      { serial: "SN-003", vehicle_name: "Cedar", gone_age_s: 200, is_on_ground: true },
    ];
    const without = { without_age_s: 75, without_m2: 8000 };
    showLight({ imagers: [], absent, unknown_in_s: null, ...without });
    expect(text()).toContain("No shade map for 1 min 15 s: 0.8\u00a0ha flown with light unknown.");
    hold("Send Cedar back", 1600);
    expect(page.requests).toEqual([{ relieved: "SN-003", spare: "SN-003", takeoff: true }]);
  });

  it("shows why a relief was refused", async () => {
    showLight({});
    page.answerRequestsWith({ accepted: false, rule: "imager_relief", reason: "no layer is free" });
    hold("Relieve by 4 Dogwood", 1600);
    await settled();
    expect(text()).toContain("no layer is free");
  });
});

const NOON_NS = 1_800_000_000_000 * 1e6;
const RELIEF: ImagerReliefView = {
  serial: "SN-004",
  vehicle_name: "Dogwood",
  stage: "to_place",
  since_age_s: 3,
  begun_by: "ann 127.0.0.1",
  begun_age_s: 20,
  reason: null,
  survey_id: null,
  relieved: "SN-003",
  relieved_name: "Cedar",
  maps: 0,
};

function change(selector: string, value: string) {
  const element = find<HTMLSelectElement>(page.root, selector);
  element.value = value;
  element.dispatchEvent(new Event("change", { bubbles: true }));
}

function field(label: string): HTMLInputElement {
  const found = [...page.root.querySelectorAll("label")].find((each) =>
    each.textContent?.startsWith(label),
  );
  return find<HTMLInputElement>(found ?? page.root, "input, select");
}

/** Types into a field and leaves it. */
function type(label: string, value: string) {
  field(label).value = value;
  field(label).dispatchEvent(new InputEvent("input", { bubbles: true }));
  field(label).dispatchEvent(new FocusEvent("blur"));
}

function withRegion(...vehicles: VehicleView[]) {
  const areas = [area("survey", [0, 0], 50, { name: "south field" })];
  const base = station(vehicles);
  return { ...base, site: base.site && { ...base.site, areas } };
}

function showForm(...vehicles: VehicleView[]) {
  page = renderPage(SurveyPanel, withRegion(...vehicles));
}

describe("a new survey", () => {
  it("may relieve its imaging drone or return it home", () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(3, { is_imager: true }), vehicle(4, { is_imager: true })]);
    const site = base.site === null ? null : { ...base.site, areas: regions };
    page = renderPage(SurveyPanel, { ...base, site });
    for (const battery of ["home", "SN-004"]) {
      find<HTMLSelectElement>(page.root, "select[name=battery]").value = battery;
      find<HTMLFormElement>(page.root, "form").dispatchEvent(
        new SubmitEvent("submit", { bubbles: true, cancelable: true }),
      );
    }
    expect(page.requests).toMatchObject([
      { plannedSurvey: { planner: "sunlit_first", relief_allowed: true, spare_serial: null } },
      { plannedSurvey: { relief_allowed: true, spare_serial: "SN-004" } },
    ]);
  });

  it("is planned with the region and numbers of the form", () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(1)]);
    const site = base.site === null ? null : { ...base.site, areas: regions };
    page = renderPage(SurveyPanel, { ...base, site });
    find<HTMLFormElement>(page.root, "form").dispatchEvent(
      new SubmitEvent("submit", { bubbles: true, cancelable: true }),
    );
    expect(page.requests).toEqual([
      {
        plannedSurvey: {
          region: "south field",
          height_above_takeoff_m: 50,
          speed_mps: 6,
          front_overlap: 0.75,
          side_overlap: 0.6,
          row_bearing_deg: null,
          rows: "auto",
          planner: "lawnmower_once",
          camera: { model: null, interval_s: 2 },
          when_done: "return_home",
          side_step_allowed: false,
          upwind_allowed: false,
          relief_allowed: false,
          spare_serial: null,
        },
      },
    ]);
  });

  it("is planned above the ground where the site has an elevation model", () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(1)]);
    const begin = (terrain: "model" | "flat assumed") => {
      const site = base.site === null ? null : { ...base.site, areas: regions, terrain };
      page = renderPage(SurveyPanel, { ...base, site });
      return find<HTMLOptionElement>(page.root, "select[name=above] option[value=ground]");
    };
    const unknown = begin("flat assumed");
    expect([unknown.disabled, unknown.textContent]).toEqual([true, "Ground (no elevation model)"]);
    page.dispose();
    expect(begin("model").disabled).toBe(false);
    change("select[name=above]", "ground");
    find<HTMLFormElement>(page.root, "form").dispatchEvent(
      new SubmitEvent("submit", { bubbles: true, cancelable: true }),
    );
    expect(page.requests).toMatchObject([{ plannedSurvey: { height_above_ground_m: 50 } }]);
    expect(page.requests).not.toMatchObject([{ plannedSurvey: { height_above_takeoff_m: 50 } }]);
  });

  it("begins with the camera that all survey drones have", async () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const begun = async (...vehicles: VehicleView[]) => {
      const base = station(vehicles);
      const site = base.site === null ? null : { ...base.site, areas: regions };
      page = renderPage(SurveyPanel, { ...base, site });
      await settled();
      return find<HTMLSelectElement>(page.root, "select[name=camera]").value;
    };
    const own = vehicle(1, { camera: "mini3pro" });
    expect(await begun(own, vehicle(2, { is_imager: true }))).toBe("mini3pro");
    page.dispose();
    expect(await begun(own, vehicle(2))).toBe("");
  });

  it("is planned with a camera of the station's table and its timer", async () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(1)]);
    const site = base.site === null ? null : { ...base.site, areas: regions };
    page = renderPage(SurveyPanel, { ...base, site });
    await settled();
    change("select[name=camera]", "mini3pro");
    change("select[name=interval]", "3");
    find<HTMLFormElement>(page.root, "form").dispatchEvent(
      new SubmitEvent("submit", { bubbles: true, cancelable: true }),
    );
    const camera = { model: "mini3pro", interval_s: 3 };
    expect(page.requests).toMatchObject([{ plannedSurvey: { camera } }]);
  });

  it("allows motions of the imaging drone only when the operator ticks them", () => {
    const regions = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(1), vehicle(3, { is_imager: true })]);
    const site = base.site === null ? null : { ...base.site, areas: regions };
    page = renderPage(SurveyPanel, { ...base, site });
    find<HTMLInputElement>(page.root, "input[name=side_step]").click();
    find<HTMLInputElement>(page.root, "input[name=upwind]").click();
    find<HTMLFormElement>(page.root, "form").dispatchEvent(
      new SubmitEvent("submit", { bubbles: true, cancelable: true }),
    );
    expect(page.requests).toMatchObject([
      { plannedSurvey: { side_step_allowed: true, upwind_allowed: true } },
    ]);
  });

  it("offers planners of installed packages by their name", () => {
    const areas = [area("survey", [0, 0], 50, { name: "south field" })];
    const base = station([vehicle(1), vehicle(3, { is_imager: true })]);
    const site =
      base.site === null ? null : { ...base.site, areas, outside_planners: ["by_hedge"] };
    page = renderPage(SurveyPanel, { ...base, site });
    const offered = [...page.root.querySelectorAll<HTMLOptionElement>("[name=planner] option")];
    expect(offered.map(({ value }) => value)).toEqual([
      "sunlit_first",
      "lawnmower_again",
      "lawnmower_once",
      "by_hedge",
    ]);
    expect(offered.at(-1)?.textContent).toBe("by_hedge");
  });

  it("offers nothing that needs an imaging drone to a site without one", () => {
    showForm(vehicle(1));
    for (const name of ["planner", "side_step", "upwind", "battery"])
      expect(page.root.querySelector(`[name=${name}]`)).toBeNull();
  });

  it("has its height and speed follow from pixel and overlap, until they are typed", async () => {
    showForm(vehicle(1, { camera: "mini3pro" }));
    await settled();
    const value = (label: string) => field(label).value;
    expect(value("Pixel size, cm")).toBe("1.73");
    type("Pixel size, cm", "2");
    expect([value("Height, m"), value("Speed, m/s"), value("Photo every, s")]).toEqual([
      "58",
      "7.5",
      "2",
    ]);
    type("Front overlap, %", "90");
    expect([value("Height, m"), value("Speed, m/s")]).toEqual(["58", "3"]);
    type("Height, m", "40");
    type("Pixel size, cm", "2");
    type("Speed, m/s", "2.5");
    type("Row bearing, °", "35");
    find<HTMLFormElement>(page.root, "form").dispatchEvent(
      new SubmitEvent("submit", { bubbles: true, cancelable: true }),
    );
    expect(page.requests).toMatchObject([
      {
        plannedSurvey: {
          height_above_takeoff_m: 58,
          speed_mps: 2.5,
          front_overlap: 0.9,
          row_bearing_deg: 35,
        },
      },
    ]);
  });

  it("shows time, batteries and photos when nothing is typed for a moment", async () => {
    showForm(vehicle(1));
    await settled();
    page.clock.advance(399);
    await settled();
    expect(page.root.textContent).not.toContain("batteries");
    page.clock.advance(1);
    await settled();
    expect(page.root.textContent).toContain("1 drone: 6\u00a0min · 2 batteries · 214 photos");
    page.estimateWith({ warnings: ["9 m/s is too fast"] });
    type("Speed, m/s", "9");
    page.clock.advance(400);
    await settled();
    expect(page.root.textContent).toContain("9 m/s is too fast");
    expect(page.requests).toEqual([]);
  });

  it("is one button where all drones are simulated: the hold plans, and allows takeoff", async () => {
    const simulated = { is_simulated: true };
    showForm(
      vehicle(1, simulated),
      vehicle(2, simulated),
      vehicle(3, { ...simulated, is_imager: true }),
    );
    expect(find<HTMLDetailsElement>(page.root, "details.survey-new").open).toBe(false);
    expect(page.root.textContent).toContain("2 simulated drones take off and survey south field.");
    const rehearse = "Rehearse, hold 1.5 s: takeoff and survey of south field";
    hold(rehearse, 1400);
    expect(page.requests).toEqual([]);
    page.planAs(survey(4));
    hold(rehearse, 1600);
    await settled();
    await settled();
    expect(page.requests).toMatchObject([
      { plannedSurvey: { region: "south field", height_above_takeoff_m: 50 } },
      { startedSurvey: 4, serials: ["SN-001", "SN-002"], takeoff: true },
    ]);
  });

  it("is a form where a real drone is among them, or a script flies them", () => {
    showForm(vehicle(1, { is_simulated: true }), vehicle(2));
    expect(page.root.textContent).not.toContain("Rehearse");
    expect(find<HTMLDetailsElement>(page.root, "details.survey-new").open).toBe(true);
  });

  it("stays open when a person has opened it, whatever drones come and go", async () => {
    const simulated = [1, 2].map((number) => vehicle(number, { is_simulated: true }));
    showForm(...simulated);
    const form = find<HTMLDetailsElement>(page.root, "details.survey-new");
    expect(form.open).toBe(false);
    form.open = true;
    form.dispatchEvent(new Event("toggle"));
    for (const drones of [[...simulated, vehicle(3)], simulated]) {
      page.receive(withRegion(...drones));
      await settled();
      expect(form.isConnected && form.open).toBe(true);
    }
  });

  it("is not available without survey regions", () => {
    show();
    expect(page.root.textContent).toContain("The site has no survey regions");
    button("Draw or import your field").click();
    expect(page.shared.panels.isOpen("site")).toBe(true);
  });
});

describe("the survey on the map", () => {
  it("is a running one, else a paused one, else the newest", () => {
    const done = survey(9, { phase: "done" });
    const paused = survey(8, { phase: "paused" });
    const running = survey(7);
    expect(shownSurvey([done, paused, running])?.id).toBe(7);
    expect(shownSurvey([done, paused])?.id).toBe(8);
    expect(shownSurvey([done])?.id).toBe(9);
    expect(shownSurvey([survey(3, { phase: "refused", cells: null })])).toBeNull();
  });

  it("rounds coverage down", () => {
    expect(sharePercent(99.9, 100)).toBe(99);
    expect(sharePercent(0, 0)).toBe(0);
  });
});
