import type { StationState, SurveyView, UpwindPlaceView, VehicleView } from "../protocol";
import { groundImage, shadeLine, survey, surveyLight } from "./fakeField";
import {
  alarm,
  appFacts,
  area,
  at,
  command,
  hazard,
  link,
  station,
  vehicle,
  zone,
} from "./fakeState";

/* A station with everything at once that the page can show. */

const aged = <T>(value: T) => ({ value, age_s: 0.4 });
const REPORTED = {
  flight_mode: aged("mode 7"),
  battery_warning: aged("low"),
  camera_state: aged("on"),
};
export const REPORTS = appFacts({
  go_home_height_m: 60,
  failsafe: "go_home",
  home_latitude_deg: 44.7,
  home_longitude_deg: -93.07,
  max_height_m: 120,
  max_distance_m: 2000,
  model: "Mavic 3M",
  firmware: "01.01.0300",
  app: "Recon 1.0",
  battery_cells_v: [3.91, 3.9, 3.92, 3.91],
  battery_temperature_c: 31.5,
  rtk: "fixed",
  storage_left_mb: 58_211,
  storage_left_photos: 7104,
  gimbal_pitch_deg: -90,
  camera_mode: "interval",
  photo_interval_s: 2,
  exposure_locked: true,
  white_balance_locked: false,
  can_fly_missions: true,
  dji_check_passed: true,
  reports_photos: true,
  orders: ["lock_camera"],
});
const HERE = at(20, 30);
const [LON, LAT] = HERE;
const BY = "Anna (10.0.0.2): Survey west";

function vehicles(): VehicleView[] {
  const steering = {
    command_id: 3,
    has_arrived: false,
    height_above_takeoff_m: 40,
    is_ending: false,
    latitude_deg: LAT,
    longitude_deg: LON,
    speed_mps: 5,
  };
  const lease = { person: "Bert", age_s: 30, absent_s: 4 };
  return [
    vehicle(1, {
      ...REPORTED,
      is_imager: true,
      lease,
      authority: { holder: "guidance", holder_name: BY, age_s: 64, reason: "Survey running" },
      app_facts: REPORTS,
      app_facts_age_s: 3.2,
      photos: { count: 41, missing: 2 },
      newest_photo_age_s: 1.4,
      frame: { id: 12, received_age_s: 0.3, captured_age_s: 0.8, captured_sigma_s: 0.2 },
    }),
    vehicle(2, { ...REPORTED, flight_mode: aged("auto_landing"), is_simulated: true, steering }),
    vehicle(3, {
      ...REPORTED,
      staleness: "lost",
      telemetry_age_s: 4.2,
      hazard: hazard([40, 40]),
      doubts: [{ kind: "position_jump", text: "Moved 900 m in 1 s", age_s: 2, packets: 3 }],
    }),
    vehicle(4, {
      ...REPORTED,
      is_stopped: true,
      reported_is_flying: aged(false),
      waypoint_altitude: "unset",
      lease: { ...lease, absent_s: null },
    }),
    vehicle(5, {
      ...REPORTED,
      is_flying: aged(false),
      conflict_link_ids: [9],
      mission_id: aged(0),
    }),
    vehicle(6, {
      ...REPORTED,
      number: 0,
      serial: null,
      name: "Link 6",
      position: { latitude_deg: null, longitude_deg: null, age_s: null },
    }),
  ];
}

const LIGHT = surveyLight({
  imagers: [
    { serial: "SN-003", vehicle_name: "Cedar", return_due_in_s: 540, unknown: null },
    { serial: "SN-004", vehicle_name: "Dogwood", return_due_in_s: null, unknown: "Charge unknown" },
  ],
  absent: [{ serial: "SN-002", vehicle_name: "Birch", gone_age_s: 200, is_on_ground: true }],
  without_age_s: 75,
  without_m2: 8000,
});

function surveys(): SurveyView[] {
  const phases = ["running", "paused", "created", "done", "planning", "refused"] as const;
  return phases.map((phase, index) =>
    survey(index + 1, {
      phase,
      reason: "Wind above 9 m/s",
      started_by: BY,
      light: phase === "running" ? LIGHT : null,
    }),
  );
}

const returning = {
  since_age_s: 4,
  layer_height_m: 48,
  layer_height_above_takeoff_m: 48,
  pad: "Pad 1",
  hold_command_id: 3,
  mission_command_id: 9,
};

/** The newest motions of an imaging drone. */
const motion = {
  begun_age_s: 9,
  begun_by: BY,
  reason: "Wind above 9 m/s",
  serial: "SN-001",
  since_age_s: 3,
  survey_id: null,
  vehicle_name: "Alder",
};

const seen = { now: 0.5, in_30_s: 0.5, in_60_s: 0.4, in_90_s: 0.3 };

const UPWIND: UpwindPlaceView = {
  distance_m: 30,
  height_above_takeoff_m: 100,
  here: seen,
  there: seen,
  latitude_deg: LAT,
  longitude_deg: LON,
  sentence: "Would see 9 s more",
  serial: "SN-001",
  speed_mps: 3,
  takes_s: 10,
  yaw_deg: 0,
};

export function fullState(): StationState {
  const fleet = vehicles();
  const plain = station(fleet);
  return {
    ...plain,
    station: {
      ...plain.station,
      app_url: "http://10.0.0.2:8080/app",
      link_addresses: ["10.0.0.2:3001", "10.0.0.3:3001"],
      separation_hold_on: false,
      connections_refused: 2,
      capture_dropped_bytes: 2048,
    },
    site: plain.site && {
      ...plain.site,
      areas: [
        area("boundary", [0, 0], 190),
        area("survey", [0, 0], 75),
        area("keep_out", [60, 60], 20, { ceiling_m: 30 }),
        area("height", [90, 60], 20, { floor_m: 10, ceiling_m: 30, datum: "wgs84" }),
      ],
    },
    links: [
      ...fleet.map((one) => link(one.number, { claimed_serial: one.serial })),
      link(8, {
        status: "waiting",
        waiting: { age_s: 4, is_flying: true, reason: "Not on the list", serial: "SN-008" },
      }),
      link(9, { status: "conflict", bad_hash: 3, bytes_skipped: 812, ignored_answers: 2 }),
      link(10, { status: "closed", closed_reason: "Reset by peer", claimed_serial: null }),
    ],
    alarms: [
      alarm(1),
      alarm(2, { severity: "critical", rule: "link_lost", vehicle_name: "Cedar" }),
      alarm(3, { severity: "critical", rule: "link_lost", vehicle_name: "Elm" }),
      alarm(4, { severity: "error", rule: "separation", is_acknowledged: true }),
      alarm(5, { severity: "error", rule: "separation", is_acknowledged: true }),
      alarm(6, { severity: "info", vehicle_name: "", is_active: false }),
    ],
    commands: [
      command(14, { part: "Rows 3 to 5", repairs: ["Excluded 2 points"], takeoff: true }),
      command(15, { kind: "land", phase: "acknowledged", times_sent: 3, sent_altitudes: "WGS84" }),
      command(16, { kind: "mission", phase: "refused_by_station", rule: "flying", note: "No way" }),
    ],
    stop_latch: { age_s: 12, by: BY, released: [] },
    temporary_zones: [zone(1), zone(2, [9, 9], { kind: "tractor", ends_in_s: 90, floor_m: 5 })],
    ground_image: groundImage({ frame_id: 12 }),
    fleet_return: {
      called_by: BY,
      age_s: 30,
      is_over: false,
      vehicles: (["landed", "waiting", "excluded", "flying"] as const).map((stage, index) => ({
        ...returning,
        serial: `SN-00${index + 1}`,
        vehicle_name: "Alder",
        stage,
        wave: index < 2 ? 1 : null,
        reason: "Pad in use",
      })),
    },
    side_step: { ...motion, bearing_deg: 90, stage: "aside" },
    move_upwind: { ...motion, place: UPWIND, stage: "upwind" },
    imager_relief: {
      ...motion,
      stage: "maps",
      relieved: "SN-003",
      relieved_name: "Cedar",
      maps: 1,
    },
    shade: shadeLine({ reference: "Of an earlier flight", rejected: "Too dark" }),
    surveys: surveys(),
  };
}
