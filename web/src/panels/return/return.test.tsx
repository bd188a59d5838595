import { afterEach, describe, expect, it } from "vitest";
import type { FleetReturnView, ReturningView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { FleetReturn, stagesInTurn } from "./FleetReturn";

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
    returning("B", { wave: 2, stage: "waiting", reason: "its pad is in use by A" }),
    returning("C", { wave: null, stage: "left_out", reason: "its height is not known" }),
    returning("D"),
  ],
};

describe("the order of a return", () => {
  it("goes in waves, with those left out before all", () => {
    const groups = stagesInTurn(VIEW).map(({ title, vehicles }) => [
      title,
      vehicles.map(({ serial }) => serial).join(),
    ]);
    expect(groups).toEqual([
      ["Left out: see to these", "C"],
      ["Wave 1", "A,D"],
      ["Wave 2", "B"],
    ]);
  });
});

describe("the return in layers", () => {
  let page: RenderedPage;
  afterEach(() => page.dispose());

  it("tells who waits and why, and how many have landed", () => {
    page = renderPage(FleetReturn, station([vehicle(1)], { fleet_return: VIEW }));
    expect(page.root.textContent).toContain("Under way: 1 of 4 landed");
    expect(find(page.root, "[data-testid=returning-B]").textContent).toContain(
      "its pad is in use by A",
    );
    expect(find(page.root, "[data-testid=returning-D]").textContent).toContain(
      "D flies home for 4.0 s, at 48\u00a0m above takeoff, to P1",
    );
  });

  it("is called by a long press, for all or for those selected", () => {
    page = renderPage(FleetReturn, station([vehicle(1), vehicle(2)]));
    const hold = (name: string, ms: number) => {
      const button = find(page.root, `[aria-label^='${name}']`);
      button.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
      page.clock.advance(ms);
      button.dispatchEvent(new PointerEvent("pointerup", { bubbles: true, button: 0 }));
    };
    hold("Return all vehicles", 1400);
    expect(page.said).toEqual([]);
    hold("Return all vehicles", 1600);
    page.shared.selection.only(2);
    hold("Return 2 Birch", 1600);
    expect(page.said).toEqual([{ fleetReturn: null }, { fleetReturn: ["SN-002"] }]);
  });

  it("cannot be called where there is nobody", () => {
    page = renderPage(FleetReturn, station([]));
    expect(find(page.root, ".guard").getAttribute("aria-disabled")).toBe("true");
  });
});
