import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { courseOf, courseText } from "../../orders/course";
import { at, orderResult, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { numberIn } from "../../text/units";
import { FlyHereCard } from "./FlyHereCard";

const lonLat = (east_m: number, north_m: number) => {
  const [lon, lat] = at(east_m, north_m);
  return { lon, lat };
};

describe("the course", () => {
  it.each([
    [[0, 100], 0, 0],
    [[100, 0], 0, 90],
    [[-100, 0], 0, 270],
    [[0, -100], 0, 180],
  ] as const)("to %j points %d", ([east_m, north_m], climb_m, bearing_deg) => {
    const course = courseOf(lonLat(0, 0), lonLat(east_m, north_m), climb_m, 5);
    expect(course.bearing_deg).toBeCloseTo(bearing_deg, 1);
    expect(course.distance_m / 100).toBeCloseTo(1, 2);
  });

  it("includes the time to climb", () => {
    const here = lonLat(0, 0);
    expect(courseOf(here, here, 30, 5)).toMatchObject({ distance_m: 0, time_s: 6 });
  });

  it("is formatted as text", () => {
    const course = { distance_m: 120.4, bearing_deg: 44.6, time_s: 24.1 };
    expect(courseText(course)).toBe("120\u00a0m, bearing 045°, about 25 s");
  });
});

describe("a number in a field", () => {
  it.each([
    ["40", 40],
    [" 7,5 ", 7.5],
    ["", null],
    ["4o", null],
    ["Infinity", null],
  ])("%j is %s", (text, value) => expect(numberIn(text)).toBe(value));
});

describe("fly here", () => {
  let page: RenderedPage;
  beforeEach(() => {
    page = renderPage(FlyHereCard, station([vehicle(1), vehicle(2)]));
    page.answerWith([orderResult()]);
  });
  afterEach(() => page.dispose());

  const fly = () => page.shared.flyHere;
  const begin = async () => {
    page.shared.selection.only(1);
    fly().toggle();
    fly().aim(lonLat(0, 0));
    page.clock.advance(300);
    await settled();
  };
  const go = () => find(page.root, ".fly-go");
  const hold = (ms: number) => {
    go().dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(ms);
  };

  it("needs exactly one identified vehicle", () => {
    fly().toggle();
    expect(fly().isOn()).toBe(false);
    page.shared.selection.all([1, 2]);
    fly().toggle();
    expect(fly().isOn()).toBe(false);
    page.shared.selection.only(1);
    fly().toggle();
    expect(fly().isOn()).toBe(true);
  });

  it("checks with the gate first and shows distance, bearing and time", async () => {
    await begin();
    expect(page.checks).toHaveLength(1);
    expect(page.checks[0]?.order).toMatchObject({
      kind: "goto",
      height_above_takeoff_m: 45,
      speed_mps: 5,
    });
    expect(find(page.root, ".fly-course").textContent).toMatch(/m, bearing \d{3}°, about \d+ s/);
    expect(find(page.root, ".fly-check").textContent).toContain("Allowed by the safety gate");
    expect(page.orders).toEqual([]);
  });

  it("sends the checked order once after the button was held", async () => {
    await begin();
    hold(1400);
    expect(page.orders).toEqual([]);
    page.clock.advance(200);
    await settled();
    expect(page.orders).toEqual([page.checks[0]]);
    expect(fly().target()).toBeNull();
  });

  it("shows why the gate refuses, and sends nothing", async () => {
    const reason = "path crosses keep-out zone Barn";
    page.answerWith([orderResult({ accepted: false, rule: "keep_out", reason })]);
    await begin();
    expect(find(page.root, ".fly-check").textContent).toContain(`Refused: ${reason}`);
    hold(3000);
    expect(go().getAttribute("aria-disabled")).toBe("true");
    expect(page.orders).toEqual([]);
  });

  it("repeats the check every second", async () => {
    await begin();
    page.answerWith([orderResult({ accepted: false, rule: "separation", reason: "too close" })]);
    page.clock.advance(1000);
    await settled();
    expect(find(page.root, ".fly-check").textContent).toContain("too close");
  });

  it("sends no order for a target moved while the button was held", async () => {
    await begin();
    hold(1000);
    fly().aim(lonLat(50, 0));
    page.clock.advance(2000);
    await settled();
    expect(page.orders).toEqual([]);
  });

  it("checks nothing while a field is not a number", async () => {
    await begin();
    const [height] = page.root.querySelectorAll("input");
    if (height === undefined) throw new Error("no field for the height");
    height.value = "high";
    height.dispatchEvent(new InputEvent("input", { bubbles: true }));
    page.clock.advance(3000);
    await settled();
    expect(page.checks).toHaveLength(1);
    expect(find(page.root, ".fly-check").textContent).toContain("must be numbers");
    expect(go().getAttribute("aria-disabled")).toBe("true");
  });

  it("clears the target, then the mode; another selection clears both", async () => {
    await begin();
    expect([fly().clear(), fly().target(), fly().isOn()]).toEqual([true, null, true]);
    expect([fly().clear(), fly().isOn(), fly().clear()]).toEqual([true, false, false]);
    await begin();
    page.shared.selection.only(2);
    expect([fly().target(), fly().isOn()]).toEqual([null, false]);
  });

  it("nudges by the selected step after a brief hold", async () => {
    await begin();
    const west = find(page.root, "[aria-label^='W, hold briefly: nudge 1 Alder west']");
    west.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(450);
    expect(page.orders).toEqual([
      {
        serials: ["SN-001"],
        order: { kind: "nudge", north_m: 0, east_m: -1, up_m: 0, turn_deg: 0, speed_mps: 2 },
      },
    ]);
  });
});
