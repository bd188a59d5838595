import { afterEach, describe, expect, it } from "vitest";
import { squareAround } from "../../site/siteFeatures";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { chooseLengthUnit } from "../../text/units";
import { SitePanel } from "./SitePanel";

let page: RenderedPage;
afterEach(() => {
  page?.dispose();
  chooseLengthUnit("m");
});

const HERE = { lon: -93.6, lat: 41.9 };

async function open(locked_reason: string | null = null) {
  page = renderPage(SitePanel, station([vehicle(1)]));
  page.site.drawing = { ...page.site.drawing, locked_reason };
  page.shared.setMapCentre(() => ({ ...HERE, width_m: 500 }));
  press("Edit");
  await settled();
}

const button = (text: string) => findButton(page.root, text);

function press(text: string) {
  button(text).click();
}

function field(label: string): HTMLInputElement {
  const named = [...page.root.querySelectorAll("label")].find(({ textContent }) =>
    textContent?.startsWith(label),
  );
  return named?.querySelector("input, select") ?? find(page.root, `[aria-label='${label}']`);
}

/** What the file says of a shape but its name and place. */
const OTHER = { layer: null, properties: {} };

function type(label: string, text: string) {
  field(label).value = text;
  field(label).dispatchEvent(new Event("change", { bubbles: true }));
}

function corners(): string[] {
  return [...page.root.querySelectorAll<HTMLInputElement>(".site-corner input")].map(
    ({ value }) => value,
  );
}

describe("with the keyboard alone", () => {
  it("a shape is added at the map centre and its corners are typed", async () => {
    await open();
    press("At map centre");
    expect(page.shared.siteDraft.selected()?.rings).toEqual([squareAround(HERE, 200)]);
    type("Corner 1: latitude, longitude", "41.95, -93.65");
    expect(corners()[0]).toBe("41.9500000, -93.6500000");
    press("Add a corner after corner 1");
    expect(corners()).toHaveLength(5);
    press("Remove corner 1");
    expect(button("Remove corner 1").disabled).toBe(false);
    press("Remove corner 1");
    expect(corners()).toHaveLength(3);
    expect(button("Remove corner 1").disabled).toBe(true);
  });

  it("a text that is no place changes nothing and is marked", async () => {
    await open();
    press("At map centre");
    const before = page.shared.siteDraft.features();
    type("Corner 2: latitude, longitude", "here");
    expect(page.shared.siteDraft.features()).toBe(before);
    expect(page.root.querySelectorAll("[aria-invalid='true']")).toHaveLength(1);
  });

  it("a text that is no number ends with the selection, and with a new value", async () => {
    await open();
    const { siteDraft } = page.shared;
    siteDraft.addAt("keep_out", HERE, 100);
    siteDraft.addAt("keep_out", HERE, 100);
    const marked = () => page.root.querySelectorAll("[aria-invalid='true']").length;
    type("Floor, m", "low");
    type("Corner 1: latitude, longitude", "here");
    expect(marked()).toBe(2);
    siteDraft.select(siteDraft.features()[0]?.id ?? null);
    expect(marked()).toBe(0);
    expect(field("Floor, m").value).toBe("");
    type("Floor, m", "5");
    type("Corner 1: latitude, longitude", "41.95, -93.65");
    type("Floor, m", "low");
    type("Corner 1: latitude, longitude", "here");
    siteDraft.undo();
    expect([marked(), field("Floor, m").value]).toEqual([1, "low"]);
    siteDraft.undo();
    expect([marked(), field("Floor, m").value]).toEqual([0, ""]);
  });

  it("heights are shown and typed in feet where these are chosen, and sent in metres", async () => {
    await open();
    const { siteDraft } = page.shared;
    siteDraft.addAt("keep_out", HERE, 100);
    type("Floor, m", "5,5");
    type("Ceiling, m", "low");
    chooseLengthUnit("ft");
    expect([field("Floor, ft").value, field("Ceiling, ft").value]).toEqual(["18.04", "low"]);
    type("Ceiling, ft", "83.5");
    expect(field("Ceiling, ft").value).toBe("83.5");
    await siteDraft.save();
    const sent = page.site.asked.at(-1)?.[1].features[0]?.properties;
    expect(sent).toMatchObject({ floor_m: 5.5, ceiling_m: 25.451, datum: "ground" });
    siteDraft.addAt("landing_pads", HERE, 100);
    type("Altitude (WGS84), ft", "1000");
    expect(siteDraft.selected()?.properties["altitude_m"]).toBe(304.8);
    chooseLengthUnit("m");
    expect(field("Altitude (WGS84), m").value).toBe("304.8");
  });

  it("drawing on the map is begun and ended by the same button, not by a hole's", async () => {
    await open();
    const { siteDraft } = page.shared;
    const isPressed = () => button("Draw on map").getAttribute("aria-pressed");
    press("Draw on map");
    expect([siteDraft.tool()?.layer, isPressed()]).toEqual(["boundary", "true"]);
    press("Draw on map");
    expect([siteDraft.tool(), isPressed()]).toEqual([null, "false"]);
    press("At map centre");
    press("Draw a hole");
    expect([siteDraft.tool()?.hole, isPressed()]).toEqual([true, "false"]);
  });

  it("long outlines are listed a page at a time", async () => {
    await open();
    press("At map centre");
    const { siteDraft } = page.shared;
    const ring = Array.from({ length: 45 }, (_, k) => ({ lon: k / 1000, lat: (k * k) / 1e6 }));
    siteDraft.setRing(siteDraft.selected()?.id ?? 0, 0, ring);
    expect(corners()).toHaveLength(20);
    press("Later corners");
    press("Later corners");
    expect(corners()).toHaveLength(5);
    expect(button("Later corners").disabled).toBe(true);
    expect(page.root.textContent).not.toContain("More than 500 corners");
    const long = Array.from({ length: 501 }, (_, k) => ({ lon: k / 1000, lat: (k * k) / 1e6 }));
    siteDraft.setRing(siteDraft.selected()?.id ?? 0, 0, long);
    expect(page.root.textContent).toContain("More than 500 corners");
  });
});

describe("what the station answers", () => {
  it("stands beside the feature it is about", async () => {
    await open();
    press("At map centre");
    page.site.response = {
      ...page.site.response,
      accepted: false,
      reason: "Expected a polygon whose edges do not meet",
      feature: 0,
    };
    page.clock.advance(600);
    await settled();
    expect(find(page.root, ".site-row").textContent).toContain("edges do not meet");
    expect(find(page.root, ".site-verdict").textContent).toBe("Cannot be saved as it is:");
  });

  it("offers no drawing where it cannot be saved, with the reason", async () => {
    await open("The demonstration's site is part of the program");
    expect(page.root.textContent).toContain("part of the program");
    expect(() => button("At map centre")).toThrow();
    page.shared.siteDraft.addAt("boundary", HERE, 200);
    expect(button("Save, in force at once").disabled).toBe(true);
  });

  it("offers the last save's undo, once nothing else is changed", async () => {
    page = renderPage(SitePanel, station([vehicle(1)]));
    const undo = { what: "boundary", by: "anna (10.0.0.2)", utc: "2026-05-01T12:00:00+00:00" };
    page.site.drawing = { ...page.site.drawing, undo };
    press("Edit");
    await settled();
    page.site.response = { ...page.site.response, drawing: { ...page.site.drawing, undo: null } };
    press("Undo last save: boundary, by anna");
    await settled();
    expect(page.site.undone).toEqual(["r1"]);
    expect(page.root.textContent).not.toContain("Undo last save");
  });
});

describe("an imported file", () => {
  it("is chosen from feature by feature", async () => {
    await open();
    const polygon = {
      type: "Polygon" as const,
      coordinates: [
        [
          [0, 0],
          [1, 0],
          [1, 1],
          [0, 0],
        ],
      ],
    };
    page.site.imported = {
      features: [
        { ...OTHER, name: "west", geometry: polygon },
        { ...OTHER, name: "<b>east</b>", geometry: polygon },
      ],
      excluded: [],
      warnings: [],
      is_fit_for_fences: true,
      has_open_paths: false,
      reason: null,
    };
    const section = find(page.root, ".site-import");
    const drop = new Event("drop", { bubbles: true }) as Event & { dataTransfer: unknown };
    drop.dataTransfer = { files: [new File(["x"], "fields.kml")] };
    section.dispatchEvent(drop);
    await settled();
    expect(section.textContent).toContain("<b>east</b>");
    type("west", "boundary");
    type("<b>east</b>", "");
    press("Add 1 feature");
    expect(page.shared.siteDraft.features().map(({ layer }) => layer)).toEqual(["boundary"]);
  });
});

describe("a file that is not read whole", () => {
  const shape = (lon: number) => ({
    type: "Polygon" as const,
    coordinates: [
      [
        [lon, 0],
        [lon + 1, 0],
        [lon + 1, 1],
        [lon, 0],
      ],
    ],
  });
  const read = async (imported: Partial<(typeof page.site)["imported"]>) => {
    page.site.imported = { ...page.site.imported, ...imported };
    const section = find(page.root, ".site-import");
    const drop = new Event("drop", { bubbles: true }) as Event & { dataTransfer: unknown };
    drop.dataTransfer = { files: [new File(["x"], "farm.kml")] };
    section.dispatchEvent(drop);
    await settled();
    return section;
  };

  it("names what is left out, and takes paths as areas when asked", async () => {
    await open();
    const section = await read({
      features: [{ ...OTHER, name: "west", geometry: shape(0) }],
      excluded: ["lane: a path of 4 points, not an area: close paths to take it as one"],
      has_open_paths: true,
      warnings: ["pond: 12000 corners are simplified to 437, within 2 cm"],
    });
    expect(section.textContent).toContain("farm.kml: 1 read, 1 excluded");
    expect(section.textContent).toContain("lane: a path of 4 points");
    expect(section.textContent).toContain("within 2 cm");
    press("Take paths as areas");
    await settled();
    expect(page.site.closedPaths).toEqual(["farm.kml"]);
  });

  it("becomes no fence where nobody knows how far off it is", async () => {
    await open();
    const section = await read({
      features: [{ ...OTHER, name: "old", geometry: shape(0) }],
      is_fit_for_fences: false,
    });
    expect(section.textContent).toContain("Survey regions only");
    const layers = [...section.querySelectorAll("option")].map(({ value }) => value);
    expect(layers).toEqual(["survey_regions", ""]);
  });

  it("of a whole farm is searched by name", async () => {
    await open();
    const fields = Array.from({ length: 21 }, (_, k) => ({
      ...OTHER,
      name: `field ${k + 1}`,
      geometry: shape(k),
    }));
    const section = await read({ features: fields });
    const search = find<HTMLInputElement>(page.root, "input[type=search]");
    search.value = "FIELD 21";
    search.dispatchEvent(new InputEvent("input", { bubbles: true }));
    expect(section.querySelectorAll(".site-choice")).toHaveLength(1);
    type("field 21", "survey_regions");
    press("Add 1 feature");
    const [added] = page.shared.siteDraft.features();
    expect(added?.properties["name"]).toBe("field 21");
  });
});

it("leaves the map when its panel closes, and keeps the edits", async () => {
  await open();
  press("At map centre");
  const { siteDraft } = page.shared;
  page.dispose();
  expect([siteDraft.isOn(), siteDraft.features().length]).toEqual([false, 1]);
});
