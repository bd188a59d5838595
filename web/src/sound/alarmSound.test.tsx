import { afterEach, describe, expect, it } from "vitest";
import { AlarmList } from "../panels/alarms/AlarmList";
import { SilenceBanner } from "../panels/alarms/SoundControls";
import { AlarmsButton } from "../panels/bar/AlarmsButton";
import type { AlarmView } from "../protocol";
import { alarm, station, vehicle } from "../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage } from "../testing/renderPage";
import { createMutes } from "./mutes";

let page: RenderedPage;
afterEach(() => page?.dispose());

const withAlarms = (...alarms: AlarmView[]) => station([vehicle(1)], { alarms });
const pair = (id: number) => alarm(id, { rule: "separation", severity: "critical" });
const PAGE = () => (
  <>
    <AlarmsButton />
    <SilenceBanner />
    <AlarmList />
  </>
);
const show = (...alarms: AlarmView[]) => {
  page = renderPage(PAGE, withAlarms(...alarms));
};
/** Time for every cause to be announced. */
const listen = (ms = 6000) => {
  for (let passed_ms = 0; passed_ms < ms; passed_ms += 100) page.tick(100);
  return page.announced.map(({ text }) => text);
};
const banner = () => page.root.querySelector(".silence")?.textContent ?? null;
const bar = () => find(page.root, ".bar-alarms");

describe("the sound of alarms", () => {
  it("announces each cause, neither notes nor what is acknowledged or over", () => {
    show(
      pair(1),
      pair(2),
      alarm(3, { is_acknowledged: true }),
      alarm(4, { rule: "gnss", is_active: false }),
      alarm(5, { rule: "app_message", severity: "info" }),
    );
    expect(listen()).toEqual(["Separation: 2 pairs"]);
    expect(banner()).toBeNull();
  });

  it("announces a lost connection, and not the alarms from before", () => {
    show(alarm(1));
    listen();
    page.connect({ kind: "lost", reason: "no answer", attempt: 1 });
    page.receive(withAlarms(alarm(1), pair(2)));
    expect(listen().slice(1)).toEqual(["Station: No connection"]);
  });

  it("is silent in a replay", () => {
    show();
    const replay = {
      file: "a.mcap",
      duration_s: 10,
      position_s: 1,
      speed: 1,
      is_playing: true,
      trouble: null,
    };
    page.receive({ ...withAlarms(pair(1)), replay });
    expect(listen()).toEqual([]);
    expect(page.root.textContent).toContain("A replay makes no sound.");
  });
});

describe("muting", () => {
  it("is by kind, is shown, and ends with a press", () => {
    show(alarm(1), alarm(2, { rule: "gnss", severity: "error" }));
    findButton(page.root, "Mute GNSS").click();
    expect(listen()).toEqual(["Dogwood: Aircraft battery warning: low, 28 % left."]);
    expect(bar().getAttribute("aria-label")).toBe("2 alarms, muted: GNSS");
    expect(bar().querySelector(".speaker-icon")).not.toBeNull();
    findButton(page.root, "Unmute GNSS").click();
    expect(bar().getAttribute("aria-label")).toBe("2 alarms");
    expect(listen()).toHaveLength(2);
  });

  it("of all is shown in the bar", () => {
    show(alarm(1));
    findButton(page.root, "Mute all").click();
    expect(listen()).toEqual([]);
    expect(bar().getAttribute("aria-label")).toBe("1 alarm, all muted");
    expect(page.root.textContent).toContain("All alarms are muted in this browser.");
  });

  it.each([
    ["a collision", pair(1)],
    ["a stop that may be lost", alarm(1, { rule: "stop_waits", severity: "error" })],
    ["anything critical", alarm(1, { rule: "gnss", severity: "critical" })],
  ])("never hides %s: a notice stays until it sounds again", (_, one) => {
    show(one);
    findButton(page.root, "Mute all").click();
    expect(listen()).toEqual([]);
    expect(banner()).toContain("No sound for:");
    expect(banner()).toContain(page.shared.alarmSound.silenced()[0]?.title ?? "?");
    findButton(page.root, "Unmute").click();
    expect(banner()).toBeNull();
    expect(listen()).toHaveLength(1);
  });

  it("shows no notice for a warning", () => {
    show(alarm(1));
    findButton(page.root, "Mute all").click();
    expect(banner()).toBeNull();
  });

  it("shows that the browser is silent, and announces again when it is not", () => {
    show(pair(1));
    expect(listen()).toHaveLength(1);
    page.blockSound("blocked");
    expect(banner()).toContain("Press anywhere on this page");
    page.blockSound(null);
    expect(banner()).toBeNull();
    expect(listen(1000)).toHaveLength(2);
  });

  it("is kept in this browser", () => {
    const kept = new Map<string, string>();
    const storage = {
      getItem: (key: string) => kept.get(key) ?? null,
      setItem: (key: string, value: string) => kept.set(key, value),
    };
    createMutes(storage).mute("separation", true);
    const again = createMutes(storage);
    expect([again.isMuted("separation"), again.isMuted("gnss")]).toEqual([true, false]);
    again.muteAll(true);
    expect(createMutes(storage).isMuted("gnss")).toBe(true);
    again.muteAll(false);
    expect(createMutes(storage).kinds()).toEqual(["separation"]);
  });
});

describe("an alarm that has ended", () => {
  it("leaves no colour", () => {
    show(alarm(1));
    expect(bar().className).toContain("tone-ground-warning");
    page.receive(withAlarms(alarm(1, { is_active: false })));
    expect(bar().className).not.toContain("tone-ground");
    expect(bar().textContent).toContain("0 alarms");
    expect(find(page.root, "li.alarm").className).toContain("is-over");
  });
});
