import { afterEach, describe, expect, it } from "vitest";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { CalibrationPanel } from "./CalibrationPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

const HERE = { lon: -93.6, lat: 41.9 };
const SURVEYED = { name: "GATE", latitude_deg: 41.9, longitude_deg: -93.6, altitude_m: 271 };

async function frozen() {
  const base = station([vehicle(1)]);
  const site = base.site === null ? null : { ...base.site, imager_serials: ["EYE"] };
  page = renderPage(CalibrationPanel, { ...base, site });
  page.site.frozen = { ...page.site.frozen, surveyed: [SURVEYED] };
  page.shared.setMapCentre(() => ({ ...HERE, width_m: 500 }));
  button("Freeze a frame").click();
  await settled();
  return page.shared.calibration;
}

const button = (text: string) => findButton(page.root, text);

async function solved() {
  page.clock.advance(400);
  await settled();
}

describe("marking control points", () => {
  it("makes points of presses on frame and map in either order, and solves at once", async () => {
    const draft = await frozen();
    draft.markFrame({ col: 100, row: 50 });
    expect(page.root.textContent).toContain("Press P1 on the map.");
    page.shared.aim(HERE);
    draft.markFrame({ col: 200, row: 60 });
    draft.aim({ lon: -93.601, lat: 41.9 });
    draft.select(null);
    draft.aim({ lon: -93.602, lat: 41.9 });
    expect(page.root.textContent).toContain("Press P3 on the frame.");
    await solved();
    const [, asked] = page.site.askedFits.at(-1) ?? [];
    expect(asked).toMatchObject({
      serial: "EYE",
      frame_id: 7,
      points: [
        { name: "P1", col_px: 100, row_px: 50, latitude_deg: 41.9, altitude_m: null },
        { name: "P2", col_px: 200, row_px: 60 },
      ],
    });
    expect(page.root.textContent).toContain("RMS 1.25");
    expect(button("Accept and save").title).toBe("Mark or delete P3 first");
    button("Delete P3").click();
    await solved();
    button("Accept and save").click();
    await settled();
    expect(page.site.askedFits.at(-1)?.[0]).toBe("accept");
    expect(page.root.textContent).toContain("The next frames are placed by these points");
    expect(draft.isOn()).toBe(false);
  });

  it("shows the residual of each point, and the reason why there is no camera", async () => {
    const draft = await frozen();
    page.site.fit = {
      ...page.site.fit,
      residuals: [{ name: "P1", col_px: 3, row_px: -4, ground_m: 1.5 }],
    };
    draft.markFrame({ col: 100, row: 50 });
    draft.aim(HERE);
    await solved();
    expect(find(page.root, ".point-list").textContent).toContain("5.0\u00a0px · 1.50\u00a0m");
    const line = find(page.root, ".frame-residuals line");
    expect([line.getAttribute("x2"), line.getAttribute("y2")]).toEqual(["70.5", "90.5"]);
    const reason = "expected at least 4 control points, got 1";
    page.site.fit = { ...page.site.fit, accepted: false, reason, rms_px: null, residuals: [] };
    draft.nudge(draft.points()[0]?.id ?? 0, 1, 0);
    await solved();
    expect(page.root.textContent).toContain(reason);
    expect(button("Accept and save").disabled).toBe(true);
  });

  it("goes from one surveyed point to the next", async () => {
    const draft = await frozen();
    page.site.frozen = { ...page.site.frozen, surveyed: [SURVEYED, { ...SURVEYED, name: "OAK" }] };
    await draft.freeze("EYE");
    draft.useSurveyed();
    draft.markFrame({ col: 1, row: 2 });
    draft.markFrame({ col: 3, row: 4 });
    expect(draft.points().map(({ pixel }) => pixel?.col)).toEqual([1, 3]);
    draft.markFrame({ col: 5, row: 6 });
    expect(draft.points().map(({ name }) => name)).toEqual(["GATE", "OAK", "P1"]);
  });

  it("goes with the keyboard alone, and keeps points on the frame", async () => {
    const draft = await frozen();
    button("Use the site's 1 surveyed point").click();
    button("Mark frame centre").click();
    expect(draft.points()).toMatchObject([
      { name: "GATE", pixel: { col: 639.5, row: 359.5 }, altitude_m: 271 },
    ]);
    const press = (key: string, shiftKey = false) =>
      button("GATE on the frame").dispatchEvent(
        new KeyboardEvent("keydown", { key, shiftKey, bubbles: true }),
      );
    press("ArrowLeft");
    press("ArrowDown", true);
    expect(draft.points()[0]?.pixel).toEqual({ col: 638.5, row: 369.5 });
    draft.nudge(draft.points()[0]?.id ?? 0, -5000, 5000);
    expect(draft.points()[0]?.pixel).toEqual({ col: 0, row: 719 });
    // A place moved by hand is on the ground there, not at the surveyed height.
    button("Place at map centre").click();
    expect(draft.points()[0]?.altitude_m).toBe(null);
    press("Delete");
    expect(draft.points()).toEqual([]);
  });

  it("shows no answer about points that have changed since", async () => {
    const draft = await frozen();
    draft.markFrame({ col: 100, row: 50 });
    draft.aim(HERE);
    await solved();
    expect(draft.fit()?.rms_px).toBe(1.25);
    draft.nudge(draft.points()[0]?.id ?? 0, 1, 0);
    expect(draft.fit()).toBe(null);
  });

  it("shows why no frame can be frozen", async () => {
    await frozen();
    const reason = "No frame of the imaging drone yet; switch its camera on";
    page.site.frozen = { ...page.site.frozen, accepted: false, frame_id: null, reason };
    button("Freeze another frame").click();
    await settled();
    expect(page.root.textContent).toContain(reason);
  });
});
