import { circle } from "../map/localGrid";
import type {
  AlarmView,
  AppFactsView,
  AreaView,
  CommandView,
  HazardView,
  LinkView,
  OrderResult,
  StationState,
  TemporaryZoneView,
  VehicleView,
} from "../protocol";

/** Position of the field. */
export const FIELD = { lat: 44.7, lon: -93.07 };

const M_PER_LAT = 111_132;
const M_PER_LON = 79_300;

/** A point `east_m` and `north_m` from the field's centre, as longitude and latitude. */
export function at(east_m: number, north_m: number): [number, number] {
  return [FIELD.lon + east_m / M_PER_LON, FIELD.lat + north_m / M_PER_LAT];
}

function aged<T>(value: T | null, age_s: number | null = 0.1) {
  return { value, age_s };
}

/** A flying vehicle without problems, with `changes` applied. */
export function vehicle(number: number, changes: Partial<VehicleView> = {}): VehicleView {
  const [longitude_deg, latitude_deg] = at(60 * number - 150, 30 * number - 60);
  return {
    number,
    serial: `SN-00${number}`,
    link_id: number,
    name: ["Alder", "Birch", "Cedar", "Dogwood", "Elm", "Fir"][number - 1] ?? `Vehicle ${number}`,
    model: "DJI Mavic 2 Pro",
    camera: null,
    is_simulated: false,
    is_imager: false,
    authority: {
      holder: "operator",
      holder_name: "",
      age_s: null,
      reason: "not yet transferred",
    },
    lease: null,
    preflight_override: null,
    is_stopped: false,
    steering: null,
    staleness: "live",
    telemetry_age_s: 0.1,
    is_flying: aged(true),
    reported_is_flying: aged(true),
    doubts: [],
    position: { latitude_deg, longitude_deg, age_s: 0.1 },
    height_above_takeoff_m: aged(40 + 5 * number),
    reported_altitude_m: aged(331.4),
    velocity_ned: { north_mps: 3.1, east_mps: 2.2, down_mps: 0.1, age_s: 0.1 },
    attitude: { yaw_deg: 60 * number, pitch_deg: -4.2, roll_deg: 1.1, age_s: 0.1 },
    battery_fraction: aged(0.9 - 0.1 * number, 0.4),
    battery_warning: aged("none", 0.4),
    gnss_satellite_count: aged(17, 0.4),
    gnss_signal_level: aged(5, 0.4),
    wind_level: aged<number>(null, 0.4),
    flight_mode: aged("gps_waypoint", 0.4),
    mission_id: aged(12, 0.4),
    camera_state: aged("feed_on", 0.4),
    waypoint_altitude: "takeoff",
    flies_missions: true,
    conflict_link_ids: [],
    track: Array.from({ length: 12 }, (_, i) =>
      at(60 * number - 150 - 8 * (12 - i), 30 * number - 60 - 40 * Math.sin((12 - i) / 4)),
    ),
    frame: null,
    hazard: null,
    app_facts: null,
    app_facts_age_s: null,
    photos: null,
    newest_photo_age_s: null,
    ...changes,
  };
}

/** Facts of an app that knows only `known`. */
export function appFacts(known: Partial<AppFactsView>): AppFactsView {
  return {
    go_home_height_m: null,
    failsafe: null,
    home_latitude_deg: null,
    home_longitude_deg: null,
    max_height_m: null,
    max_distance_m: null,
    model: null,
    firmware: null,
    app: null,
    battery_cells_v: null,
    battery_temperature_c: null,
    rtk: null,
    storage_left_mb: null,
    storage_left_photos: null,
    gimbal_yaw_deg: null,
    gimbal_pitch_deg: null,
    gimbal_roll_deg: null,
    camera_mode: null,
    photo_interval_s: null,
    exposure_locked: null,
    white_balance_locked: null,
    can_fly_missions: null,
    max_waypoints: null,
    dji_check_passed: null,
    dji_check: null,
    reports_photos: null,
    orders: null,
    ...known,
  };
}

export function link(id: number, changes: Partial<LinkView> = {}): LinkView {
  return {
    id,
    remote_address: `192.168.1.${20 + id}:5${id}312`,
    status: "identified",
    claimed_serial: `SN-00${id}`,
    waiting: null,
    opened_age_s: 320,
    last_packet_age_s: 0.1,
    closed_reason: null,
    bytes_received: 412_000 * id,
    packets_received: 3840 * id,
    images_received: 0,
    bad_hash: 0,
    bad_size: 0,
    unknown_pid: 0,
    ignored_reports: 0,
    bytes_skipped: 0,
    commands_queued: 0,
    ignored_answers: 0,
    figures: { rate_hz: 10, jitter_s: 0.02, longest_gap_s: 0.3, bars: 4 },
    ...changes,
  };
}

export function alarm(id: number, changes: Partial<AlarmView> = {}): AlarmView {
  return {
    id,
    severity: "warning",
    rule: "battery",
    serial: "SN-004",
    link_id: 4,
    vehicle_name: "Dogwood",
    text: "Aircraft battery warning: low, 28 % left.",
    raised_age_s: 14,
    is_active: true,
    is_acknowledged: false,
    ...changes,
  };
}

export function command(id: number, changes: Partial<CommandView> = {}): CommandView {
  const history: CommandView["history"] = [
    { phase: "queued", age_s: 9.0, note: "" },
    { phase: "sent", age_s: 8.99, note: "" },
    { phase: "acknowledged", age_s: 8.8, note: "" },
    { phase: "confirmed", age_s: 6.4, note: "" },
  ];
  return {
    id,
    kind: "hover",
    serial: "SN-001",
    link_id: 1,
    vehicle_name: "Alder",
    issued_by: "api 127.0.0.1",
    age_s: 9.0,
    phase: "confirmed",
    is_final: true,
    note: "",
    rule: null,
    parameters: {},
    times_sent: 1,
    takeoff: false,
    sent_altitudes: null,
    part: null,
    repairs: [],
    history,
    ...changes,
  };
}

/** The result of an accepted order, with `changes` applied. */
export function orderResult(changes: Partial<OrderResult> = {}): OrderResult {
  return {
    serial: "SN-001",
    link_id: 1,
    vehicle_name: "Alder",
    is_simulated: false,
    accepted: true,
    command_id: 41,
    rule: null,
    reason: null,
    parameters: {},
    repairs: [],
    parts: 0,
    ...changes,
  };
}

/** A complete state with these vehicles, with `changes` applied. */
export function station(
  vehicles: VehicleView[],
  changes: Partial<StationState> = {},
): StationState {
  const { time_ns = 1e9 } = changes;
  return {
    time_ns,
    station: {
      version: "0.1.0",
      link_addresses: ["127.0.0.1:3001"],
      app_url: null,
      // The start time is the same for every `time_ns`.
      uptime_s: 840 + time_ns / 1e9,
      frames_dropped: 0,
      capture_folder: null,
      capture_dropped_bytes: 0,
      connections_refused: 0,
      apps_listed: null,
      separation_hold_on: true,
      guard_stop_url: null,
      repeats_surveys: false,
    },
    site: {
      name: "Field by the creek",
      latitude_deg: FIELD.lat,
      longitude_deg: FIELD.lon,
      ground_altitude_m: 281.5,
      imager_serials: ["SN-001"],
      pose_rms_px: 3.62,
      pose_height_m: 133.2,
      limits: {
        max_height_above_ground_m: 120,
        min_height_above_ground_m: 5,
        max_distance_from_home_m: 1000,
        max_speed_mps: 15,
        min_separation_horizontal_m: 15,
        min_separation_vertical_m: 6,
        boundary_margin_m: 5,
        battery_reserve_fraction: 0.25,
      },
      terrain: "flat assumed",
      layers: [],
      areas: [],
      areas_excluded: 0,
      areas_drawn_within_m: 0,
      outside_planners: [],
      pads: [],
    },
    vehicles,
    links: vehicles.map((one) => link(one.number, { claimed_serial: one.serial })),
    commands: [],
    alarms: [],
    stop_latch: null,
    temporary_zones: [],
    ground_image: null,
    fleet_return: null,
    side_step: null,
    move_upwind: null,
    imager_relief: null,
    shade: null,
    light_sensors: null,
    surveys: [],
    replay: null,
    ...changes,
  };
}

/** The closed ring of a square around a place, `half_deg` to each side. */
export function square([lon, lat]: readonly [number, number], half_deg: number): number[][] {
  const [west, east] = [lon - half_deg, lon + half_deg];
  const [south, north] = [lat - half_deg, lat + half_deg];
  return [
    [west, north],
    [east, north],
    [east, south],
    [west, south],
    [west, north],
  ];
}

/** A square area around a point of the field, `half_m` to each side. */
export function area(
  kind: AreaView["kind"],
  [east_m, north_m]: readonly [number, number],
  half_m: number,
  changes: Partial<AreaView> = {},
): AreaView {
  const corners: [number, number][] = [
    [-half_m, -half_m],
    [half_m, -half_m],
    [half_m, half_m],
    [-half_m, half_m],
    [-half_m, -half_m],
  ];
  const ring = corners.map(([east, north]) => at(east_m + east, north_m + north));
  return {
    kind,
    name: kind === "boundary" ? "" : "Barn",
    rings: [ring],
    floor_m: null,
    ceiling_m: null,
    datum: null,
    ...changes,
  };
}

/** A temporary zone of 20 m around a point of the field. */
export function zone(
  id: number,
  [east_m, north_m]: readonly [number, number] = [60, 40],
  changes: Partial<TemporaryZoneView> = {},
): TemporaryZoneView {
  const [lon, lat] = at(east_m, north_m);
  return {
    id,
    name: `person ${id} (temporary)`,
    kind: "person",
    ring: circle({ lon, lat }, 20),
    radius_m: 20,
    floor_m: null,
    ceiling_m: 30,
    reason: "Checks a sprinkler",
    by: "Ann",
    age_s: 130,
    ends_in_s: null,
    ...changes,
  };
}

/** A hazard area at a point of the field, growing by 10 m/s. */
export function hazard(
  [east_m, north_m]: readonly [number, number],
  changes: Partial<HazardView> = {},
): HazardView {
  const [longitude_deg, latitude_deg] = at(east_m, north_m);
  return {
    dismissal_name: "SN-003",
    age_s: 5,
    longitude_deg,
    latitude_deg,
    radius_m: 50,
    growth_mps: 10,
    largest_radius_m: 150,
    corridor: [],
    corridor_half_width_m: 12,
    ...changes,
  };
}
