import { afterEach, describe, expect, it } from "vitest";
import type {
  AuthorityHolder,
  CheckView,
  FailsafeCellView,
  FailsafeRowView,
  PreflightView,
  StationState,
} from "../protocol";
import { hazard, station, vehicle } from "../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../testing/renderPage";
import { VehicleDetail } from "./detail/VehicleDetail";
import { SeparationBanner, SeparationSwitch } from "./separation/SeparationHold";
import { StopBanner } from "./stop/StopLatch";

let page: RenderedPage;
const show = (part: Parameters<typeof renderPage>[0], state: StationState) => {
  page = renderPage(part, state);
  return page.root;
};
afterEach(() => page.dispose());

const button = (name: string) => find(page.root, `[aria-label^="${name}"]`);
const press = (name: string) =>
  button(name).dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
const hold = async (name: string, ms: number) => {
  press(name);
  page.clock.advance(ms);
  await settled();
};

function point(state: CheckView["state"], changes: Partial<CheckView> = {}): CheckView {
  const isOk = state === "ok";
  return {
    key: state,
    name: `The ${state} point`,
    state,
    text: "as it is",
    to_do: isOk ? "" : "Do something about it.",
    holds_back: state === "fails",
    ...changes,
  };
}

function failsafeRow(changes: Partial<FailsafeCellView> = {}): FailsafeRowView {
  const cell = (activity: FailsafeCellView["activity"]): FailsafeCellView => ({
    activity,
    reaction: "hold",
    after_s: 3,
    text: "hold after 3 s",
    default: null,
    is_weaker: false,
  });
  return {
    condition: "telemetry_lost",
    name: "telemetry lost",
    begins: "no new telemetry for 1 s on an open link",
    cells: [
      { ...cell("mission"), ...changes },
      cell("steered"),
      cell("holding"),
      cell("returning"),
    ],
  };
}

function list(changes: Partial<PreflightView> = {}): PreflightView {
  const points = [point("ok"), point("attention"), point("unknown"), point("fails")];
  return {
    serial: "SN-001",
    name: "Alder",
    is_passed: false,
    override: null,
    points,
    failsafe: [failsafeRow()],
    ...changes,
  };
}

describe("control authority", () => {
  const authority = (holder: AuthorityHolder) => ({
    holder,
    holder_name: "survey 3",
    age_s: 20,
    reason: "the survey began",
  });
  const heldBy = (holder: AuthorityHolder) =>
    station([vehicle(1, { authority: authority(holder) })]);

  it("is shown with the holder's name, the time and the reason", () => {
    const root = show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    expect(find(root, "[aria-label='Control authority']").textContent).toContain(
      "Guidance control (survey 3) for 20 s: the survey began",
    );
  });

  it("changes by a held button, not by a short press", async () => {
    show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    await hold("Take over, hold briefly: 1 Alder", 300);
    button("Take over").dispatchEvent(new PointerEvent("pointerup", { bubbles: true }));
    await hold("Hand over to pilot, hold briefly: 1 Alder", 450);
    expect(page.requests).toEqual([{ authority: "pilot", serial: "SN-001" }]);
  });

  it("has no button for the current holder, and shows a refusal", async () => {
    page = renderPage(VehicleDetail, heldBy("guidance"));
    page.answerRequestsWith({ accepted: false, rule: "link_age", reason: "no telemetry for 5 s" });
    page.shared.selection.only(1);
    await hold("Take over", 450);
    expect(page.root.textContent).toContain("Refused: no telemetry for 5 s");
    page.receive(heldBy("operator"));
    expect(page.root.querySelector("[aria-label^='Take over']")).toBeNull();
  });

  it("does not change when the holder changes while the button is held", async () => {
    show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    press("Take over");
    page.clock.advance(300);
    page.receive(heldBy("pilot"));
    page.clock.advance(2000);
    await settled();
    expect(page.requests).toEqual([]);
  });
});

describe("the checklist", () => {
  const open = async (preflight: PreflightView) => {
    page = renderPage(VehicleDetail, station([vehicle(1)]));
    page.showPreflight(preflight);
    page.shared.selection.only(1);
    await settled();
    return find(page.root, "[aria-label='Preflight checklist']");
  };

  it("lists items that are not OK first, with instructions", async () => {
    const section = await open(list());
    const lines = [...section.querySelectorAll("li")].map((line) => line.textContent);
    expect(lines[0]).toContain("The attention point: as it is");
    expect(lines[0]).toContain("→ Do something about it.");
    expect(lines.at(-1)).toContain("The ok point: as it is");
    expect(section.textContent).toContain("1 item blocks missions");
  });

  it("is refreshed every two seconds, and marked when not updated", async () => {
    const section = await open(list());
    page.showPreflight(list({ is_passed: true, points: [point("ok")] }));
    page.clock.advance(2000);
    await settled();
    expect(section.textContent).toContain("Preflight: passed");
    expect(section.querySelector("input")).toBeNull();
    page.failPreflight("The station cannot be reached.");
    page.clock.advance(2000);
    await settled();
    expect(section.textContent).toContain("Checklist not updated: The station cannot be reached.");
  });

  it("is overridden with a typed reason and a held button only", async () => {
    const section = await open(list());
    await hold("Override", 2000);
    expect(page.requests).toEqual([]);
    const field = find<HTMLInputElement>(section, "input");
    field.value = "  short test hop ";
    field.dispatchEvent(new InputEvent("input", { bubbles: true }));
    await hold("Override the checklist, hold 1.5 s: 1 Alder", 1400);
    expect(page.requests).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.requests).toEqual([{ override: "short test hop", serial: "SN-001" }]);
  });

  it("has the site's failsafe matrix, folded, and counts what a site has changed", async () => {
    const section = await open(list());
    const matrix = () => find(section, ".failsafe").closest("details");
    expect(matrix()?.querySelector("summary")?.textContent).toBe("When something fails: default");
    expect(matrix()?.open).toBe(false);
    expect(matrix()?.textContent).toContain("telemetry losthold after 3 s");
    const alarm = { text: "alarm", default: "hold after 3 s", is_weaker: true };
    page.showPreflight(list({ failsafe: [failsafeRow(alarm)] }));
    page.clock.advance(2000);
    await settled();
    expect(matrix()?.textContent).toContain("When something fails: 1 of 4 changed, 1 weaker");
    expect(matrix()?.textContent).toContain("alarm (default: hold after 3 s)");
  });

  it("shows the operator and the reason of an override", async () => {
    const section = await open(list({ override: { by: "ann", reason: "short hop", age_s: 5 } }));
    expect(section.textContent).toContain("Overridden by ann, 5.0 s ago: short hop");
    expect(section.querySelector("input")).toBeNull();
  });
});

describe("a hazard area", () => {
  it("is cleared by a long press, under the station's name for it", async () => {
    const one = vehicle(3, { hazard: hazard([0, 0], { dismissal_name: "link-7" }) });
    const root = show(VehicleDetail, station([one]));
    page.shared.selection.only(3);
    expect(root.textContent).toContain("anywhere within 50\u00a0m of its last position");
    await hold("Clear hazard area, hold 1.5 s: 3 Cedar", 1000);
    expect(page.requests).toEqual([]);
    page.clock.advance(600);
    await settled();
    expect(page.requests).toEqual([{ clearedHazard: "link-7" }]);
  });
});

describe("the all stop in force", () => {
  const latch = { by: "anna (192.168.1.4)", age_s: 75, released: ["SN-002"] };
  const stopped = station([vehicle(1, { is_stopped: true }), vehicle(2)], { stop_latch: latch });

  it("is a banner that names who stopped, when, and the vehicles it holds", () => {
    const root = show(StopBanner, station([vehicle(1)]));
    expect(root.textContent).toBe("");
    page.receive(stopped);
    expect(root.textContent).toContain("All stop in force by anna, 1 min 15 s ago. 1 drone:");
    expect(root.textContent).toContain("An operator or an administrator can release it.");
    const release = find(root, "button").getAttribute("aria-label");
    expect(release).toContain("Alder");
    expect(release).not.toContain("Birch");
  });

  it("is released for all by a long press only", async () => {
    show(StopBanner, stopped);
    button("Release all, hold 1.5 s: the all stop of").click();
    await hold("Release all, hold 1.5 s: the all stop of", 1400);
    expect(page.requests).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.requests).toEqual([{ releasedStop: null }]);
  });

  it("is released for one vehicle in its details, and its refusal is shown", async () => {
    const root = show(VehicleDetail, stopped);
    page.shared.selection.only(2);
    expect(root.textContent).not.toContain("Release this vehicle");
    page.shared.selection.only(1);
    page.answerRequestsWith({ accepted: false, rule: "stop_latch", reason: "not in force" });
    await hold("Release this vehicle, hold 1.5 s: 1 Alder", 1600);
    expect(page.requests).toEqual([{ releasedStop: ["SN-001"] }]);
    expect(root.textContent).toContain("not in force");
  });
});

describe("separation hold", () => {
  const withHold = (separation_hold_on: boolean) => {
    const state = station([]);
    return { ...state, station: { ...state.station, separation_hold_on } };
  };

  it("shows a banner while off, with a switch that takes one press", async () => {
    const root = show(SeparationBanner, withHold(true));
    expect(root.textContent).toBe("");
    page.receive(withHold(false));
    expect(root.textContent).toContain("Separation hold is OFF.");
    find(root, "button").click();
    await settled();
    expect(page.requests).toEqual([{ separationHold: true }]);
  });

  it("is switched off by a long press only", async () => {
    show(SeparationSwitch, withHold(true));
    button("Switch").click();
    await hold("Switch separation hold off", 1400);
    expect(page.requests).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.requests).toEqual([{ separationHold: false }]);
  });
});
