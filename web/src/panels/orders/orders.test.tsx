import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { command, orderResult, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { AllStop } from "../bar/TopBar";
import { AnswerNotice } from "./AnswerNotice";
import { OrderBar } from "./OrderBar";

const FLEET = station([vehicle(1), vehicle(2), vehicle(3, { number: 0, serial: null })]);
let page: RenderedPage;

beforeEach(() => {
  page = renderPage(
    () => (
      <>
        <AnswerNotice />
        <OrderBar />
        <AllStop />
      </>
    ),
    FLEET,
  );
});

afterEach(() => page.dispose());

const land = () => find<HTMLButtonElement>(page.root, ".order-land");
const pointer = (type: string) =>
  land().dispatchEvent(new PointerEvent(type, { bubbles: true, button: 0 }));
const key = (type: string, init: KeyboardEventInit, target: EventTarget = land()) =>
  target.dispatchEvent(new KeyboardEvent(type, { bubbles: true, ...init }));

describe("an order button", () => {
  it("commands exactly the selected vehicles after its hold time", () => {
    page.shared.selection.all([1, 2]);
    pointer("pointerdown");
    page.clock.advance(1450);
    expect(page.orders).toEqual([]);
    page.clock.advance(100);
    expect(page.orders).toEqual([{ serials: ["SN-001", "SN-002"], order: { kind: "land" } }]);
    page.clock.advance(5000);
    expect(page.orders).toHaveLength(1);
  });

  it("names the vehicles before and while it is held", () => {
    page.shared.selection.all([1, 2]);
    expect(find(page.root, ".orders-to").textContent).toBe("1 Alder and 2 Birch selected");
    expect(land().getAttribute("aria-label")).toContain("1 Alder and 2 Birch");
    pointer("pointerdown");
    const text = find(page.root, ".orders-to").textContent;
    expect(text).toBe("Keep holding to land: 1 Alder and 2 Birch");
  });

  it("does nothing without a selection", () => {
    pointer("pointerdown");
    key("keydown", { key: " " });
    page.clock.advance(5000);
    expect(page.orders).toEqual([]);
    expect(land().getAttribute("aria-disabled")).toBe("true");
  });

  it.each(["pointerup", "pointerleave", "pointercancel", "blur"])("cancels at %s", (type) => {
    page.shared.selection.only(1);
    pointer("pointerdown");
    page.clock.advance(1000);
    pointer(type);
    page.clock.advance(5000);
    expect(page.orders).toEqual([]);
  });

  it("cancels when the selection changes or the vehicle disappears", () => {
    page.shared.selection.only(1);
    pointer("pointerdown");
    page.clock.advance(1000);
    page.shared.selection.toggle(2);
    page.clock.advance(5000);
    pointer("pointerup");
    pointer("pointerdown");
    page.clock.advance(1000);
    page.receive(station([]));
    page.clock.advance(5000);
    expect(page.orders).toEqual([]);
  });

  it("continues through new states, which arrive ten times a second", () => {
    page.shared.selection.only(1);
    pointer("pointerdown");
    const before = land();
    for (let message = 0; message < 16; message += 1) {
      page.receive(station([vehicle(1), vehicle(2)], { time_ns: message * 1e8 }));
      page.clock.advance(100);
    }
    expect(land()).toBe(before);
    expect(page.orders).toHaveLength(1);
  });

  it("works from the keyboard and ignores key repeats", () => {
    page.shared.selection.only(2);
    key("keydown", { key: "Enter" });
    page.clock.advance(800);
    key("keydown", { key: "Enter", repeat: true });
    page.clock.advance(800);
    key("keyup", { key: "Enter" });
    expect(page.orders).toEqual([{ serials: ["SN-002"], order: { kind: "land" } }]);
  });

  it("works with Shift and its letter, both held to the end", () => {
    page.shared.selection.only(1);
    key("keydown", { code: "KeyL", key: "L", shiftKey: true }, window);
    page.clock.advance(1000);
    key("keyup", { key: "Shift" }, window);
    page.clock.advance(5000);
    expect(page.orders).toEqual([]);
    key("keydown", { code: "KeyR", key: "R", shiftKey: true }, window);
    page.clock.advance(1600);
    expect(page.orders).toEqual([{ serials: ["SN-001"], order: { kind: "return_home" } }]);
  });

  it("does not command an unidentified vehicle", () => {
    page.shared.selection.all([1, -3]);
    expect(find(page.root, ".orders-to").textContent).toContain("Not sent to ? Cedar");
    pointer("pointerdown");
    page.clock.advance(2000);
    expect(page.orders.map(({ serials }) => serials)).toEqual([["SN-001"]]);
  });

  it("hovers at one press, and once at one press of its key", () => {
    page.shared.selection.only(1);
    find(page.root, ".order-hover").click();
    const hover = { serials: ["SN-001"], order: { kind: "hover" } };
    expect(page.orders).toEqual([hover]);
    const select = document.createElement("select");
    page.root.append(select);
    key("keydown", { code: "KeyH", key: "H", shiftKey: true }, select);
    key("keydown", { code: "KeyH", key: "H", shiftKey: true, repeat: true }, select);
    expect(page.orders).toEqual([hover, hover]);
  });
});

describe("a takeoff", () => {
  const grounded = { is_flying: { value: false, age_s: 0.1 } };
  const button = () => page.root.querySelector<HTMLElement>(".orders-takeoff button");

  it("is offered only for selected vehicles on the ground, and held", async () => {
    page.receive(station([vehicle(1, grounded), vehicle(2), vehicle(4, grounded)]));
    page.shared.selection.only(2);
    expect(button()).toBeNull();
    page.shared.selection.all([1, 2]);
    expect(button()?.getAttribute("aria-label")).toBe("Take off to 30\u00a0m, hold 1.5 s: 1 Alder");
    button()?.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(1400);
    expect(page.orders).toEqual([]);
    page.clock.advance(200);
    expect(page.orders).toMatchObject([{ serials: ["SN-001"], takeoff: true }]);
    const [{ order } = { order: null }] = page.orders;
    expect(order).toMatchObject({ kind: "mission", land_at_end: false });
  });

  it("of a model that flies no missions is a hover", () => {
    page.receive(
      station([vehicle(1, { ...grounded, flies_missions: false }), vehicle(4, grounded)]),
    );
    page.shared.selection.all([1, 4]);
    button()?.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(1600);
    expect(page.orders.map(({ order }) => order.kind)).toEqual(["hover", "mission"]);
  });
});

describe("all stop", () => {
  it("needs one press, whatever the selection or the connection", () => {
    page.connect({ kind: "lost", reason: "gone", attempt: 1 });
    find(page.root, ".all-stop").click();
    expect(page.allStops()).toBe(1);
    expect(page.orders).toEqual([]);
  });
});

describe("the station's answer", () => {
  const line = () => find(page.root, ".toast-line").textContent ?? "";
  const stopAll = async () => {
    find(page.root, ".all-stop").click();
    await settled();
  };
  const grounded = { is_flying: { value: false, age_s: 0.1 } };
  const notFlying = { accepted: false, rule: "flying" };

  it("is one line, with the one refusal in it and the names on demand", async () => {
    page.answerWith([
      orderResult({ reason: "waiting for telemetry" }),
      orderResult({ serial: "SN-002", vehicle_name: "Birch", command_id: 42 }),
      orderResult({ vehicle_name: "Cedar", accepted: false, rule: "busy", reason: "unanswered" }),
    ]);
    const order = { serials: ["SN-001"], order: { kind: "land" } } as const;
    await page.shared.orderApi.order(order, ["1 Alder"]);
    expect(line()).toContain("Land: 0 of 3 landing. Refused: Cedar: unanswered");
    expect(page.root.querySelector(".toast-lines")).toBeNull();
    find(page.root, ".toast-names").click();
    const lines = [...page.root.querySelectorAll(".toast-lines li")].map((li) => li.textContent);
    expect(lines).toEqual([
      "Not landing yet: Alder (waiting for telemetry) and Birch",
      "Refused: unanswered: Cedar",
    ]);
  });

  it("counts the vehicles that telemetry shows holding", async () => {
    page.answerWith([1, 2].map((n) => orderResult({ serial: `SN-00${n}`, command_id: 40 + n })));
    await stopAll();
    expect(line()).toContain("All stop: 0 of 2 holding");
    const commands = [command(41), command(42, { phase: "acknowledged" })];
    page.receive(station([vehicle(1), vehicle(2)], { commands }));
    expect(line()).toContain("All stop: 1 of 2 holding");
    page.receive(station([vehicle(1), vehicle(2)], { commands: [command(41), command(42)] }));
    expect(line()).toContain("All stop: 2 of 2 holding");
  });

  it("does not call a drone on the ground refused, but one that may fly", async () => {
    page.receive(station([vehicle(1), vehicle(2, grounded), vehicle(4, { staleness: "lost" })]));
    page.answerWith([
      orderResult(),
      orderResult({
        ...notFlying,
        serial: "SN-002",
        vehicle_name: "Birch",
        reason: "on the ground",
      }),
      orderResult({ ...notFlying, serial: "SN-004", vehicle_name: "Dogwood", reason: "too old" }),
    ]);
    await stopAll();
    expect(line()).toContain("All stop: 0 of 2 holding. Refused: Dogwood: too old");
    find(page.root, ".toast-names").click();
    expect(find(page.root, ".toast-lines").textContent).toContain("On the ground: Birch");
  });

  it("shows after an all stop that no vehicle is flying", async () => {
    await stopAll();
    expect(line()).toContain("All stop: in force; no drone is flying");
  });
});
