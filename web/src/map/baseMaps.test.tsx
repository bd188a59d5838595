import { createRoot } from "solid-js";
import { afterEach, expect, test } from "vitest";
import type { BaseMapView } from "../protocol";
import { baseMap } from "../testing/fakeField";
import { createFakeStation, fakeSource } from "../testing/fakeStation";
import { answered, failed } from "../testing/pageRequests";
import { find, type RenderedPage, renderPage, settled } from "../testing/renderPage";
import { createBaseMaps, type Kept } from "./baseMaps";
import { LayersButton } from "./LayersButton";

const OLD = baseMap({ name: "old.tif", title: "orthophoto 2023" });
const NEW = baseMap({ name: "new.mbtiles", title: "orthophoto 2025" });
const BROKEN = baseMap({ name: "a.mbtiles", title: "a", problem: "expected tiles, got none" });

function storage(stored: string | null = null): Kept & { stored: string | null } {
  const kept = {
    stored,
    getItem: () => kept.stored,
    setItem: (_key: string, value: string) => {
      kept.stored = value;
    },
  };
  return kept;
}

const disposals: (() => void)[] = [];
afterEach(() => {
  for (const dispose of disposals.splice(0)) dispose();
});

async function baseMapsOf(maps: BaseMapView[], kept: Kept) {
  const station = createFakeStation(null);
  station.maps = answered({ maps, note: maps.length > 0 ? null : "No map" });
  const made = createRoot((dispose) => {
    disposals.push(dispose);
    return createBaseMaps(fakeSource(station), kept);
  });
  await made.refresh();
  return { made, station };
}

test("until one is chosen, the one that shows most of the site is, of several the finest", async () => {
  const half = { zoom: 21, share: 0.5, metres_per_pixel: 0.05 };
  const coarse = { zoom: 17, share: 1, metres_per_pixel: 0.9 };
  const unknown = baseMap({ name: "unknown.tif", covers: null });
  const others = [BROKEN, unknown, { ...OLD, covers: half }];
  const plain = baseMap({ name: "plain.tif", covers: coarse });
  expect((await baseMapsOf([...others, plain], storage())).made.shown()?.name).toBe("plain.tif");
  const all = [...others, plain, NEW];
  expect((await baseMapsOf(all, storage())).made.shown()?.name).toBe("new.mbtiles");
  expect((await baseMapsOf([BROKEN, unknown], storage())).made.shown()?.name).toBe("unknown.tif");
});

test("the choice is kept by the browser, also the choice of none", async () => {
  const kept = storage();
  const { made } = await baseMapsOf([OLD, NEW], kept);
  made.choose("new.mbtiles");
  expect(made.shown()?.title).toBe("orthophoto 2025");
  expect((await baseMapsOf([OLD, NEW], storage(kept.stored))).made.shown()?.name).toBe(
    "new.mbtiles",
  );
  made.choose(null);
  expect(made.shown()).toBeNull();
  expect((await baseMapsOf([OLD, NEW], storage(kept.stored))).made.shown()).toBeNull();
});

test("a chosen map that is gone or broken is replaced by none, not by another one", async () => {
  expect((await baseMapsOf([NEW], storage("old.tif"))).made.shown()).toBeNull();
  expect((await baseMapsOf([BROKEN, NEW], storage("a.mbtiles"))).made.shown()).toBeNull();
});

test("a failed request keeps the maps that were known, and states why", async () => {
  const { made, station } = await baseMapsOf([NEW], storage());
  station.maps = failed("Station unreachable.");
  await made.refresh();
  expect(made.note()).toBe("Station unreachable.");
  expect(made.shown()?.name).toBe("new.mbtiles");
  station.maps = answered({ maps: [], note: "No map" });
  await made.refresh();
  expect([made.note(), made.shown()]).toEqual(["No map", null]);
});

test("a new version of the same file is shown anew", async () => {
  const { made, station } = await baseMapsOf([NEW], storage());
  const before = made.shown();
  await made.refresh();
  expect(made.shown()).toBe(before);
  station.maps = answered({ maps: [{ ...NEW, version: "2" }], note: null });
  await made.refresh();
  expect(made.shown()?.version).toBe("2");
});

let page: RenderedPage;
afterEach(() => page?.dispose());

async function openList(maps: BaseMapView[], note: string | null = null): Promise<HTMLElement> {
  page = renderPage(() => <LayersButton />, null);
  page.showMaps({ maps, note });
  find<HTMLButtonElement>(page.root, "button").click();
  await settled();
  return find<HTMLElement>(page.root, ".base-maps");
}

function radioOf(list: HTMLElement, text: string): HTMLInputElement {
  const label = [...list.querySelectorAll("label")].find((one) => one.textContent?.includes(text));
  if (label === undefined) throw new Error(`No choice "${text}".`);
  return find<HTMLInputElement>(label, "input");
}

test("the list states what each map covers, and why one cannot be chosen", async () => {
  const half = { zoom: 18, share: 0.547, metres_per_pixel: 0.444 };
  const list = await openList([BROKEN, NEW, { ...OLD, covers: half }]);
  expect(list.textContent).toContain(
    "orthophoto 2025covers 100 % of the site to zoom 19 (0.22\u00a0m a pixel)",
  );
  expect(list.textContent).toContain("covers 54 % of the site to zoom 18 (0.44\u00a0m a pixel)");
  expect(radioOf(list, "expected tiles, got none").disabled).toBe(true);
  expect(radioOf(list, "2025").checked).toBe(true);
  radioOf(list, "2023").click();
  expect(page.shared.baseMaps.shown()?.name).toBe("old.tif");
  radioOf(list, "None").click();
  expect(page.shared.baseMaps.shown()).toBeNull();
});

test("without maps the list states what to do", async () => {
  const list = await openList([], "No map in the site's folder maps: put files there");
  expect(list.textContent).toContain("put files there");
  expect(list.querySelectorAll("input").length).toBe(0);
});
