import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { command, orderResult, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { VehicleDetail } from "./VehicleDetail";

const VEHICLES = [vehicle(1), vehicle(2), vehicle(3, { number: 0, serial: null })];
let page: RenderedPage;

beforeEach(() => {
  page = renderPage(VehicleDetail, station(VEHICLES));
});

afterEach(() => page.dispose());

const control = () => find(page.root, ".camera-control");
const buttons = () => [...control().querySelectorAll("button")];

function press(name: string): void {
  const button = buttons().find((one) => one.textContent === name);
  if (button === undefined) throw new Error(`The camera has no button ${name}.`);
  button.click();
}

/** Waits for the source's answer. */
async function answered(): Promise<void> {
  await Promise.resolve();
  await Promise.resolve();
}

describe("camera control", () => {
  it("starts at the selected rate, and stops, for the selected vehicle", () => {
    page.shared.selection.only(2);
    press("Start camera");
    press("5");
    press("Start camera");
    press("Stop camera");
    expect(page.orders).toEqual([
      { serials: ["SN-002"], order: { kind: "camera_start", fps_hz: 1 } },
      { serials: ["SN-002"], order: { kind: "camera_start", fps_hz: 5 } },
      { serials: ["SN-002"], order: { kind: "camera_stop" } },
    ]);
  });

  it.each([
    ["nothing", [], "select a vehicle first"],
    ["two", [1, 2], "select only one vehicle"],
    ["an unidentified one", [-3], "waiting for serial number"],
    ["an unidentified one and another", [1, -3], "select only one vehicle"],
  ])("sends no order while %s is selected, with the reason", (_selected, keys, reason) => {
    page.shared.selection.all(keys);
    expect(buttons().map((button) => button.disabled)).toEqual(Array(5).fill(true));
    for (const button of buttons()) button.click();
    expect(page.orders).toEqual([]);
    expect(control().textContent).toContain(reason);
  });

  it("shows the answer and the command's phase", async () => {
    page.answerWith([orderResult()]);
    page.shared.selection.only(1);
    press("Start camera");
    expect(control().textContent).toContain("Camera on: sent to 1 Alder, waiting for the station");
    await answered();
    expect(control().textContent).toContain("Camera on Alder: accepted");
    const commands = [command(41, { kind: "camera_start", phase: "timed_out" })];
    page.receive(station(VEHICLES, { commands }));
    expect(control().textContent).toContain("Timed out");
  });

  it("shows a refusal with its reason, even after the selection has changed", async () => {
    const refused = {
      accepted: false,
      command_id: 42,
      rule: "busy",
      reason: "one is unanswered",
    };
    page.answerWith([orderResult(refused)]);
    page.shared.selection.only(1);
    press("Stop camera");
    page.shared.selection.clear();
    await answered();
    expect(control().textContent).toContain(
      "Camera off: 0 of 1 accepted. Refused: Alder: one is unanswered",
    );
  });

  it("does not replace the answers to safety orders", async () => {
    page.shared.selection.only(1);
    press("Start camera");
    await answered();
    expect(page.shared.orderApi.lastAnswer()).toBeNull();
  });
});
