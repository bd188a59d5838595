import type { Map as MapLibre } from "maplibre-gl";
import { beforeEach, describe, expect, it } from "vitest";
import type { VehicleView } from "../protocol";
import { at, FIELD, station, vehicle } from "../testing/fakeState";
import type { Colours } from "./colours";
import { TrailLayer } from "./trailLayer";

const PIXELS_PER_M = 2;
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
  survey: "#000004",
  vehicle: (number) => `colour ${number}`,
};

let drawings: GeoJSON.FeatureCollection[];
let pixelsPerM: number;
let zoomed: () => void;
let time_s: number;
let layer: TrailLayer;

beforeEach(() => {
  drawings = [];
  time_s = 1;
  pixelsPerM = PIXELS_PER_M;
  const [east] = at(1, 0);
  const [, north] = at(0, 1);
  const map = {
    addSource: () => {},
    addLayer: () => {},
    setPaintProperty: () => {},
    on: (_event: string, action: () => void) => {
      zoomed = action;
    },
    getLayersOrder: () => [],
    getSource: () => ({ setData: (data: GeoJSON.FeatureCollection) => drawings.push(data) }),
    project: ([lon, lat]: [number, number]) => ({
      x: ((lon - FIELD.lon) / (east - FIELD.lon)) * pixelsPerM,
      y: ((FIELD.lat - lat) / (north - FIELD.lat)) * pixelsPerM,
    }),
  };
  layer = new TrailLayer();
  layer.add(map as unknown as MapLibre, PLAIN);
});

function show(east_m: number, changes: Partial<VehicleView> = {}): void {
  const [longitude_deg, latitude_deg] = at(east_m, 0);
  const position = { longitude_deg, latitude_deg, age_s: 0.1 };
  const one = vehicle(1, { position, track: [at(-50, 0)], ...changes });
  layer.update({
    state: station([one], { time_ns: time_s * 1e9 }),
    behindS: 0,
    selected: [],
    plannedTarget: null,
    zoneDraft: null,
    siteDraft: null,
  });
}

describe("trails", () => {
  it("end at the vehicle's position", () => {
    show(10);
    expect(drawings).toHaveLength(1);
    const line = drawings[0]?.features[0]?.geometry as GeoJSON.LineString;
    expect(line.coordinates).toEqual([at(-50, 0), at(10, 0)]);
  });

  it("are not redrawn while the symbol hides the difference", () => {
    for (const east_m of [0, 0, 2, 4, 5.9]) {
      show(east_m);
      time_s += 2;
    }
    expect(drawings).toHaveLength(1);
    show(6.1);
    expect(drawings).toHaveLength(2);
  });

  it("are redrawn every two seconds at most, however fast a vehicle is", () => {
    for (let tick = 0; tick <= 45; tick += 1) {
      show(10 * tick);
      time_s += 0.1;
    }
    expect(drawings).toHaveLength(3);
  });

  it("are redrawn when zooming uncovers their end", () => {
    show(0);
    show(4);
    pixelsPerM = 10 * PIXELS_PER_M;
    zoomed();
    expect(drawings).toHaveLength(2);
  });

  it("are redrawn when they become stale, start or change theme", () => {
    show(0, { track: [] });
    show(0);
    show(0, { staleness: "lost", telemetry_age_s: 4 });
    expect(drawings.map(({ features }) => features[0]?.properties?.["colour"])).toEqual([
      undefined,
      "colour 1",
      "grey",
    ]);
    layer.recolour({ ...PLAIN, stale: "black" });
    expect(drawings.at(-1)?.features[0]?.properties?.["colour"]).toBe("black");
  });
});
