import type { Map as MapLibre } from "maplibre-gl";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Outcome, Picture } from "../protocol";
import { shadeLine, survey } from "../testing/fakeField";
import { station } from "../testing/fakeState";
import { settled } from "../testing/renderPage";
import { createOverlay, ForecastLayer, ShadeLayer, SurveyCellsLayer } from "./overlays";
import { pathFeatures } from "./surveyRowsLayer";

/** The parts of MapLibre an overlay uses; records calls. */
function fakeMap() {
  const sources = new Map<string, { urls: string[]; updateImage(to: { url: string }): void }>();
  const added: { id: string; before: string | undefined }[] = [];
  const map = {
    getSource: (id: string) => sources.get(id),
    addSource: (id: string, { url }: { url: string }) => {
      const urls = [url];
      sources.set(id, { urls, updateImage: (to) => urls.push(to.url) });
    },
    addLayer: ({ id }: { id: string }, before?: string) => added.push({ id, before }),
    removeLayer: () => undefined,
    removeSource: (id: string) => sources.delete(id),
    getStyle: () => ({
      layers: [
        { id: "ground", type: "background" },
        { id: "ground-image", type: "raster" },
        { id: "trails", type: "line" },
      ],
    }),
  };
  return { map: map as unknown as MapLibre, sources, added };
}

const fetchPicture = async (): Promise<Outcome<Picture>> => ({
  kind: "answered",
  value: { blob: new Blob(["x"]), frameId: 1 },
});

function scene(second: number, number: number) {
  const line = shadeLine();
  const shade = {
    ...line,
    map: line.map === null ? null : { ...line.map, number },
    forecast: line.forecast === null ? null : { ...line.forecast, number },
  };
  const state = station([], { time_ns: second * 1e9, shade, surveys: [survey(7)] });
  return {
    state,
    behindS: 0,
    selected: [],
    plannedTarget: null,
    missionDraft: null,
    zoneDraft: null,
    siteDraft: null,
  };
}

beforeEach(() => {
  vi.spyOn(URL, "createObjectURL").mockImplementation(() => "blob:1");
  vi.spyOn(URL, "revokeObjectURL").mockImplementation(() => undefined);
});
afterEach(() => vi.restoreAllMocks());

describe("the overlay", () => {
  it("is the selected one, above the ground image and below the lines", async () => {
    const { map, sources, added } = fakeMap();
    const overlay = createOverlay();
    const shadePicture = vi.fn(fetchPicture);
    const layer = new ShadeLayer(overlay, { shadePicture });
    layer.add(map);
    layer.update(scene(1, 3));
    expect(shadePicture).not.toHaveBeenCalled();
    overlay.show("shade");
    layer.update(scene(2, 3));
    await settled();
    expect(shadePicture).toHaveBeenCalledExactlyOnceWith(3);
    expect(added).toEqual([{ id: "shade", before: "trails" }]);
    layer.update(scene(3, 3));
    expect(shadePicture).toHaveBeenCalledOnce();
    layer.update(scene(4, 4));
    await settled();
    expect(shadePicture).toHaveBeenLastCalledWith(4);
    overlay.show("none");
    layer.update(scene(5, 5));
    expect(sources.has("shade")).toBe(false);
  });

  it("is fetched again for another lead", async () => {
    const overlay = createOverlay();
    const forecastPicture = vi.fn(fetchPicture);
    const layer = new ForecastLayer(overlay, { forecastPicture });
    layer.add(fakeMap().map);
    overlay.show("forecast");
    layer.update(scene(1, 3));
    await settled();
    overlay.setLead(60);
    layer.update(scene(2, 3));
    await settled();
    expect(forecastPicture.mock.calls).toEqual([
      [3, 0],
      [3, 60],
    ]);
  });

  it("retries a failed picture", async () => {
    const overlay = createOverlay();
    const cells = vi.fn(async () => ({ kind: "failed", problem: "no" }) as const);
    const layer = new SurveyCellsLayer(overlay, { cells });
    layer.add(fakeMap().map);
    overlay.show("cells");
    layer.update(scene(1, 1));
    await settled();
    layer.update(scene(2, 1));
    expect(cells).toHaveBeenCalledOnce();
    layer.update(scene(4, 1));
    expect(cells).toHaveBeenCalledTimes(2);
    expect(cells).toHaveBeenCalledWith(7, 1200);
  });
});

describe("a survey's paths", () => {
  it("are planned, being flown or flown; single points are omitted", () => {
    const line: [number, number][] = [
      [1, 2],
      [3, 4],
    ];
    const features = pathFeatures({
      survey_id: 7,
      rows: [line],
      flying: [{ serial: "A", number: 1, places: line }],
      flown: [
        { serial: "A", number: 1, places: line },
        { serial: "B", number: 2, places: [[1, 2]] },
      ],
    });
    expect(features.map(({ properties }) => properties?.kind)).toEqual([
      "survey-rows-planned",
      "survey-rows-flying",
      "survey-rows-flown",
    ]);
  });
});
