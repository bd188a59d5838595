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
  it("shows the share of the measured area in sun, and its age", () => {
    show();
    expect(page.root.textContent).toContain(
      "In sun: 62\u00a0% of the measured area (90\u00a0% of the view), 1.5 s ago",
    );
    page.age(4);
    expect(page.root.textContent).toContain("5.5 s ago");
  });

  it("shows the selected overlay on the map", () => {
    show();
    find<HTMLInputElement>(page.root, "input[type=radio][name=overlay]:not(:checked)").click();
    expect(page.shared.overlay.kind()).toBe("shade");
  });

  it("shows an active survey's coverage until another overlay is selected", () => {
    page = renderPage(
      SunPanel,
      station([vehicle(1)], { surveys: [survey(1, { phase: "running" })] }),
    );
    expect(page.shared.overlay.kind()).toBe("cells");
    find<HTMLInputElement>(page.root, "input[type=radio][name=overlay]:not(:checked)").click();
    expect(page.shared.overlay.kind()).toBe("none");
  });

  it("selects among the forecast's leads", () => {
    show();
    expect(page.root.textContent).toContain("Sun now: ");
    const slider = find<HTMLInputElement>(page.root, "input[type=range]");
    slider.value = "2";
    slider.dispatchEvent(new InputEvent("input", { bubbles: true }));
    expect(page.shared.overlay.lead_s()).toBe(60);
    expect(page.root.textContent).toContain("Sun in 1 min 0 s: ");
    expect(page.shared.overlay.kind()).toBe("forecast");
    expect(page.root.textContent).toContain("forecast covers 20\u00a0% of the view");
  });

  it("shows why there is no shade map", () => {
    show({ rejected: "expected a picture, got black", map: null, forecast: null });
    expect(page.root.textContent).toContain("expected a picture, got black");
    expect(page.root.textContent).toContain("No shade map yet");
  });

  it("reports a site without an imaging drone", () => {
    page = renderPage(SunPanel, station([vehicle(1)]));
    expect(page.root.textContent).toContain("No imaging drone at this site");
  });
});
