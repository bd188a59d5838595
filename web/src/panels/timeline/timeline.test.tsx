import { afterEach, describe, expect, it } from "vitest";
import type { TimelineEntryView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { clockTime, TimelinePanel } from "./TimelinePanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

async function settled() {
  for (let turn = 0; turn < 5; turn += 1) await Promise.resolve();
}

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

  it("ends with its panel", async () => {
    await open(entry(1));
    page.dispose();
    const asked = page.timeline.asked.length;
    page.clock.advance(10_000);
    await settled();
    expect(page.timeline.asked).toHaveLength(asked);
  });
});
