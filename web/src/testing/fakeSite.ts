import type {
  CalibrationRequest,
  CalibrationView,
  FrozenFrameView,
  ImportedView,
  SiteDrawingRequest,
  SiteDrawingResponse,
  SiteDrawingView,
  SiteVehiclesRequest,
  SiteVehiclesResponse,
  SiteVehiclesView,
} from "../protocol";
import type { SiteRequests } from "../source/siteRequests";
import { answered } from "./pageRequests";

/** A site's folder: what it answers, and what it was asked. */
export interface FakeSite {
  drawing: SiteDrawingView;
  /** The answer to checks, saves and undos. */
  response: SiteDrawingResponse;
  imported: ImportedView;
  /** Files that were read with paths as areas. */
  closedPaths: string[];
  readonly asked: (readonly [what: "check" | "save", drawing: SiteDrawingRequest])[];
  /** The vehicles, and the answer to their checks and saves. */
  vehicles: SiteVehiclesView;
  vehiclesResponse: SiteVehiclesResponse;
  readonly askedVehicles: (readonly [what: "check" | "save", vehicles: SiteVehiclesRequest])[];
  /** What a freeze and a fit answer; the points that were asked about. */
  frozen: FrozenFrameView;
  fit: CalibrationView;
  readonly askedFits: (readonly [what: "fit" | "accept", asked: CalibrationRequest])[];
  readonly undone: string[];
  readonly files: File[];
}

const ACCEPTED = { accepted: true, rule: null, reason: null };
const FIRST = { revision: "r1", locked_reason: null, undo: null };

/** An empty site that accepts everything. */
export function fakeSite(): FakeSite {
  return {
    drawing: { ...FIRST, features: [] },
    response: { ...ACCEPTED, feature: null, layers: [], also: [], drawing: null },
    closedPaths: [],
    imported: {
      features: [],
      excluded: [],
      warnings: [],
      is_fit_for_fences: true,
      has_open_paths: false,
      reason: null,
    },
    asked: [],
    vehicles: { ...FIRST, vehicles: [] },
    vehiclesResponse: { ...ACCEPTED, row: null, changes: [], vehicles: null },
    askedVehicles: [],
    frozen: {
      accepted: true,
      reason: null,
      frame_id: 7,
      cols: 1280,
      rows: 720,
      latitude_deg: 41.9,
      longitude_deg: -93.6,
      surveyed: [],
    },
    fit: { ...ACCEPTED, rms_px: 1.25, residuals: [], height_above_ground_m: 110, tilt_deg: 2 },
    askedFits: [],
    undone: [],
    files: [],
  };
}

export function fakeSiteRequests(site: FakeSite): SiteRequests {
  return {
    drawing: async () => answered(site.drawing),
    check: async (drawing) => {
      site.asked.push(["check", drawing]);
      return answered(site.response);
    },
    save: async (drawing) => {
      site.asked.push(["save", drawing]);
      return answered(site.response);
    },
    undo: async (revision) => {
      site.undone.push(revision);
      return answered(site.response);
    },
    vehicles: async () => answered(site.vehicles),
    checkVehicles: async (vehicles) => {
      site.askedVehicles.push(["check", vehicles]);
      return answered(site.vehiclesResponse);
    },
    saveVehicles: async (vehicles) => {
      site.askedVehicles.push(["save", vehicles]);
      return answered(site.vehiclesResponse);
    },
    freeze: async () => answered(site.frozen),
    frozenPicture: async () => answered({ blob: new Blob(["x"]), frameId: site.frozen.frame_id }),
    fitCalibration: async (asked) => {
      site.askedFits.push(["fit", asked]);
      return answered(site.fit);
    },
    calibrate: async (asked) => {
      site.askedFits.push(["accept", asked]);
      return answered(site.fit);
    },
    readFile: async (file, closePaths) => {
      site.files.push(file);
      if (closePaths) site.closedPaths.push(file.name);
      return answered(site.imported);
    },
  };
}
