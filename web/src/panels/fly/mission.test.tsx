import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { movedBy } from "../../map/missionDraftLayer";
import { positionOf } from "../../map/scene";
import { courseOf } from "../../orders/course";
import { at, orderResult, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { OrderBar } from "../orders/OrderBar";
import { MissionCard } from "./MissionCard";

const lonLat = (east_m: number, north_m: number) => {
  const [lon, lat] = at(east_m, north_m);
  return { lon, lat };
};
const GROUNDED = { is_flying: { value: false, age_s: 0.1 } };
const STEERED = { flies_missions: false };

describe("a mission drawn on the map", () => {
  let page: RenderedPage;
  beforeEach(() => {
    const fleet = [vehicle(1), vehicle(2, GROUNDED), vehicle(4, STEERED)];
    page = renderPage(
      () => (
        <>
          <MissionCard />
          <OrderBar />
        </>
      ),
      station(fleet),
    );
    page.answerWith([orderResult()]);
  });
  afterEach(() => page.dispose());

  const mission = () => page.shared.missionDraft;
  const draw = async (key: number, ...places: [number, number][]) => {
    page.shared.selection.only(key);
    mission().toggle();
    for (const place of places) page.shared.aim(lonLat(...place));
    page.clock.advance(300);
    await settled();
  };
  const go = () => find(page.root, ".fly .guard");
  const hold = async (ms: number) => {
    go().dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(ms);
    await settled();
  };
  const pick = (number: number) => find(page.root, `[aria-label='Point ${number}']`).click();
  const height = () => find<HTMLInputElement>(page.root, ".fly-fields input");

  it("is checked by the gate and sent as it was checked, by a held button", async () => {
    await draw(1, [0, 0], [40, 0]);
    expect(page.checks.at(-1)?.order).toMatchObject({
      kind: "mission",
      land_at_end: false,
      waypoints: [
        { height_above_takeoff_m: 45, speed_mps: 5 },
        { height_above_takeoff_m: 45, speed_mps: 5 },
      ],
    });
    expect(go().textContent).toContain("Fly the mission");
    await hold(1400);
    expect(page.orders).toEqual([]);
    await hold(1600);
    expect(page.orders).toEqual([page.checks.at(-1)]);
    expect([mission().isOn(), mission().points()]).toEqual([false, []]);
  });

  it("has a height of each point, and new points behind the selected one", async () => {
    await draw(1, [0, 0], [40, 0]);
    pick(1);
    height().value = "20";
    height().dispatchEvent(new InputEvent("input", { bubbles: true }));
    page.shared.aim(lonLat(20, 0));
    const heights = () =>
      mission()
        .points()
        .map((point) => point.height.metres());
    expect(heights()).toEqual([20, 20, 45]);
    pick(3);
    expect(height().value).toBe("45");
    pick(1);
    find(page.root, "[aria-label='Remove point 1']").click();
    expect(heights()).toEqual([20, 45]);
    expect(mission().figures()?.distance_m).toBeGreaterThan(0);
  });

  it("is checked again when a point is moved, and not sent when it was held meanwhile", async () => {
    await draw(1, [0, 0], [40, 0]);
    const checked = page.checks.length;
    await hold(1000);
    mission().move(mission().points()[1]?.id ?? 0, lonLat(60, 0));
    page.clock.advance(2000);
    await settled();
    expect(page.orders).toEqual([]);
    expect(page.checks.length).toBeGreaterThan(checked);
  });

  it("takes off where its vehicle stands on the ground, and the button says so", async () => {
    await draw(2, [40, 0]);
    const [above] = mission().points();
    expect(above?.at).toEqual(positionOf(vehicle(2)));
    expect(above?.height.metres()).toBe(30);
    expect(page.checks.at(-1)).toMatchObject({ serials: ["SN-002"], takeoff: true });
    expect(go().textContent).toContain("Take off and fly");
  });

  it("shows the refusal and its point, and sends nothing", async () => {
    const reason = "1 Alder: leg 2 to 3 goes through the keep-out zone";
    page.answerWith([orderResult({ accepted: false, rule: "boundary", reason })]);
    await draw(1, [0, 0], [900, 0]);
    expect(find(page.root, ".fly-check").textContent).toContain(reason);
    expect(find(page.root, ".mission-points .is-refused").textContent).toBe("2");
    await hold(3000);
    expect(page.orders).toEqual([]);
  });

  it("keeps its points when it is refused as it is sent, and removes them once accepted", async () => {
    await draw(1, [0, 0], [40, 0]);
    page.answerWith([orderResult({ accepted: false, rule: "battery", reason: "too low" })]);
    await mission().confirm();
    expect([mission().isOn(), mission().points().length]).toEqual([true, 2]);
    page.answerWith([orderResult({ accepted: true })]);
    await mission().confirm();
    expect([mission().isOn(), mission().points()]).toEqual([false, []]);
  });

  it("is not offered for a model that flies none, with the reason", async () => {
    await draw(4, [0, 0]);
    expect(mission().isOn()).toBe(false);
    const button = find(page.root, ".orders-mission");
    expect(button.getAttribute("aria-disabled")).toBe("true");
    expect(button.getAttribute("aria-description")).toContain("flies no missions");
  });

  it("needs two points, and is kept when another drone is selected, checked for that one", async () => {
    await draw(1, [0, 0]);
    expect(find(page.root, ".fly-check").textContent).toContain("at least two points");
    expect(page.checks).toEqual([]);
    page.shared.aim(lonLat(40, 0));
    page.shared.selection.only(2);
    expect(mission().isOn()).toBe(false);
    await draw(2);
    expect(page.checks.at(-1)?.serials).toEqual(["SN-002"]);
  });

  it("is left by Esc, first the point, then the mode, and by another mode of the map", async () => {
    await draw(1, [0, 0]);
    expect([mission().clear(), mission().selected()]).toEqual([true, null]);
    expect([mission().clear(), mission().isOn(), mission().clear()]).toEqual([true, false, false]);
    await draw(1);
    page.shared.zoneDraft.toggle();
    expect(mission().isOn()).toBe(false);
  });
});

it("an arrow key moves a point by a metre, with Shift by ten", () => {
  const from = lonLat(0, 0);
  const by = (key: string, shiftKey: boolean) => {
    const to = movedBy({ key, shiftKey }, from);
    return to && courseOf(from, to, 0, 1);
  };
  expect(by("ArrowUp", false)?.distance_m).toBeCloseTo(1, 3);
  expect(by("ArrowLeft", true)?.distance_m).toBeCloseTo(10, 2);
  expect(by("ArrowLeft", true)?.bearing_deg).toBeCloseTo(270, 1);
  expect(by("a", false)).toBeNull();
});
