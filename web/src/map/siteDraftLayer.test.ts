import { describe, expect, it } from "vitest";
import { squareAround } from "../site/siteFeatures";
import { draftFeatures } from "./siteDraftLayer";

const HERE = { lon: -93.6, lat: 41.9 };
const FIELD = [squareAround(HERE, 100), squareAround(HERE, 10)];

describe("the site being edited, on the map", () => {
  it("has areas with holes, pads as points, and what was read from a file", () => {
    const field = {
      layer: "survey_regions",
      rings: FIELD,
      properties: {},
      unedited: null,
    } as const;
    const pad = { ...field, layer: "landing_pads", rings: [[HERE]] } as const;
    const ofFile = { layer: null, properties: {} };
    const read = { name: "", rings: FIELD, isPoint: false, ofFile };
    const shown = draftFeatures({
      features: [
        { ...field, id: 1 },
        { ...pad, id: 2 },
      ],
      imported: [
        { ...read, layer: "keep_out" },
        { ...read, layer: null },
      ],
      selectedId: 2,
    });
    expect(shown.map(({ geometry }) => geometry.type)).toEqual([
      "Polygon",
      "Point",
      "Polygon",
      "Polygon",
    ]);
    expect(shown[0]?.geometry).toMatchObject({ coordinates: { length: 2, 0: { length: 5 } } });
    expect(shown.map(({ properties }) => properties?.["layer"])).toEqual([
      "survey_regions",
      "landing_pads",
      "keep_out",
      "excluded",
    ]);
    expect(shown.map(({ properties }) => properties?.["importIndex"])).toEqual([null, null, 0, 1]);
    expect(shown.map(({ properties }) => properties?.["isSelected"])).toEqual([
      false,
      true,
      true,
      false,
    ]);
  });
});
