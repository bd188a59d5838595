import { afterEach, describe, expect, it } from "vitest";
import { shadeLine, survey } from "../../testing/fakeField";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { gradient, knownPart, nearestRight, TimeScale, ticksOf } from "./TimeScale";

let page: RenderedPage;
afterEach(() => page.dispose());

const forecast = () => {
  const found = shadeLine().forecast;
  if (found === null) throw new Error("expected a forecast in the fake state");
  return found;
};

function show(changes: Parameters<typeof shadeLine>[0] = {}) {
  page = renderPage(TimeScale, station([vehicle(1)], { shade: shadeLine(changes) }));
}

describe("the time scale", () => {
  it("shows how much of the field is in sun now and later, and how right that was", () => {
    show();
    expect(page.root.textContent).toContain("Sun now · 62\u00a0% of the field");
    expect(page.root.textContent).not.toContain("correct recently");
    const slider = find<HTMLInputElement>(page.root, "input[type=range]");
    slider.value = "2";
    slider.dispatchEvent(new InputEvent("input", { bubbles: true }));
    expect(page.shared.overlay.lead_s()).toBe(60);
    expect(page.shared.overlay.kind()).toBe("forecast");
    const text = page.root.textContent;
    expect(text).toContain("Sun in 1 min · 71\u00a0% of the field · 93\u00a0% correct recently");
    expect(slider.getAttribute("aria-valuetext")).toBe("Sun in 1 min");
  });

  it("ends where nothing of the field is known any more", () => {
    const lead_s = [0, 30, 60, 120, 600];
    const share = [1, 1, 1, 1, 1];
    const cut = (predicted_share: number[]) =>
      knownPart({ ...forecast(), lead_s, sun_share: share, predicted_share }).lead_s;
    expect(cut([1, 0.8, 0.4, 0.2, 0])).toEqual([0, 30, 60, 120]);
    expect(cut([0, 0, 0, 0, 0])).toEqual([0, 30, 60]);
    expect(cut([1, 1, 1, 1, 0.1])).toEqual(lead_s);
  });

  it("has labels and a legend", () => {
    show();
    const ticks = [...page.root.querySelectorAll(".time-ticks span")].map((one) => one.textContent);
    expect(ticks).toEqual(["now", "30 s", "1 min"]);
    expect(find(page.root, ".legend").textContent).toBe("sunshadenot known: an estimate");
  });

  it("claims no record that it does not have, and needs a forecast", () => {
    page = renderPage(TimeScale, station([vehicle(1)]));
    expect(page.root.textContent).toBe("");
    expect(nearestRight({ ...forecast(), right: [] }, 60)).toBeNull();
    expect(nearestRight(forecast(), 0)).toBeNull();
    expect(nearestRight(forecast(), 45)).toBe(0.93);
  });

  it("fades with what is known", () => {
    expect(gradient(forecast())).toMatch(/ 20%, transparent\) 100%\)$/);
  });

  it("has the colour of shade where the field will be in shade", () => {
    const leads = { lead_s: [0, 60], predicted_share: [1, 0.5] };
    const closing = gradient({ ...forecast(), ...leads, sun_share: [0.9, 0.04] });
    expect(closing).toContain(
      "color-mix(in srgb, var(--sun) 90%, var(--shade)) 100%, transparent) 0%",
    );
    expect(closing).toContain(
      "color-mix(in srgb, var(--sun) 4%, var(--shade)) 50%, transparent) 100%",
    );
  });

  it("labels first and last leads, and none over another", () => {
    const leads = [...Array(9).keys()].map((n) => 15 * n).concat([150, 180, 240, 300, 420, 600]);
    const ticks = ticksOf(leads);
    expect(ticks[0]?.lead).toBe(0);
    expect(ticks.at(-1)?.lead).toBe(600);
    const gaps = ticks.slice(1).map(({ at }, index) => at - (ticks[index]?.at ?? 0));
    expect(Math.min(...gaps)).toBeGreaterThan(0.079);
    const coarse = ticks.filter(({ isCoarse }) => isCoarse);
    expect([coarse[0]?.lead, coarse.at(-1)?.lead]).toEqual([0, 600]);
    expect(coarse.length).toBeGreaterThan(3);
    const between = coarse.slice(1).map(({ at }, index) => at - (coarse[index]?.at ?? 0));
    expect(Math.min(...between)).toBeGreaterThan(0.18);
  });
});

describe("the overlay", () => {
  it("is an active survey's coverage until another is selected", () => {
    const surveys = [survey(1, { phase: "running" })];
    page = renderPage(TimeScale, station([vehicle(1)], { surveys, shade: shadeLine() }));
    expect(page.shared.overlay.kind()).toBe("cells");
    page.shared.overlay.show("none");
    expect(page.shared.overlay.kind()).toBe("none");
  });
});
