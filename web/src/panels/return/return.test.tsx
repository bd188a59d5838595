import { afterEach, describe, expect, it } from "vitest";
import type { FleetReturnView, ReturningView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { FleetReturn, groupByWave } from "./FleetReturn";

function returning(serial: string, changes: Partial<ReturningView> = {}): ReturningView {
  return {
    serial,
    vehicle_name: serial,
    stage: "flying",
    since_age_s: 4,
    reason: null,
    wave: 1,
    layer_height_m: 48,
    layer_height_above_takeoff_m: 48,
    pad: "P1",
    hold_command_id: 3,
    mission_command_id: 9,
    ...changes,
  };
}

const VIEW: FleetReturnView = {
  called_by: "ann",
  age_s: 30,
  is_over: false,
  vehicles: [
    returning("A", { stage: "landed" }),
    returning("B", { wave: 2, stage: "waiting", reason: "pad in use by A" }),
    returning("C", { wave: null, stage: "excluded", reason: "height unknown" }),
    returning("D"),
  ],
};

describe("the groups of a return", () => {
  it("are waves, after the vehicles not included", () => {
    const groups = groupByWave(VIEW).map(({ title, vehicles }) => [
      title,
      vehicles.map(({ serial }) => serial).join(),
    ]);
    expect(groups).toEqual([
      ["Not included: operator action needed", "C"],
      ["Wave 1", "A,D"],
      ["Wave 2", "B"],
    ]);
  });
});

describe("the return in layers", () => {
  let page: RenderedPage;
  afterEach(() => page.dispose());

  it("shows which vehicles wait and why, and how many have landed", () => {
    page = renderPage(FleetReturn, station([vehicle(1)], { fleet_return: VIEW }));
    expect(page.root.textContent).toContain("In progress: 1 of 4 landed");
    expect(find(page.root, "[data-testid=returning-B]").textContent).toContain("pad in use by A");
    expect(find(page.root, "[data-testid=returning-D]").textContent).toContain(
      "D flying home for 4.0 s, 48\u00a0m above takeoff, pad P1",
    );
  });

  it("is started by a long press, for all or for the selected vehicles", () => {
    page = renderPage(FleetReturn, station([vehicle(1), vehicle(2)]));
    const hold = (name: string, ms: number) => {
      const button = find(page.root, `[aria-label^='${name}']`);
      button.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
      page.clock.advance(ms);
      button.dispatchEvent(new PointerEvent("pointerup", { bubbles: true, button: 0 }));
    };
    hold("Return all, hold 1.5 s: every vehicle", 1400);
    expect(page.requests).toEqual([]);
    hold("Return all, hold 1.5 s: every vehicle", 1600);
    page.shared.selection.only(2);
    hold("Return selected, hold 1.5 s: 2 Birch", 1600);
    expect(page.requests).toEqual([{ fleetReturn: null }, { fleetReturn: ["SN-002"] }]);
  });

  it("is disabled without vehicles", () => {
    page = renderPage(FleetReturn, station([]));
    expect(find(page.root, ".guard").getAttribute("aria-disabled")).toBe("true");
  });
});
