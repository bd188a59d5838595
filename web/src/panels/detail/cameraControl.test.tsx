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

/** Lets the source's answer come in. */
async function answered(): Promise<void> {
  await Promise.resolve();
  await Promise.resolve();
}

describe("the camera's control", () => {
  it("starts at the chosen rate, and stops, for the one selected vehicle", () => {
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
    ["two", [1, 2], "select one vehicle alone"],
    ["one that has not said who it is", [-3], "has not said which aircraft"],
    ["one of those and another", [1, -3], "select one vehicle alone"],
  ])("gives no order while %s is selected, and says why", (_who, keys, why) => {
    page.shared.selection.all(keys);
    expect(buttons().map((button) => button.disabled)).toEqual(Array(5).fill(true));
    for (const button of buttons()) button.click();
    expect(page.orders).toEqual([]);
    expect(control().textContent).toContain(why);
  });

  it("shows the answer and follows the command", async () => {
    page.answerWith([orderResult()]);
    page.shared.selection.only(1);
    press("Start camera");
    expect(control().textContent).toContain("Camera on 1 Alder: asking the station");
    await answered();
    expect(control().textContent).toContain("Accepted: Alder (command 41)");
    const commands = [command(41, { kind: "camera_start", phase: "timed_out" })];
    page.say(station(VEHICLES, { commands }));
    expect(control().textContent).toContain("Camera on 1 Alder: timed out");
  });

  it("shows a refusal with its reason, also when another vehicle is selected by then", async () => {
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
    expect(control().textContent).toContain("Camera off 1 Alder");
    expect(control().textContent).toContain("Refused: Alder (busy): one is unanswered");
  });

  it("leaves the answers to the safety orders alone", async () => {
    page.shared.selection.only(1);
    press("Start camera");
    await answered();
    expect(page.shared.desk.last()).toBeNull();
  });
});
