import { describe, expect, it } from "vitest";
import type { VehicleView } from "../protocol";
import { at, FIELD, hazard, station, vehicle } from "../testing/fakeState";
import type { Colours } from "./colours";
import { placeOnScreen, thinned } from "./movingLayer";
import { looksOf, movingShapes } from "./movingShapes";
import type { Scene } from "./scene";

const PLAIN: Colours = {
  ground: "white",
  grid: "grey",
  gridAxis: "grey",
  casing: "white",
  text: "black",
  stale: "grey",
  critical: "red",
  boundary: "#000001",
  keepOut: "#000002",
  heightZone: "#000003",
  temporaryZone: "#b3370b",
  baseMapOpacity: 1,
  baseMapSaturation: 0,
  survey: "#000004",
  vehicle: (number) => `colour ${number}`,
};

function scene(east_m: number, changes: Partial<VehicleView> = {}, behindS = 0): Scene {
  const [longitude_deg, latitude_deg] = at(east_m, 0);
  const position = { longitude_deg, latitude_deg, age_s: 0.1 };
  return {
    state: station([vehicle(1, { position, track: [at(-50, 0)], ...changes })]),
    behindS,
    selected: [],
    plannedTarget: null,
    missionDraft: null,
    zoneDraft: null,
    siteDraft: null,
  };
}

describe("tracks", () => {
  it("end at the vehicle's position, over their casing", () => {
    const [casing, track] = movingShapes(scene(10), PLAIN);
    expect(casing?.colour).toBe("white");
    expect(track).toMatchObject({ points: [at(-50, 0), at(10, 0)], colour: "colour 1" });
  });

  it("are dashed if simulated, and grey without telemetry", () => {
    const shapes = movingShapes(scene(0, { is_simulated: true }, 4), PLAIN);
    const track = shapes.find(({ dash_px }) => dash_px.join() === "5,4");
    expect(track?.colour).toBe("grey");
  });

  it("lose no end when points too near to be seen are excluded", () => {
    const points = [...Array(100).keys()].map((n): [number, number] => [n * 0.1, 0]);
    expect(thinned(points)).toEqual([
      [0, 0],
      ...[2, 4, 6, 8].map((x) => [expect.closeTo(x), 0]),
      [expect.closeTo(9.9), 0],
    ]);
  });
});

describe("a lost vehicle", () => {
  it("has a circle and a corridor, each an area with an edge", () => {
    const corridor = [at(30, 30), at(-120, -100)];
    const lost = scene(0, { staleness: "lost", hazard: hazard([30, 30], { corridor }) });
    const shapes = movingShapes(lost, PLAIN);
    expect(shapes.filter(({ width_px }) => width_px === null)).toHaveLength(2);
    expect(shapes.find(({ points }) => points.length === 2)?.points).toEqual(corridor);
  });

  it("grows while no state arrives", () => {
    const width = (behindS: number) => {
      const [area] = movingShapes(scene(0, {}, behindS), PLAIN);
      const lons = area?.points.map(([lon]) => lon) ?? [];
      return Math.max(...lons) - Math.min(...lons);
    };
    expect(width(6)).toBeGreaterThan(width(4));
  });
});

describe("looks", () => {
  it("change with what is drawn, not with a vehicle's motion", () => {
    expect(looksOf(scene(10))).toBe(looksOf(scene(0)));
    expect(looksOf(scene(0, {}, 4))).not.toBe(looksOf(scene(0)));
    expect(looksOf(scene(0, { track: [] }))).not.toBe(looksOf(scene(0)));
  });
});

describe("places on the screen", () => {
  const map = (lng: number, lat: number, zoom: number) => ({
    getCenter: () => ({ lng, lat }),
    getZoom: () => zoom,
    project: () => ({ x: 400, y: 300 }),
  });

  it("are Web Mercator's around the map's centre", () => {
    const place = placeOnScreen(map(FIELD.lon, FIELD.lat, 17) as never);
    expect(place([FIELD.lon, FIELD.lat])).toEqual([400, 300]);
    const metres_per_px = (40_075_016.7 * Math.cos((FIELD.lat * Math.PI) / 180)) / (512 * 2 ** 17);
    const [x, y] = place(at(100, 50));
    expect((x - 400) * metres_per_px).toBeCloseTo(100, 0);
    expect((300 - y) * metres_per_px).toBeCloseTo(50, 0);
  });

  it("are the nearer ones beside the date line", () => {
    const [x] = placeOnScreen(map(179.999, 0, 12) as never)([-179.999, 0]);
    expect(x).toBeGreaterThan(400);
    expect(x).toBeLessThan(450);
  });
});
