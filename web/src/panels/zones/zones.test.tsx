import { afterEach, describe, expect, it } from "vitest";
import { station, vehicle, zone } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { zoneEnd, zoneHeights, zoneLabel } from "../../text/zones";
import { ZonesPanel } from "./ZonesPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

const HERE = { lon: -93.6, lat: 41.9 };
const CIRCLE = { latitude_deg: 41.9, longitude_deg: -93.6, radius_m: 20 };

function show(...zones: ReturnType<typeof zone>[]) {
  page = renderPage(ZonesPanel, station([vehicle(1)], { temporary_zones: zones }));
}

function press(text: string) {
  const buttons = [...page.root.querySelectorAll("button")];
  const button = buttons.find(({ textContent }) => textContent === text);
  if (button === undefined) throw new Error(`No button "${text}"`);
  button.click();
}

function hold(name: string, ms: number) {
  const button = find(page.root, `[aria-label^='${name}']`);
  button.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
  page.clock.advance(ms);
  button.dispatchEvent(new PointerEvent("pointerup", { bubbles: true, button: 0 }));
}

describe("a zone in force", () => {
  it("shows what, who, why and until when", () => {
    show(zone(3, [0, 0], { ends_in_s: 480 }));
    page.age(5);
    const text = find(page.root, "[data-testid=zone-3]").textContent;
    expect(text).toContain("Person 3");
    expect(text).toContain("up to 30\u00a0m above ground");
    expect(text).toContain("Checks a sprinkler");
    expect(text).toContain("2 min 15 s ago by Ann, ends in 7 min 55 s");
  });

  it("is ended by a long press only: that removes a safeguard", () => {
    show(zone(3));
    hold("End zone, hold 1.5 s: Person 3", 1400);
    expect(page.requests).toEqual([]);
    hold("End zone, hold 1.5 s: Person 3", 1600);
    expect(page.requests).toEqual([{ endedZone: 3 }]);
  });
});

describe("drawing a zone", () => {
  it("takes a press for the centre and one press to send", async () => {
    show();
    press("Draw a zone");
    const send = find<HTMLButtonElement>(page.root, ".zone-go");
    expect(send.disabled).toBe(true);
    page.shared.aim(HERE);
    expect(send.disabled).toBe(false);
    send.click();
    await Promise.resolve();
    await Promise.resolve();
    expect(page.requests).toEqual([
      {
        drawnZone: {
          kind: "person",
          reason: "Person in the field",
          lasts_s: null,
          circle: CIRCLE,
        },
      },
    ]);
    expect(page.shared.zoneDraft.isOn()).toBe(false);
  });

  it("takes three corners and more for an outline, and the last one back", () => {
    show();
    const { zoneDraft, aim } = page.shared;
    press("Draw a zone");
    zoneDraft.setShape("outline");
    for (const east of [0, 0.001, 0.002])
      aim({ lon: HERE.lon + east, lat: HERE.lat + east * east });
    expect(zoneDraft.zone()?.outline).toHaveLength(3);
    press("Undo corner");
    expect(zoneDraft.zone()).toBeNull();
    expect(page.root.textContent).toContain("1 more at least");
  });

  it("takes words and minutes, and waits while a number is missing", () => {
    show();
    const { zoneDraft, aim } = page.shared;
    press("Draw a zone");
    aim(HERE);
    zoneDraft.setKind("crewed_aircraft");
    zoneDraft.setReason(" helicopter ");
    zoneDraft.setMinutes("10");
    expect(zoneDraft.zone()).toMatchObject({ reason: "helicopter", lasts_s: 600 });
    zoneDraft.setMinutes("ten");
    expect(zoneDraft.zone()).toBeNull();
    zoneDraft.setMinutes("");
    zoneDraft.radius.type("-5");
    expect(zoneDraft.zone()).toBeNull();
  });

  it("keeps the drawn zone and shows why it was refused", async () => {
    show();
    page.answerRequestsWith({ accepted: false, rule: "temporary_zone", reason: "too far away" });
    press("Draw a zone");
    page.shared.aim(HERE);
    press("Keep clear now");
    await Promise.resolve();
    await Promise.resolve();
    expect(page.root.textContent).toContain("too far away");
    expect(page.shared.zoneDraft.points()).toEqual([HERE]);
  });

  it("and fly here take presses one at a time", () => {
    show();
    const { zoneDraft, flyHere, selection } = page.shared;
    selection.only(1);
    flyHere.toggle();
    zoneDraft.toggle();
    expect([flyHere.isOn(), zoneDraft.isOn()]).toEqual([false, true]);
    flyHere.toggle();
    expect([flyHere.isOn(), zoneDraft.isOn()]).toEqual([true, false]);
  });

  it("is cleared step by step", () => {
    show();
    const { zoneDraft, aim } = page.shared;
    expect(zoneDraft.clear()).toBe(false);
    zoneDraft.toggle();
    aim(HERE);
    expect(zoneDraft.clear()).toBe(true);
    expect([zoneDraft.points(), zoneDraft.isOn()]).toEqual([[], true]);
    zoneDraft.clear();
    expect(zoneDraft.isOn()).toBe(false);
  });
});

describe("a zone in words", () => {
  it("names kind, age and heights", () => {
    expect(zoneLabel(zone(3), 0)).toBe("Person 3, 2 min: keep out, up to 30\u00a0m above ground");
    expect(zoneLabel(zone(4, [0, 0], { age_s: 3 }), 0)).toContain("Person 4, new:");
    expect(zoneHeights({ floor_m: null, ceiling_m: null })).toBe("all heights");
    expect(zoneHeights({ floor_m: 10, ceiling_m: null })).toBe("from 10\u00a0m above ground up");
    expect(zoneHeights({ floor_m: 10, ceiling_m: 30 })).toBe("10\u00a0m to 30\u00a0m above ground");
    expect(zoneEnd(null, 0)).toBe("until ended");
  });
});
