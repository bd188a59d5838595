import { describe, expect, it } from "vitest";
import { area, at, FIELD, station, vehicle } from "../testing/fakeState";
import { areaFeatures, areasOf, areaText, labelPoint } from "./areas";
import { hatchImage } from "./hatch";
import { padText } from "./padLayer";

const site = station([]).site;

describe("what an area is called", () => {
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
      "Heights, 40\u00a0m to 90\u00a0m above ground",
    ],
    [
      area("height", [0, 0], 20, { floor_m: 0, datum: "wgs84" }),
      "Heights: Barn, from 0\u00a0m WGS84",
    ],
    [area("survey", [0, 0], 20), "Survey: Barn"],
  ])("names it and says from where its heights count", (one, text) => {
    expect(areaText(one)).toBe(text);
  });
});

describe("areas on the map", () => {
  it("are drawn by kind, with their holes", () => {
    const hole = area("keep_out", [0, 0], 10).rings[0] ?? [];
    const ring = area("keep_out", [0, 0], 50);
    const areas = [{ ...ring, rings: [...ring.rings, hole] }, area("boundary", [0, 0], 300)];
    const [feature, ...others] = areaFeatures(site && { ...site, areas }, "keep_out");
    expect(others).toEqual([]);
    expect(feature?.geometry).toMatchObject({
      type: "Polygon",
      coordinates: [ring.rings[0], hole],
    });
  });

  it("are left out when they have no corners, or there is no site", () => {
    const empty = area("keep_out", [0, 0], 50, { rings: [] });
    expect(areasOf(site && { ...site, areas: [empty] }, "keep_out")).toEqual([]);
    expect(areasOf(null, "keep_out")).toEqual([]);
  });

  it("have their names in the middle, a boundary at its northern edge", () => {
    const middle = labelPoint(area("keep_out", [0, 0], 50));
    expect(middle.lon).toBeCloseTo(FIELD.lon, 9);
    expect(middle.lat).toBeCloseTo(FIELD.lat, 9);
    expect(labelPoint(area("boundary", [0, 0], 300)).lat).toBeCloseTo(at(0, 300)[1], 9);
  });
});

describe("stripes", () => {
  it("go on from one tile to the next", () => {
    const hatch = { isCrossed: false, tile_px: 8, stripe_px: 2, opacity: 0.5 };
    const { data, width, height } = hatchImage(hatch, "#102030");
    const isStriped = (x: number, y: number) => data[4 * (y * width + x) + 3] !== 0;
    expect([width, height]).toEqual([8, 8]);
    expect([...data.slice(0, 4)]).toEqual([0x10, 0x20, 0x30, 128]);
    for (let y = 0; y < 8; y += 1) {
      // One step down moves the stripe one step to the left, over the tile's edge too.
      for (let x = 0; x < 8; x += 1) {
        expect(isStriped(x, y)).toBe(isStriped((x + 1) % 8, (y + 7) % 8));
      }
    }
  });

  it("refuse a colour that they cannot read", () => {
    const hatch = { isCrossed: true, tile_px: 8, stripe_px: 2, opacity: 0.5 };
    expect(() => hatchImage(hatch, "red")).toThrow("#rrggbb");
  });
});

describe("a pad", () => {
  it("says whose it is, by name once the vehicle was heard", () => {
    const pad = { name: "P1", serial: "SN-001", longitude_deg: 0, latitude_deg: 0, altitude_m: 0 };
    expect(padText(pad, station([vehicle(1)]))).toBe("P1: for Alder");
    expect(padText(pad, station([]))).toBe("P1: for SN-001");
    expect(padText({ ...pad, serial: null }, station([]))).toBe("P1: for any vehicle");
  });
});
