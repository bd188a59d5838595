import type { Page } from "@playwright/test";
import type {
  SiteDrawingResponse,
  SiteDrawingView,
  SiteVehiclesResponse,
  SiteVehiclesView,
} from "../../src/protocol";
import { station, vehicle } from "../../src/testing/fakeState";
import type { FakeStation } from "./station";

export const HERE = station([vehicle(1)]);
const [LON, LAT] = [HERE.site?.longitude_deg ?? 0, HERE.site?.latitude_deg ?? 0];

function square(half_deg: number): number[][] {
  const [west, east] = [LON - half_deg, LON + half_deg];
  const [south, north] = [LAT - half_deg, LAT + half_deg];
  return [
    [west, north],
    [east, north],
    [east, south],
    [west, south],
    [west, north],
  ];
}

export const DRAWING: SiteDrawingView = {
  revision: "r1",
  locked_reason: null,
  undo: { what: "boundary", by: "anna (10.0.0.2)", utc: "2026-05-01T12:00:00+00:00" },
  features: [
    {
      layer: "boundary",
      geometry: { type: "Polygon", coordinates: [square(0.0012)] },
      properties: { name: "boundary" },
    },
    {
      layer: "survey_regions",
      geometry: { type: "Polygon", coordinates: [square(0.0008), square(0.0002)] },
      properties: { name: "north field" },
    },
    {
      layer: "keep_out",
      geometry: { type: "Polygon", coordinates: [square(0.0001)] },
      properties: { name: "farmyard", ceiling_m: 30, datum: "ground" },
    },
    {
      layer: "landing_pads",
      geometry: { type: "Point", coordinates: [LON + 0.001, LAT] },
      properties: { name: "home", altitude_m: 275 },
    },
  ],
};

/** A refusal of the keep-out zone. */
export const REFUSED: SiteDrawingResponse = {
  accepted: false,
  rule: "site_drawing",
  reason: "Expected a polygon whose edges do not meet, but edges 1 and 3 do",
  feature: 2,
  layers: [],
  has_vehicles: false,
  drawing: null,
};

/** Vehicles that are connected, and one that never was. */
export const VEHICLES: SiteVehiclesView = {
  revision: "r1",
  locked_reason: null,
  undo: DRAWING.undo,
  vehicles: [
    {
      serial: "SN-001",
      name: "Alder",
      number: 1,
      camera: "mini3pro",
      waypoint_altitude: "takeoff",
    },
    { serial: "SN-009", name: null, number: 12, camera: null, waypoint_altitude: null },
  ],
};

/** A refusal of the second vehicle. */
export const REFUSED_VEHICLE: SiteVehiclesResponse = {
  accepted: false,
  rule: "site_drawing",
  reason: "Number: 1 is the number of Alder too",
  row: 1,
  changes: [],
  vehicles: null,
};

/** Sends states until the page closes: without, the page would report the station lost. */
export function sendAges(page: Page, fake: FakeStation): void {
  const begin_ms = performance.now();
  const timer = setInterval(() => {
    fake.send({ ...HERE, time_ns: HERE.time_ns + (performance.now() - begin_ms) * 1e6 });
  }, 200);
  page.once("close", () => clearInterval(timer));
}
