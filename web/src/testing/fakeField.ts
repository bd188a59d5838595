import type {
  BaseMapView,
  FlownRegionView,
  GroundImageView,
  PlanExportsView,
  ShadeLineView,
  SurveyEstimateView,
  SurveyLightView,
  SurveyView,
} from "../protocol";
import { at } from "./fakeState";

/** What a survey of two hectares takes, with `changes` applied. */
export function surveyEstimate(changes: Partial<SurveyEstimateView> = {}): SurveyEstimateView {
  return {
    survey_id: 7,
    refusal: null,
    region_m2: 20_000,
    reached_m2: 20_000,
    least_height_above_ground_m: null,
    most_height_above_ground_m: null,
    rows: 6,
    gsd_m: 0.0156,
    blur_px: 0.4,
    speed_limit_mps: 7.1,
    speed_limited_by: "70% front overlap with a photo every 2 s",
    time_s: 301,
    flown_s: 590,
    photos: 62,
    photos_in_all: 214,
    batteries: 2,
    rows_note: "",
    drones: [],
    warnings: [],
    ...changes,
  };
}

/** Two formats of a survey: one that names an aircraft, and one with something to set by hand. */
export function planExports(aircraft: string | null): PlanExportsView {
  const refusal = aircraft === null ? "a .kmz names its aircraft" : null;
  const kmz = { kind: "kmz", title: "DJI Pilot 2", by_hand: [] };
  const csv = { kind: "csv", title: "Litchi", files: 2, refusal: null };
  return {
    survey_id: 7,
    formats: [
      { ...kmz, files: refusal === null ? 1 : 0, refusal },
      { ...csv, by_hand: ["the end: set it to return home"] },
    ],
    aircraft: [
      { name: "Mavic 3E", payloads: [] },
      { name: "Matrice 350", payloads: ["H20", "H20T"] },
    ],
  };
}

/** A survey whose imaging drone must return in nine minutes, and that needs eighteen. */
export function surveyLight(changes: Partial<SurveyLightView> = {}): SurveyLightView {
  return {
    needs_s: 1080,
    imagers: [{ serial: "SN-003", vehicle_name: "Cedar", return_due_in_s: 540, unknown: null }],
    absent: [],
    unknown_in_s: 540,
    unknown_for_s: 540,
    without_age_s: null,
    without_m2: null,
    ...changes,
  };
}

/** A region of two hectares, flown on two days, with `changes` applied. */
export function flownRegion(changes: Partial<FlownRegionView> = {}): FlownRegionView {
  return {
    id: "77fbea7c1a8d8637",
    region: "south field",
    is_simulated: false,
    planner: "sunlit_first",
    height_above_takeoff_m: 50,
    height_above_ground_m: null,
    speed_mps: 5,
    camera_across_deg: 66,
    camera_along_deg: 52,
    row_spacing_m: 25.9,
    row_bearing_deg: 90,
    begun_unix_s: 1_777_630_000,
    started_unix_s: 1_777_800_000,
    reached_m2: 20_000,
    left_m2: 8_000,
    gaps_m2: null,
    days: [
      { day: "2026-05-03", imaged_m2: 6_000, in_sun_m2: 5_000 },
      { day: "2026-05-01", imaged_m2: 9_000, in_sun_m2: 7_000 },
    ],
    changes: [],
    refusal: null,
    ...changes,
  };
}

/** A survey of two hectares with one vehicle flying rows, with `changes` applied. */
export function survey(id: number, changes: Partial<SurveyView> = {}): SurveyView {
  return {
    id,
    name: "south field",
    region: "south field",
    phase: "running",
    reason: "round 1",
    asked_by: "api 127.0.0.1",
    age_s: 95,
    started_by: "api 127.0.0.1",
    planner: "lawnmower_again",
    when_done: "return_home",
    side_step_allowed: false,
    upwind_allowed: false,
    relief_allowed: false,
    spare_serial: null,
    light: null,
    height_above_takeoff_m: 50,
    height_above_ground_m: null,
    speed_mps: 5,
    rows_note: "",
    rest_since_unix_s: null,
    round: 1,
    missions: 2,
    flown_m: 420,
    vehicles: [
      {
        serial: "SN-001",
        vehicle_name: "Alder",
        is_flying_rows: true,
        not_flying_reason: null,
        decision: null,
        refused: null,
        waits_for: null,
        mission_command_id: -3,
        has_come_home: false,
        takes_off_automatically: false,
      },
      {
        serial: "SN-002",
        vehicle_name: "Birch",
        is_flying_rows: false,
        not_flying_reason: "battery too low",
        decision: null,
        refused: null,
        waits_for: null,
        mission_command_id: null,
        has_come_home: false,
        takes_off_automatically: false,
      },
    ],
    figures: {
      region_m2: 20_000,
      reached_m2: 20_000,
      not_yet_m2: 10_000,
      in_shade_m2: 2_000,
      in_sun_m2: 8_000,
      sun_unknown_m2: 0,
      not_shown_m2: 0,
      time_to_95_imaged_s: null,
      time_to_95_in_sun_s: null,
    },
    cells: { number: 1200, ...fieldGrid() },
    rows: 8,
    paths: 40,
    ...changes,
  };
}

/** The newest ground image, with `changes` applied. */
export function groundImage(changes: Partial<GroundImageView> = {}): GroundImageView {
  return {
    frame_id: 1,
    serials: ["SN-001"],
    captured_age_s: 0.5,
    captured_sigma_s: 0.2,
    registration: "unregistered",
    exposure_locked: false,
    registration_residual_m: null,
    reference: "telemetry of the marked frame",
    corners: [at(-10, 10), at(10, 10), at(10, -10), at(-10, -10)],
    cell_m: 1,
    rows: 20,
    cols: 20,
    ...changes,
  };
}

/** Shade detection and forecast running, with `changes` applied. */
export function shadeLine(changes: Partial<ShadeLineView> = {}): ShadeLineView {
  return {
    detection: "brightness_ratio",
    forecaster: "advection",
    frames_rejected: 0,
    frames_dropped: 0,
    rejected: null,
    error: null,
    reference: "",
    lock_problem: "",
    map: {
      number: 3,
      captured_age_s: 1.5,
      known_share: 0.9,
      sunlit_share: 0.62,
      in_view: { sun: 0.56, shade: 0.34, unknown: 0.1 },
      mean_confidence: 0.8,
      ...fieldGrid(),
    },
    forecast: {
      number: 3,
      issued_age_s: 1.5,
      method: "advection",
      lead_s: [0, 30, 60],
      predicted_share: [0.9, 0.5, 0.2],
      sun_share: [0.62, 0.66, 0.71],
      right: [{ lead_s: 60, right_share: 0.93 }],
      prior_sunlit: 0.6,
      shadows_east_mps: 5,
      shadows_north_mps: 1,
      ...fieldGrid(),
    },
    ...changes,
  };
}

function fieldGrid() {
  const corners = [at(-80, 80), at(80, 80), at(80, -80), at(-80, -80)];
  return { corners, cell_m: 4, rows: 40, cols: 40 };
}

/** A base map that covers all of the site to zoom 19. */
export function baseMap(changes: Partial<BaseMapView> = {}): BaseMapView {
  const covers = { zoom: 19, share: 1, metres_per_pixel: 0.2222 };
  return {
    name: "orthophoto.mbtiles",
    title: "orthophoto",
    kind: "MBTiles",
    size_bytes: 1_000_000,
    version: "1",
    attribution: "",
    min_zoom: 12,
    max_zoom: 19,
    tile_px: 256,
    west_deg: -93.61,
    south_deg: 41.89,
    east_deg: -93.59,
    north_deg: 41.91,
    covers,
    coverage: [covers],
    problem: null,
    ...changes,
  };
}
