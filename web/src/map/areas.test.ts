import { describe, expect, it } from "vitest";
import { survey } from "../testing/fakeField";
import { area, at, FIELD, station, vehicle } from "../testing/fakeState";
import { areaFeatures, areaText, labelPlaces, shownAreas } from "./areas";
import { hatchImage } from "./hatch";
import { padText } from "./padLayer";

const site = station([]).site;

describe("an area's label", () => {
  it.each([
    [area("boundary", [0, 0], 300), "Boundary"],
    [area("boundary", [0, 0], 300, { name: "boundary" }), "Boundary"],
    [area("keep_out", [0, 0], 20), "Keep out: Barn"],
    [
      area("keep_out", [0, 0], 20, { ceiling_m: 30, datum: "ground" }),
      "Keep out: Barn, up to 30\u00a0m above ground",
    ],
    [
      area("height", [0, 0], 20, { name: "", floor_m: 40, ceiling_m: 90, datum: "ground" }),
      "Height limit, 40\u00a0m to 90\u00a0m above ground",
    ],
    [
      area("height", [0, 0], 20, { floor_m: 0, datum: "wgs84" }),
      "Height limit: Barn, from 0\u00a0m WGS84",
    ],
    [area("survey", [0, 0], 20), "Survey: Barn"],
  ])("has the name and the heights with their datum", (one, text) => {
    expect(areaText(one)).toBe(text);
  });
});

describe("areas on the map", () => {
  it("are drawn by kind, with their holes", () => {
    const hole = area("keep_out", [0, 0], 10).rings[0] ?? [];
    const ring = area("keep_out", [0, 0], 50);
    const [feature] = areaFeatures([{ ...ring, rings: [...ring.rings, hole] }]);
    expect(feature?.geometry).toMatchObject({
      type: "Polygon",
      coordinates: [ring.rings[0], hole],
    });
  });

  it("are omitted without corners or without a site", () => {
    const empty = area("keep_out", [0, 0], 50, { rings: [] });
    expect(shownAreas({ site: site && { ...site, areas: [empty] }, surveys: [] })).toEqual([]);
    expect(shownAreas({ site: null, surveys: [] })).toEqual([]);
  });

  it("are without the site's survey regions while a drawn area is flown", () => {
    const areas = [area("boundary", [0, 0], 300), area("survey", [0, 0], 50)];
    const kinds = (region: string | null) =>
      shownAreas({ site: site && { ...site, areas }, surveys: [survey(7, { region })] }).map(
        ({ kind }) => kind,
      );
    expect(kinds("Barn")).toEqual(["boundary", "survey"]);
    expect(kinds(null)).toEqual(["boundary"]);
  });

  it("have their labels at the centre, a boundary at its northern edge", () => {
    const [middle, ...edges] = labelPlaces(area("keep_out", [0, 0], 50));
    expect(middle?.lon).toBeCloseTo(FIELD.lon, 9);
    expect(middle?.lat).toBeCloseTo(FIELD.lat, 9);
    expect(edges.map(({ side }) => side)).toEqual(["below", "above", "above", "below"]);
    const corners = labelPlaces(area("boundary", [0, 0], 300)).map(({ lat }) => lat);
    expect(corners[0]).toBeCloseTo(at(0, 300)[1], 9);
    expect(corners.at(-1)).toBeCloseTo(at(0, -300)[1], 9);
    const round = area("boundary", [0, 0], 300, {
      rings: [[...Array(500).keys()].map((n) => at(Math.sin(n) * 300, Math.cos(n) * 300))],
    });
    expect(labelPlaces(round)).toHaveLength(8);
  });
});

describe("stripes", () => {
  it("continue from one tile to the next", () => {
    const hatch = { isCrossed: false, tile_px: 8, stripe_px: 2, opacity: 0.5 };
    const { data, width, height } = hatchImage(hatch, "#102030");
    const isStriped = (x: number, y: number) => data[4 * (y * width + x) + 3] !== 0;
    expect([width, height]).toEqual([8, 8]);
    expect([...data.slice(0, 4)]).toEqual([0x10, 0x20, 0x30, 128]);
    for (let y = 0; y < 8; y += 1) {
      // One pixel down moves the stripe one pixel left, across the tile's edge too.
      for (let x = 0; x < 8; x += 1) {
        expect(isStriped(x, y)).toBe(isStriped((x + 1) % 8, (y + 7) % 8));
      }
    }
  });

  it("reject an unreadable colour", () => {
    const hatch = { isCrossed: true, tile_px: 8, stripe_px: 2, opacity: 0.5 };
    expect(() => hatchImage(hatch, "red")).toThrow("#rrggbb");
  });
});

describe("a pad", () => {
  it("shows the vehicle it is reserved for, by name once that has connected", () => {
    const pad = { name: "P1", serial: "SN-001", longitude_deg: 0, latitude_deg: 0, altitude_m: 0 };
    expect(padText(pad, station([vehicle(1)]))).toBe("P1: reserved for Alder");
    expect(padText(pad, station([]))).toBe("P1: reserved for SN-001");
    expect(padText({ ...pad, serial: null }, station([]))).toBe("P1: any vehicle");
  });
});
