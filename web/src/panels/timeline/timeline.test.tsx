import { afterEach, describe, expect, it } from "vitest";
import type { TimelineEntryView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { clockTime, TimelinePanel } from "./TimelinePanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

function entry(n: number, changes: Partial<TimelineEntryView> = {}): TimelineEntryView {
  const utc = "2026-05-01T12:00:00.5Z";
  const one = { n, utc, kind: "order.sent", by: "anna (10.0.0.2)", serial: "A", vehicle: "Alder" };
  return { ...one, text: `hover ${n}: sent by order 7`, ...changes };
}

async function open(...entries: TimelineEntryView[]) {
  page = renderPage(TimelinePanel, station([vehicle(1), vehicle(2)]));
  await settled();
  page.timeline.entries = entries;
  page.clock.advance(2000);
  await settled();
}

function lines(): string[] {
  return [...page.root.querySelectorAll(".timeline-line")].map(
    ({ textContent }) => textContent ?? "",
  );
}

describe("the timeline", () => {
  it("shows when, what and who, without numbers and addresses", async () => {
    await open(entry(1));
    const time = clockTime("2026-05-01T12:00:00.5Z");
    expect(lines()).toEqual([`${time}Hover 1: sent by a newer order Anna`]);
  });

  it("follows, and joins new entries to those shown", async () => {
    await open(entry(2), entry(1));
    page.timeline.entries.unshift(entry(3));
    page.clock.advance(2000);
    await settled();
    expect(lines().map((line) => line.slice(8, 15))).toEqual(["Hover 3", "Hover 2", "Hover 1"]);
  });

  it("asks for one drone, and for earlier entries", async () => {
    const many = Array.from({ length: 70 }, (_, index) => entry(70 - index));
    await open(...many);
    expect(lines()).toHaveLength(50);
    find<HTMLButtonElement>(page.root, ".section .button").click();
    await settled();
    expect(page.timeline.asked.at(-1)?.before).toBe(21);
    expect(lines()).toHaveLength(70);
    page.clock.advance(2000);
    await settled();
    expect(lines()).toHaveLength(70);
    const drone = find<HTMLSelectElement>(page.root, "select");
    drone.value = drone.options[2]?.value ?? "";
    drone.dispatchEvent(new Event("change", { bubbles: true }));
    await settled();
    expect(page.timeline.asked.at(-1)?.serial).toBe(page.shared.fleet.vehicles[1]?.serial);
    expect(lines()).toEqual([]);
  });

  it("adds earlier entries once, however often they are asked for", async () => {
    await open(...Array.from({ length: 170 }, (_, index) => entry(170 - index)));
    const earlier = find<HTMLButtonElement>(page.root, ".section .button");
    earlier.click();
    earlier.click();
    await settled();
    expect(lines()).toHaveLength(150);
    expect(new Set(lines()).size).toBe(150);
  });

  it("drops earlier entries that no longer follow the last one shown", async () => {
    await open(...Array.from({ length: 170 }, (_, index) => entry(170 - index)));
    page.timeline.entries = Array.from({ length: 470 }, (_, index) => entry(470 - index));
    // More came than one page holds, so the newest replace those shown, just before the earlier ones come.
    page.clock.advance(2000);
    find<HTMLButtonElement>(page.root, ".section .button").click();
    await settled();
    const numbers = lines().map((line) => Number(/Hover (\d+)/.exec(line)?.[1]));
    expect(numbers).toEqual(numbers.map((_, index) => 470 - index));
  });

  it("keeps the newest 500", async () => {
    const count = 650;
    await open(...Array.from({ length: count }, (_, index) => entry(count - index)));
    for (let press = 0; press < 5; press += 1) {
      find<HTMLButtonElement>(page.root, ".section .button").click();
      await settled();
    }
    expect(lines()).toHaveLength(500);
    expect(page.root.textContent).toContain("The newest 500 are shown");
    page.timeline.entries.unshift(entry(count + 1));
    page.clock.advance(2000);
    await settled();
    expect(lines()).toHaveLength(500);
    expect(lines()[0]).toContain(`Hover ${count + 1}`);
  });

  it("states that nothing has happened only when the station has answered so", async () => {
    page = renderPage(TimelinePanel, station([vehicle(1)]));
    expect(page.root.textContent).not.toContain("Nothing has happened");
    await settled();
    expect(page.root.textContent).toContain("Nothing has happened");
    page.timeline.problem = "Station unreachable";
    page.clock.advance(2000);
    await settled();
    expect(page.root.textContent).toContain("Station unreachable");
    expect(page.root.textContent).not.toContain("Nothing has happened");
  });

  it("ends with its panel, also before an answer", async () => {
    await open(entry(1));
    page.clock.advance(2000);
    page.dispose();
    const asked = page.timeline.asked.length;
    await settled();
    page.clock.advance(10_000);
    await settled();
    expect(page.timeline.asked).toHaveLength(asked);
  });
});
