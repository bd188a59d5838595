import { afterEach, describe, expect, it } from "vitest";
import type { ReplayView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { formatPosition } from "../../text/replay";
import { GuardButton } from "../guard/GuardButton";
import { markAt, ReplayBar, SPEEDS } from "./ReplayBar";

let page: RenderedPage;
afterEach(() => page.dispose());

const BEGIN_NS = 1.78e18;

function replayState(changes: Partial<ReplayView> = {}) {
  const replay: ReplayView = {
    file: "flight-a.mcap",
    duration_s: 7200,
    position_s: 600,
    speed: 1,
    is_playing: false,
    trouble: null,
    ...changes,
  };
  return station([vehicle(1)], { replay, time_ns: BEGIN_NS + 1e9 * replay.position_s });
}

const settled = () => new Promise((resolve) => setTimeout(resolve));
const transports = () =>
  page.requests.flatMap((request) => ("transport" in request ? [request.transport] : []));

function slideTo(value: number) {
  const slider = find<HTMLInputElement>(page.root, "input[type=range]");
  slider.value = String(value);
  slider.dispatchEvent(new InputEvent("input", { bubbles: true }));
}

describe("the replay bar", () => {
  it("is not there on a live station, and the title is Recon's", () => {
    page = renderPage(ReplayBar, station([vehicle(1)]));
    expect(page.root.textContent).toBe("");
    expect(document.title).toBe("Recon");
  });

  it("plays, pauses and changes the speed", async () => {
    page = renderPage(ReplayBar, replayState());
    expect(document.title).toBe("REPLAY · Recon");
    find<HTMLButtonElement>(page.root, "button[aria-label^=Play]").click();
    await settled();
    page.receive(replayState({ is_playing: true }));
    find<HTMLButtonElement>(page.root, "button[aria-label^=Pause]").click();
    const speed = find<HTMLSelectElement>(page.root, "select");
    expect([...speed.options].map(({ value }) => Number(value))).toEqual([...SPEEDS]);
    expect([SPEEDS[0], SPEEDS.at(-1)]).toEqual([0.1, 50]);
    speed.value = "50";
    speed.dispatchEvent(new Event("change", { bubbles: true }));
    await settled();
    expect(transports()).toEqual([{ is_playing: true }, { is_playing: false }, { speed: 50 }]);
  });

  it("plays and pauses by the space bar, also on the slider, not on other controls", async () => {
    page = renderPage(ReplayBar, replayState());
    const press = (target: Element) =>
      target.dispatchEvent(new KeyboardEvent("keydown", { key: " ", bubbles: true }));
    press(document.body);
    press(find(page.root, "select"));
    press(find(page.root, "input[type=range]"));
    await settled();
    expect(transports()).toEqual([{ is_playing: true }, { is_playing: true }]);
  });

  it("seeks one request at a time, and shows where to until the state is there", async () => {
    page = renderPage(ReplayBar, replayState());
    const slider = find<HTMLInputElement>(page.root, "input[type=range]");
    for (const at_s of [1000, 2000, 3000]) slideTo(at_s);
    expect(slider.getAttribute("aria-valuetext")).toMatch(/^50:00 of 2:00:00, local time \d/);
    await settled();
    expect(transports()).toEqual([{ position_s: 1000 }, { position_s: 3000 }]);
    page.receive(replayState({ position_s: 3001 }));
    page.clock.advance(1000);
    expect(find(page.root, ".replay-position").textContent).toBe("50:01 / 2:00:00");
  });

  it("goes to the alarms and orders of the record, and names them", async () => {
    page = renderPage(ReplayBar, replayState());
    page.showMarks({
      read_share: 1,
      marks: [
        { at_s: 60, kind: "order", text: "Drone 1: mission: queued" },
        { at_s: 900, kind: "alarm", text: "alarm: Drone 2: battery low" },
      ],
    });
    await settled();
    page.clock.advance(2000);
    await settled();
    find<HTMLButtonElement>(page.root, "button[aria-label='Next alarm or order']").click();
    await settled();
    expect(transports()).toEqual([{ position_s: 900 }]);
    page.receive(replayState({ position_s: 900 }));
    expect(find(page.root, ".replay-mark-text").textContent).toBe("alarm: Drone 2: battery low");
    expect(find(page.root, ".replay-alarms").getAttribute("d")).toBe("M125 0V12");
    expect(find(page.root, ".replay-orders").getAttribute("d")).toBe("M8 12V24");
  });

  it("states why a record ends early", () => {
    page = renderPage(ReplayBar, replayState({ trouble: "the file was cut" }));
    expect(page.root.textContent).toContain("The record ends early: the file was cut");
  });

  it("has no order to give, and the reason on what is left", () => {
    page = renderPage(
      () => <GuardButton label="Abort" hold_ms={1500} subject="a" onConfirm={() => undefined} />,
      replayState(),
    );
    const button = find<HTMLButtonElement>(page.root, "button");
    expect(button.getAttribute("aria-disabled")).toBe("true");
    expect(button.title).toBe("This is a replay: no orders are possible");
    expect(button.textContent).toBe("Abort replay");
  });
});

describe("marks and positions", () => {
  it("names the newest mark of the last ten seconds", () => {
    page = renderPage(() => "", null);
    const mark = { at_s: 60, kind: "order", text: "hover" } as const;
    expect(markAt([mark], 59)).toBeNull();
    expect(markAt([mark], 60)).toBe(mark);
    expect(markAt([mark], 69)).toBe(mark);
    expect(markAt([mark], 71)).toBeNull();
  });

  it("counts hours only from an hour on", () => {
    page = renderPage(() => "", null);
    expect(formatPosition(0)).toBe("0:00");
    expect(formatPosition(245.9)).toBe("4:05");
    expect(formatPosition(3845)).toBe("1:04:05");
  });
});
