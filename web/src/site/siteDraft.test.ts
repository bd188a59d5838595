import { createRoot } from "solid-js";
import { afterEach, describe, expect, it } from "vitest";
import type { DrawnFeatureView, SiteDrawingResponse } from "../protocol";
import { station, vehicle } from "../testing/fakeState";
import { type RenderedPage, renderPage, settled } from "../testing/renderPage";
import { areaHa, cornerOf, cornerText, featureOf, squareAround, viewOf } from "./siteFeatures";

let page: RenderedPage;
afterEach(() => page?.dispose());

const HERE = { lon: -93.6, lat: 41.9 };
const SQUARE = squareAround(HERE, 100);
/** With heights in its positions, as some programs write them. */
const FIELD: DrawnFeatureView = {
  layer: "boundary",
  geometry: {
    type: "Polygon",
    coordinates: [
      [
        [-93.61, 41.9, 12],
        [-93.6, 41.9, 12],
        [-93.6, 41.91, 12],
        [-93.61, 41.9, 12],
      ],
    ],
  },
  properties: { name: "field" },
};
const ACCEPTED: SiteDrawingResponse = {
  accepted: true,
  rule: null,
  reason: null,
  feature: null,
  layers: ["survey_regions"],
  also: [],
  drawing: null,
};
const CHECK_MS = 600;

async function open(...features: DrawnFeatureView[]) {
  page = createRoot(() => renderPage(() => null, station([vehicle(1)])));
  page.site.drawing = { ...page.site.drawing, features };
  page.shared.siteDraft.toggle();
  await settled();
  return page.shared.siteDraft;
}

describe("editing", () => {
  it("adds, changes and removes, each step undone and redone", async () => {
    const draft = await open();
    draft.draw({ layer: "survey_regions", hole: false });
    draft.finish(SQUARE);
    expect(draft.selected()?.properties["name"]).toBe("survey region 1");
    draft.draw({ layer: "survey_regions", hole: true });
    draft.finish(squareAround(HERE, 10));
    const id = draft.selected()?.id ?? 0;
    draft.setProperty(id, "name", "north");
    expect(draft.features()[0]).toMatchObject({ properties: { name: "north" } });
    expect(draft.features()[0]?.rings).toHaveLength(2);
    draft.undo();
    draft.undo();
    expect(draft.features()[0]?.rings).toHaveLength(1);
    draft.undo();
    expect([draft.features(), draft.isChanged(), draft.canUndo()]).toEqual([[], false, false]);
    for (let step = 0; step < 3; step += 1) draft.redo();
    draft.draw({ layer: "keep_out", hole: false });
    draft.undo();
    expect(draft.canUndo()).toBe(false);
    draft.draw(null);
    expect(draft.features()[0]).toMatchObject({ properties: { name: "north" } });
    draft.removeRing(id, 1);
    expect(draft.features()[0]?.rings).toHaveLength(1);
    draft.removeRing(id, 0);
    expect(draft.features()).toEqual([]);
    expect(draft.canRedo()).toBe(false);
  });

  it("sends untouched features as they came, to the last digit", async () => {
    const draft = await open(FIELD);
    draft.addAt("survey_regions", HERE, 50);
    await draft.save();
    const [what, sent] = page.site.asked.at(-1) ?? [];
    expect(what).toBe("save");
    expect(sent?.revision).toBe("r1");
    expect(sent?.features[0]).toEqual(FIELD);
    expect(sent?.features[1]?.geometry.coordinates).toHaveLength(1);
  });

  it("keeps heights and their datum together", async () => {
    const draft = await open();
    draft.addAt("keep_out", HERE, 50);
    const id = draft.selected()?.id ?? 0;
    draft.setProperty(id, "ceiling_m", 30);
    expect(draft.selected()?.properties).toMatchObject({ ceiling_m: 30, datum: "ground" });
    draft.setProperty(id, "ceiling_m", null);
    expect(Object.keys(draft.selected()?.properties ?? {})).toEqual(["name"]);
  });

  it("puts a pad on the site's ground", async () => {
    const draft = await open();
    draft.addAt("landing_pads", HERE, 50);
    const altitude_m = page.shared.fleet.site?.ground_altitude_m;
    expect(altitude_m).toBeTypeOf("number");
    expect(draft.selected()).toMatchObject({ rings: [[HERE]], properties: { altitude_m } });
  });

  it("ends step by step with Esc, and keeps what is not saved while closed", async () => {
    const draft = await open(FIELD);
    draft.draw({ layer: "keep_out", hole: false });
    expect(draft.clear()).toBe(true);
    expect(draft.clear()).toBe(false);
    draft.addAt("keep_out", HERE, 50);
    draft.toggle();
    draft.toggle();
    await settled();
    expect(draft.features()).toHaveLength(2);
  });

  it("and other presses on the map exclude each other", async () => {
    const draft = await open();
    page.shared.zoneDraft.toggle();
    expect([draft.isOn(), page.shared.zoneDraft.isOn()]).toEqual([false, true]);
    draft.toggle();
    expect([draft.isOn(), page.shared.zoneDraft.isOn()]).toEqual([true, false]);
    page.shared.aim(HERE);
    expect(page.shared.zoneDraft.points()).toEqual([]);
  });
});

describe("the station's check", () => {
  it("follows a pause, once for several edits, and names the feature", async () => {
    const draft = await open(FIELD);
    page.site.response = { ...ACCEPTED, accepted: false, reason: "Edges meet", feature: 1 };
    draft.addAt("keep_out", HERE, 50);
    draft.addAt("keep_out", HERE, 50);
    expect(draft.verdict().kind).toBe("checking");
    page.clock.advance(CHECK_MS);
    await settled();
    expect(page.site.asked.map(([what]) => what)).toEqual(["check"]);
    const featureId = draft.features()[1]?.id;
    expect(draft.verdict()).toEqual({ kind: "refused", text: "Edges meet", featureId });
  });

  it("is asked again when a vehicle has landed, and not at all without changes", async () => {
    const draft = await open(FIELD);
    page.clock.advance(CHECK_MS);
    expect(page.site.asked).toEqual([]);
    draft.removeRing(draft.features()[0]?.id ?? 0, 0);
    page.clock.advance(CHECK_MS);
    await settled();
    const landed = { value: false, age_s: 0.1 };
    page.receive(station([vehicle(1, { is_flying: landed })]));
    page.clock.advance(CHECK_MS);
    expect(page.site.asked).toHaveLength(2);
  });
});

describe("saving", () => {
  it("takes the saved site as the new beginning", async () => {
    const draft = await open();
    draft.addAt("boundary", HERE, 50);
    const drawing = { ...page.site.drawing, revision: "r2", features: [FIELD] };
    page.site.response = { ...ACCEPTED, layers: ["boundary"], drawing };
    await draft.save();
    expect([draft.isChanged(), draft.canUndo()]).toEqual([false, false]);
    expect(draft.notice()).toEqual({
      about: "site",
      text: "Saved: boundary. In force now",
      isProblem: false,
    });
    await draft.undoSaved();
    expect(page.site.undone).toEqual(["r2"]);
  });

  it("keeps what was drawn meanwhile, as changes of what was saved", async () => {
    const draft = await open();
    draft.addAt("boundary", HERE, 50);
    const drawing = { ...page.site.drawing, revision: "r2", features: [FIELD] };
    page.site.response = { ...ACCEPTED, layers: ["boundary"], drawing };
    const saving = draft.save();
    draft.addAt("keep_out", HERE, 20);
    await saving;
    expect(draft.features().map(({ layer }) => layer)).toEqual(["boundary", "keep_out"]);
    expect([draft.isChanged(), draft.canUndo()]).toEqual([true, true]);
    expect(draft.selected()?.layer).toBe("keep_out");
    expect(draft.notice()?.text).toBe("Saved: boundary. In force now");
    page.clock.advance(CHECK_MS);
    expect(page.site.asked.at(-1)?.[1].revision).toBe("r2");
  });

  it("names the layers that change, or that nothing does", async () => {
    const draft = await open();
    draft.addAt("boundary", HERE, 50);
    const { drawing } = page.site;
    page.site.response = { ...ACCEPTED, layers: ["boundary", "keep_out", "landing_pads"], drawing };
    await draft.save();
    expect(draft.notice()?.text).toBe(
      "Saved: boundary, keep-out zones and landing pads. In force now",
    );
    page.site.response = { ...ACCEPTED, layers: [], drawing };
    await draft.save();
    expect(draft.notice()?.text).toBe("Saved: nothing changes");
  });

  it("leaves a ring that is being drawn", async () => {
    const draft = await open();
    draft.addAt("boundary", HERE, 50);
    page.site.response = { ...ACCEPTED, drawing: { ...page.site.drawing, revision: "r2" } };
    const saving = draft.save();
    draft.draw({ layer: "keep_out", hole: false });
    await saving;
    draft.finish(SQUARE);
    expect(draft.features().map(({ layer }) => layer)).toEqual(["boundary", "keep_out"]);
  });

  it("states what an undo of the last save leaves in a draft edited meanwhile", async () => {
    const draft = await open(FIELD);
    page.site.response = { ...ACCEPTED, layers: ["boundary"], drawing: page.site.drawing };
    const undoing = draft.undoSaved();
    draft.addAt("keep_out", HERE, 20);
    await undoing;
    expect(draft.features()).toHaveLength(2);
    expect(draft.notice()?.text).toBe(
      "Undone: boundary. In force now. This draft was edited meanwhile and still has what was undone",
    );
  });

  it("keeps the draft when it is refused, with the reason", async () => {
    const draft = await open();
    draft.addAt("boundary", HERE, 50);
    page.site.response = { ...ACCEPTED, accepted: false, reason: "In the air: Drone 1" };
    await draft.save();
    expect(draft.features()).toHaveLength(1);
    expect(draft.notice()).toEqual({
      about: "site",
      text: "Not saved: In the air: Drone 1",
      isProblem: true,
    });
  });
});

describe("loading again", () => {
  it("keeps what was drawn meanwhile, at the revision it was drawn on", async () => {
    const draft = await open(FIELD);
    page.site.drawing = { ...page.site.drawing, revision: "r2", features: [] };
    const loading = draft.discard();
    draft.addAt("keep_out", HERE, 20);
    await loading;
    expect([draft.features().length, draft.saved()?.revision]).toEqual([2, "r1"]);
    expect(draft.notice()).toMatchObject({
      text: "Not loaded again: the draft was edited meanwhile",
      isProblem: true,
    });
  });

  it("forgets the edits and the ring that is being drawn", async () => {
    const draft = await open(FIELD);
    draft.addAt("keep_out", HERE, 20);
    draft.draw({ layer: "keep_out", hole: false });
    await draft.discard();
    expect([draft.features().length, draft.tool(), draft.isChanged()]).toEqual([1, null, false]);
  });
});

describe("an imported file", () => {
  const polygon = FIELD.geometry;
  const point = { type: "Point" as const, coordinates: [-93.6, 41.9] };
  const ONE = { name: "", geometry: polygon, layer: null, properties: {} };
  const READ = {
    features: [],
    excluded: [],
    warnings: [],
    is_fit_for_fences: true,
    has_open_paths: false,
    reason: null,
  };

  it("is a choice first, then part of the draft", async () => {
    const draft = await open();
    page.site.imported = {
      features: [{ ...ONE, name: "west" }, ONE, ONE, { ...ONE, name: "home", geometry: point }],
      excluded: ["photo: a picture laid on the map", "no shape"],
      warnings: ["NAD27: accurate to 5 m"],
      is_fit_for_fences: true,
      has_open_paths: false,
      reason: null,
    };
    await draft.readFile(new File(["x"], "fields.kml"));
    expect(draft.notice()?.text).toBe("fields.kml: 4 read, 2 excluded");
    expect(draft.imported().map(({ layer }) => layer)).toEqual([
      "survey_regions",
      "survey_regions",
      "survey_regions",
      "landing_pads",
    ]);
    expect(draft.features()).toEqual([]);
    draft.choose(3, null);
    draft.addImported();
    const names = draft.features().map(({ properties }) => properties["name"]);
    expect(names).toEqual(["west", "survey region 1", "survey region 2"]);
    expect(draft.imported()).toEqual([]);
    draft.undo();
    expect(draft.features()).toEqual([]);
  });

  it("with many features takes those that are pressed", async () => {
    const draft = await open();
    page.site.imported = { ...READ, features: Array(21).fill(ONE) };
    await draft.readFile(new File(["x"], "county.gpkg"));
    expect(draft.imported().every(({ layer }) => layer === null)).toBe(true);
    draft.takeOrLeave(20);
    draft.takeOrLeave(3);
    draft.takeOrLeave(3);
    draft.addImported();
    expect(draft.features().map(({ layer }) => layer)).toEqual(["survey_regions"]);
  });

  it("with zones of an authority keeps their heights", async () => {
    const draft = await open();
    const properties = { ceiling_m: 120, datum: "ground", notes: "PROHIBITED; CAA" };
    const zone = { ...ONE, name: "R1", layer: "keep_out" as const, properties };
    page.site.imported = { ...READ, features: [zone] };
    await draft.readFile(new File(["x"], "zones.json"));
    draft.addImported();
    const [added] = draft.features();
    expect(added?.layer).toBe("keep_out");
    expect(added?.properties).toEqual({ name: "R1", ...properties });
  });

  it("that is refused leaves everything as it is", async () => {
    const draft = await open(FIELD);
    page.site.imported = { ...READ, reason: "a.zip: expected KML" };
    await draft.readFile(new File(["x"], "a.zip"));
    expect(draft.notice()).toEqual({
      about: "import",
      text: "a.zip: expected KML",
      isProblem: true,
    });
    expect(draft.features()).toHaveLength(1);
  });
});

describe("a feature", () => {
  it("has an area without its holes", () => {
    const rings = [SQUARE, squareAround(HERE, 50)];
    expect(areaHa({ rings })).toBeCloseTo(0.75, 3);
  });

  it("goes to the station closed, longitude first", () => {
    const moved = { ...featureOf(1, FIELD), unedited: null };
    const { coordinates } = viewOf(moved).geometry;
    expect(coordinates).toEqual([
      [
        [-93.61, 41.9],
        [-93.6, 41.9],
        [-93.6, 41.91],
        [-93.61, 41.9],
      ],
    ]);
  });

  it.each([
    ["41.9, -93.6", HERE],
    [" 41.9 -93.6 ", HERE],
    ["41.9;-93.6", HERE],
    ["-93.6, 41.9", null],
    ["41.9", null],
    ["41.9, x", null],
    ["", null],
  ])("reads the corner %j", (text, expected) => expect(cornerOf(text)).toEqual(expected));

  it("shows a corner as it reads it", () => {
    expect(cornerOf(cornerText(HERE))).toEqual(HERE);
  });
});

describe("beside the table of vehicles", () => {
  it("keeps its edits, on the new revision, when vehicles are saved", async () => {
    const draft = await open(FIELD);
    draft.draw({ layer: "survey_regions", hole: false });
    draft.finish(SQUARE);
    page.site.drawing = { ...page.site.drawing, revision: "r2", features: [{ ...FIELD }] };
    await draft.refresh();
    expect(draft.features()).toHaveLength(2);
    expect(draft.saved()?.revision).toBe("r2");
    page.site.drawing = { ...page.site.drawing, revision: "r3", features: [] };
    await draft.refresh();
    expect([draft.saved()?.revision, draft.features().length]).toEqual(["r2", 2]);
  });
});
