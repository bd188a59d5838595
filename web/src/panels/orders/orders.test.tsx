import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { orderResult, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { AllStop } from "../bar/TopBar";
import { OrderBar } from "./OrderBar";

const FLEET = station([vehicle(1), vehicle(2), vehicle(3, { number: 0, serial: null })]);
let page: RenderedPage;

beforeEach(() => {
  page = renderPage(
    () => (
      <>
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
    expect(find(page.root, ".orders-to").textContent).toBe("Orders go to 1 Alder and 2 Birch");
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

  it("needs a shorter hold for hover", () => {
    page.shared.selection.only(1);
    const hover = find(page.root, ".order-hover");
    hover.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
    page.clock.advance(450);
    expect(page.orders).toEqual([{ serials: ["SN-001"], order: { kind: "hover" } }]);
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
  const answer = () => find(page.root, ".answer-text");
  const settled = async () => {
    for (let turn = 0; turn < 3; turn += 1) await Promise.resolve();
  };

  it("marks simulated vehicles and shows what an accepted order waits for", async () => {
    const reason = "waiting for telemetry";
    page.answerWith([
      orderResult({ is_simulated: true, reason }),
      orderResult({ serial: "SN-002", vehicle_name: "Birch", command_id: 42 }),
      orderResult({
        vehicle_name: "Cedar",
        is_simulated: true,
        accepted: false,
        rule: "busy",
        reason: "one is unanswered",
      }),
    ]);
    const order = { serials: ["SN-001"], order: { kind: "land" } } as const;
    await page.shared.orderApi.order(order, ["1 Alder"]);
    const lines = [...answer().querySelectorAll(".answer-line > span:last-child")];
    expect(lines.map((line) => line.textContent)).toEqual([
      "Accepted: Alder SIM and Birch",
      `Alder SIM: ${reason}`,
      "Refused: Cedar SIM: one is unanswered",
    ]);
    expect(answer().querySelectorAll(".tag-simulated")).toHaveLength(3);
  });

  it("to an all stop reports that nothing is flying", async () => {
    find(page.root, ".all-stop").click();
    await settled();
    expect(answer().textContent).toContain("No connected vehicle reports that it is flying.");
  });
});
