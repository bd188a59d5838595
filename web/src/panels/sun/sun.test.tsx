import { afterEach, describe, expect, it } from "vitest";
import { shadeLine, station, survey, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { SunPanel } from "./SunPanel";

let page: RenderedPage;
afterEach(() => page.dispose());

function show(changes: Parameters<typeof shadeLine>[0] = {}) {
  page = renderPage(SunPanel, station([vehicle(1)], { shade: shadeLine(changes) }));
}

describe("sun and shade", () => {
  it("tells how much of what is known lies in sun, and how old that is", () => {
    show();
    expect(page.root.textContent).toContain(
      "In sun: 62\u00a0% of what is known (90\u00a0% of the view), seen 1.5 s ago",
    );
    page.age(4);
    expect(page.root.textContent).toContain("seen 5.5 s ago");
  });

  it("shows on the map what is chosen", () => {
    show();
    find<HTMLInputElement>(page.root, "input[type=radio][name=overlay]:not(:checked)").click();
    expect(page.shared.overlay.kind()).toBe("shade");
  });

  it("shows a flown survey's cells until something else is chosen", () => {
    page = renderPage(
      SunPanel,
      station([vehicle(1)], { surveys: [survey(1, { phase: "running" })] }),
    );
    expect(page.shared.overlay.kind()).toBe("cells");
    find<HTMLInputElement>(page.root, "input[type=radio][name=overlay]:not(:checked)").click();
    expect(page.shared.overlay.kind()).toBe("none");
  });

  it("looks ahead by the forecast's own leads", () => {
    show();
    expect(page.root.textContent).toContain("Sun now: ");
    const slider = find<HTMLInputElement>(page.root, "input[type=range]");
    slider.value = "2";
    slider.dispatchEvent(new InputEvent("input", { bubbles: true }));
    expect(page.shared.overlay.lead_s()).toBe(60);
    expect(page.root.textContent).toContain("Sun in 1 min 0 s: ");
    expect(page.shared.overlay.kind()).toBe("forecast");
    expect(page.root.textContent).toContain("20\u00a0% of the view foreseen");
  });

  it("says why no shade is read", () => {
    show({ rejected: "expected a picture, got black", map: null, forecast: null });
    expect(page.root.textContent).toContain("expected a picture, got black");
    expect(page.root.textContent).toContain("No shade has been read yet");
  });

  it("says that a site without an eye has none", () => {
    page = renderPage(SunPanel, station([vehicle(1)]));
    expect(page.root.textContent).toContain("This site has no eye");
  });
});
