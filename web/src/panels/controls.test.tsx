import { afterEach, describe, expect, it } from "vitest";
import type { AuthorityHolder, CheckView, PreflightView, StationState } from "../protocol";
import { hazard, station, vehicle } from "../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../testing/renderPage";
import { VehicleDetail } from "./detail/VehicleDetail";
import { SeparationBanner, SeparationSwitch } from "./separation/SeparationHold";

let page: RenderedPage;
const show = (part: Parameters<typeof renderPage>[0], state: StationState) => {
  page = renderPage(part, state);
  return page.root;
};
afterEach(() => page.dispose());

const settled = async () => {
  for (let turn = 0; turn < 5; turn += 1) await Promise.resolve();
};
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

function list(changes: Partial<PreflightView> = {}): PreflightView {
  const points = [point("ok"), point("attention"), point("unknown"), point("fails")];
  return {
    serial: "SN-001",
    name: "Alder",
    is_passed: false,
    override: null,
    points,
    ...changes,
  };
}

describe("who leads a vehicle", () => {
  const authority = (holder: AuthorityHolder) => ({
    holder,
    holder_name: "survey 3",
    age_s: 20,
    reason: "the survey began",
  });
  const heldBy = (holder: AuthorityHolder) =>
    station([vehicle(1, { authority: authority(holder) })]);

  it("is told with the holder_name, the time and the reason", () => {
    const root = show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    expect(find(root, "[aria-label='Who leads it']").textContent).toContain(
      "Controlled by guidance (survey 3) for 20 s: the survey began",
    );
  });

  it("changes by a press that is held, and by no brush of the hand", async () => {
    show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    await hold("Take over 1 Alder", 300);
    button("Take over").dispatchEvent(new PointerEvent("pointerup", { bubbles: true }));
    await hold("Give 1 Alder", 450);
    expect(page.said).toEqual([{ authority: "pilot", serial: "SN-001" }]);
  });

  it("has no button for whom it has already, and tells a refusal with its rule", async () => {
    page = renderPage(VehicleDetail, heldBy("guidance"));
    page.answerWordsWith({ accepted: false, rule: "link_age", reason: "it is not heard" });
    page.shared.selection.only(1);
    await hold("Take over", 450);
    expect(page.root.textContent).toContain("Refused (link age): it is not heard");
    page.say(heldBy("operator"));
    expect(page.root.querySelector("[aria-label^='Take over']")).toBeNull();
  });

  it("gives nothing when somebody else takes it while the button is held", async () => {
    show(VehicleDetail, heldBy("guidance"));
    page.shared.selection.only(1);
    press("Take over");
    page.clock.advance(300);
    page.say(heldBy("pilot"));
    page.clock.advance(2000);
    await settled();
    expect(page.said).toEqual([]);
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

  it("says what is not in order before all that is, and what to do", async () => {
    const section = await open(list());
    const lines = [...section.querySelectorAll("li")].map((line) => line.textContent);
    expect(lines[0]).toContain("The attention point, attention: as it is");
    expect(lines[0]).toContain("→ Do something about it.");
    expect(lines.at(-1)).toContain("The ok point, in order");
    expect(section.textContent).toContain("1 point holds missions back");
  });

  it("is asked anew every two seconds, and says so when no answer comes", async () => {
    const section = await open(list());
    page.showPreflight(list({ is_passed: true, points: [point("ok")] }));
    page.clock.advance(2000);
    await settled();
    expect(section.textContent).toContain("Preflight: passed");
    expect(section.querySelector("input")).toBeNull();
    page.failPreflight("The station cannot be reached.");
    page.clock.advance(2000);
    await settled();
    expect(section.textContent).toContain("This list is old: The station cannot be reached.");
  });

  it("is overridden with a typed reason only, and held", async () => {
    const section = await open(list());
    await hold("Override", 2000);
    expect(page.said).toEqual([]);
    const field = find<HTMLInputElement>(section, "input");
    field.value = "  short test hop ";
    field.dispatchEvent(new InputEvent("input", { bubbles: true }));
    await hold("Override the checklist of 1 Alder: hold for 1.5 seconds", 1400);
    expect(page.said).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.said).toEqual([{ override: "short test hop", serial: "SN-001" }]);
  });

  it("tells who has overridden it and why", async () => {
    const section = await open(list({ override: { by: "ann", reason: "short hop", age_s: 5 } }));
    expect(section.textContent).toContain("Overridden by ann, 5.0 s ago: short hop");
    expect(section.querySelector("input")).toBeNull();
  });
});

describe("a hazard area", () => {
  it("is dismissed by a long press, under the name the station gave it", async () => {
    const one = vehicle(3, { hazard: hazard([0, 0], { dismissed_as: "link-7" }) });
    const root = show(VehicleDetail, station([one]));
    page.shared.selection.only(3);
    expect(root.textContent).toContain("anywhere within 50\u00a0m of where it was last seen");
    await hold("Dismiss the hazard of 3 Cedar", 1000);
    expect(page.said).toEqual([]);
    page.clock.advance(600);
    await settled();
    expect(page.said).toEqual([{ dismissed: "link-7" }]);
  });
});

describe("separation holds", () => {
  const withHold = (separation_hold_on: boolean) => {
    const state = station([]);
    return { ...state, station: { ...state.station, separation_hold_on } };
  };

  it("are told for as long as they are off, with a switch beside that takes one press", async () => {
    const root = show(SeparationBanner, withHold(true));
    expect(root.textContent).toBe("");
    page.say(withHold(false));
    expect(root.textContent).toContain("Separation holds are OFF.");
    find(root, "button").click();
    await settled();
    expect(page.said).toEqual([{ separationHold: true }]);
  });

  it("are switched off by a long press only", async () => {
    show(SeparationSwitch, withHold(true));
    button("Switch").click();
    await hold("Switch separation holds off", 1400);
    expect(page.said).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.said).toEqual([{ separationHold: false }]);
  });
});
