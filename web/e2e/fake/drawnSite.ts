import type { Page } from "@playwright/test";
import type {
  CalibrationView,
  FrozenFrameView,
  SiteDrawingResponse,
  SiteDrawingView,
  SiteVehiclesResponse,
  SiteVehiclesView,
} from "../../src/protocol";
import { square, station, vehicle } from "../../src/testing/fakeState";
import type { FakeStation } from "./station";

export const HERE = station([vehicle(1)]);
const CENTRE = [HERE.site?.longitude_deg ?? 0, HERE.site?.latitude_deg ?? 0] as const;
const [LON, LAT] = CENTRE;

export const DRAWING: SiteDrawingView = {
  revision: "r1",
  locked_reason: null,
  undo: { what: "boundary", by: "anna (10.0.0.2)", utc: "2026-05-01T12:00:00+00:00" },
  features: [
    {
      layer: "boundary",
      geometry: { type: "Polygon", coordinates: [square(CENTRE, 0.0012)] },
      properties: { name: "boundary" },
    },
    {
      layer: "survey_regions",
      geometry: { type: "Polygon", coordinates: [square(CENTRE, 0.0008), square(CENTRE, 0.0002)] },
      properties: { name: "north field" },
    },
    {
      layer: "keep_out",
      geometry: { type: "Polygon", coordinates: [square(CENTRE, 0.0001)] },
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
  also: [],
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

export const FROZEN: FrozenFrameView = {
  accepted: true,
  reason: null,
  frame_id: 7,
  cols: 1280,
  rows: 720,
  latitude_deg: LAT,
  longitude_deg: LON,
  surveyed: [
    { name: "GATE", latitude_deg: LAT, longitude_deg: LON, altitude_m: 275 },
    { name: "TRACK", latitude_deg: LAT + 0.0003, longitude_deg: LON, altitude_m: 275 },
  ],
};

/** A fit with one point that is off. */
export const FIT: CalibrationView = {
  accepted: true,
  rule: null,
  reason: null,
  rms_px: 2.31,
  residuals: [{ name: "GATE", col_px: -6.2, row_px: 4.1, ground_m: 1.42 }],
  height_above_ground_m: 119.6,
  tilt_deg: 0.8,
};

/** Sends states until the page closes: without, the page would report the station lost. */
export function sendAges(page: Page, fake: FakeStation): void {
  const begin_ms = performance.now();
  const timer = setInterval(() => {
    fake.send({ ...HERE, time_ns: HERE.time_ns + (performance.now() - begin_ms) * 1e6 });
  }, 200);
  page.once("close", () => clearInterval(timer));
}
