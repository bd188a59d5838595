import { afterEach, describe, expect, it } from "vitest";
import type { FlownRegionView, SurveyView } from "../../protocol";
import { flownRegion, survey } from "../../testing/fakeField";
import { area, station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { left_m2, leftText } from "../../text/flown";
import { SurveyPanel } from "./SurveyPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

async function show(regions: FlownRegionView[], ...surveys: SurveyView[]) {
  const plain = station([vehicle(1)]);
  const site = plain.site && { ...plain.site, areas: [area("survey", [0, 0], 80)] };
  page = renderPage(SurveyPanel, { ...plain, site });
  page.showFlown(...regions);
  page.receive({ ...plain, site, surveys });
  await settled();
}

const entry = () => page.root.querySelector<HTMLElement>("[data-testid^=flown-]");

it("a survey that is over leads to its photos", async () => {
  await show([], survey(7, { phase: "done" }));
  findButton(page.root, "Photos of this flight").click();
  expect(page.shared.panels.isOpen("photos")).toBe(true);
  page.dispose();
  await show([], survey(7));
  expect(page.root.textContent).not.toContain("Photos of this flight");
});

describe("a region that was flown", () => {
  it("is resumed by one button that says how much is left and when it was flown", async () => {
    await show([flownRegion()], survey(7, { phase: "aborted" }));
    expect(page.root.textContent).toContain("Resume a survey");
    expect(entry()?.textContent).toContain("40 % left · 0.8\u00a0ha");
    expect(entry()?.textContent).toContain("Flown today (0.6\u00a0ha), 1 May 2026 (0.9\u00a0ha)");
    expect(find<HTMLDetailsElement>(page.root, "details").open).toBe(true);
    find(page.root, "[aria-label='Resume south field: plan the rest']").click();
    expect(page.requests).toEqual([
      { surveyAgain: { id: "77fbea7c1a8d8637", since: null, all_again: false, gaps: false } },
    ]);
  });

  it("leaves out what was imaged since the chosen day, or nothing", async () => {
    await show([flownRegion()], survey(7, { phase: "done" }));
    const choose = async (value: string) => {
      const select = find<HTMLSelectElement>(page.root, "[data-testid^=flown-] select");
      select.value = value;
      select.dispatchEvent(new Event("change", { bubbles: true }));
      find(page.root, "[data-testid^=flown-] button").click();
      await settled();
    };
    const options = [...page.root.querySelectorAll("[data-testid^=flown-] option")];
    expect(options.map((each) => each.textContent)).toEqual([
      "since it began, 1 May 2026",
      "today",
      "never: fly all again",
    ]);
    await choose("2026-05-03");
    expect(entry()?.textContent).toContain("75 % left");
    await choose("none");
    expect(entry()?.textContent).toContain("100 % left");
    expect(page.requests).toMatchObject([
      { surveyAgain: { since: "2026-05-03", all_again: false } },
      { surveyAgain: { since: null, all_again: true } },
    ]);
  });

  it("is not offered while its own survey is planned, flown or paused", async () => {
    for (const phase of ["created", "running", "paused"] as const) {
      await show([flownRegion()], survey(7, { phase }));
      expect(entry()).toBeNull();
      page.dispose();
    }
    await show([flownRegion()], survey(7, { region: "north field" }));
    expect(entry()).not.toBeNull();
  });

  it("that is complete is flown again, as a whole", async () => {
    await show([flownRegion({ left_m2: 100 })], survey(7, { phase: "done" }));
    expect(page.root.textContent).toContain("Fly a region again");
    expect(entry()?.querySelector("button")?.textContent).toBe("Plan all of it again");
  });

  it("says what differs, and why it cannot be flown again", async () => {
    const changes = [
      "the region's outline has moved by up to 12.0 m: it was 2.00 ha and is 2.10 ha",
    ];
    await show([flownRegion({ changes })], survey(7, { phase: "done" }));
    expect(entry()?.textContent).toContain("outline has moved by up to 12.0");
    page.dispose();
    const refusal = "the site has no survey region 'south field' any more";
    await show([flownRegion({ refusal })], survey(7, { phase: "done" }));
    expect(entry()?.textContent).toContain(refusal);
    expect(entry()?.querySelector("button")).toBeNull();
  });
});

it("what is left counts cells in sun, or in any light where the planner wants no sun", () => {
  const region = flownRegion();
  expect(left_m2(region, { since: "2026-05-01" })).toBe(8_000);
  const any = flownRegion({ planner: "lawnmower_once" });
  expect(left_m2(any, { since: "2026-05-01" })).toBe(5_000);
  expect(leftText(flownRegion({ left_m2: 1 }), "begun")).toBe("Complete");
});

it("the rows' origin is shown with a survey", async () => {
  const rows_note = "Same rows as on 2026-05-01";
  await show([], survey(7, { phase: "created", rows_note }));
  expect(page.root.textContent).toContain("50\u00a0m above takeoff · Same rows as on 2026-05-01");
});
