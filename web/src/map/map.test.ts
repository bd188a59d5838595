import { describe, expect, it } from "vitest";
import { area, at, FIELD, station, vehicle } from "../testing/fakeState";
import { boxAround, circle, gridLines, metresPerDegree, roundStepM } from "./localGrid";
import { gridOrigin, wholeView } from "./scene";

const UNPLACED = { position: { latitude_deg: null, longitude_deg: null, age_s: null } };

describe("metres and degrees", () => {
  it("agree with the WGS84 tables", () => {
    // One degree at 45° north: 111,131.7 m of latitude and 78,846.8 m of longitude.
    expect(metresPerDegree(45).lat).toBeCloseTo(111_131.7, 0);
    expect(metresPerDegree(45).lon).toBeCloseTo(78_846.8, 0);
    expect(metresPerDegree(0).lon).toBeCloseTo(111_319.5, 0);
  });

  it("make a circle of the right size", () => {
    const centre = { lon: FIELD.lon, lat: FIELD.lat };
    const per = metresPerDegree(FIELD.lat);
    const ring = circle(centre, 25);
    for (const [lon, lat] of ring) {
      const east_m = (lon - centre.lon) * per.lon;
      expect(Math.hypot(east_m, (lat - centre.lat) * per.lat)).toBeCloseTo(25, 6);
    }
    expect(ring.at(-1)).toEqual(ring[0]);
  });
});

describe("the grid", () => {
  it.each([
    [0.3, 0.5],
    [1, 1],
    [1.1, 2],
    [21, 50],
    [500, 500],
    [501, 1000],
  ])("has steps of at least %d m: %d m", (least, step) => {
    expect(roundStepM(least)).toBeCloseTo(step, 9);
  });

  it("has lines at whole steps from the origin, inside the view", () => {
    const [west, south] = at(-130, -70);
    const [east, north] = at(260, 90);
    const origin = { lon: FIELD.lon, lat: FIELD.lat };
    const grid = gridLines({ west, south, east, north }, origin, 100);
    expect(grid.eastings.map(({ m }) => m)).toEqual([-100, 0, 100, 200]);
    expect(grid.northings.map(({ m }) => m)).toEqual([0]);
    expect(grid.eastings[1]?.deg).toBe(FIELD.lon);
  });

  it("has a bounded number of lines", () => {
    const world = { west: -180, south: -80, east: 180, north: 80 };
    const grid = gridLines(world, { lon: 0, lat: 0 }, 1);
    expect(grid.eastings.length).toBeLessThanOrEqual(200);
  });

  it("starts at the site's origin, else at the first vehicle with a position", () => {
    expect(gridOrigin(station([vehicle(1)]))).toEqual({ lon: FIELD.lon, lat: FIELD.lat });
    const positioned = vehicle(2);
    const withoutSite = station([vehicle(1, UNPLACED), positioned], { site: null });
    expect(gridOrigin(withoutSite)).toEqual({
      lon: positioned.position.longitude_deg,
      lat: positioned.position.latitude_deg,
    });
    expect(gridOrigin(station([], { site: null }))).toBeNull();
  });
});

describe("the first view", () => {
  it("contains every vehicle and the ground image", () => {
    const state = station([vehicle(1), vehicle(4), vehicle(2, UNPLACED)]);
    const box = wholeView(state);
    for (const { position } of [vehicle(1), vehicle(4)]) {
      expect(box?.west).toBeLessThanOrEqual(position.longitude_deg ?? Number.NaN);
      expect(box?.east).toBeGreaterThanOrEqual(position.longitude_deg ?? Number.NaN);
      expect(box?.south).toBeLessThanOrEqual(position.latitude_deg ?? Number.NaN);
      expect(box?.north).toBeGreaterThanOrEqual(position.latitude_deg ?? Number.NaN);
    }
  });

  it("contains boundary and survey regions beside vehicles, not zones far away", () => {
    const areas = [
      area("boundary", [0, 0], 190),
      area("survey", [300, 0], 75),
      area("keep_out", [5000, 0], 20),
    ];
    const state = station([vehicle(1)]);
    const box = wholeView({ ...state, site: state.site && { ...state.site, areas } });
    const per = metresPerDegree(FIELD.lat);
    const east_m = ((box?.east ?? 0) - FIELD.lon) * per.lon;
    const west_m = ((box?.west ?? 0) - FIELD.lon) * per.lon;
    expect(west_m).toBeCloseTo(-190, 0);
    expect(east_m).toBeCloseTo(375, 0);
  });

  it("leaves a single vehicle its surroundings", () => {
    const box = boxAround([{ lon: FIELD.lon, lat: FIELD.lat }], 120);
    const per = metresPerDegree(FIELD.lat);
    expect(((box?.east ?? 0) - (box?.west ?? 0)) * per.lon).toBeCloseTo(120);
  });

  it("shows the site without any position, and waits without a site", () => {
    expect(wholeView(station([]))).not.toBeNull();
    expect(wholeView(station([vehicle(1, UNPLACED)], { site: null }))).toBeNull();
  });
});
