import type { FailsafeRowView, PreflightView, StationState } from "../../src/protocol";
import { alarm, area, at, command, hazard, station, vehicle } from "../../src/testing/fakeState";

/** A field with fences, a lost vehicle, a steered one, and a fleet returning home. */
export function fencedState(elapsed_s: number): StationState {
  const [longitude_deg, latitude_deg] = at(40, 110);
  const vehicles = [
    vehicle(1, {
      authority: {
        holder: "guidance",
        holder_name: "survey",
        age_s: 64,
        reason: "survey running",
      },
    }),
    vehicle(2, {
      steering: {
        command_id: 21,
        latitude_deg,
        longitude_deg,
        height_above_takeoff_m: 42,
        speed_mps: 5,
        has_arrived: false,
        is_ending: false,
      },
    }),
    vehicle(3, {
      staleness: "lost",
      telemetry_age_s: 5 + elapsed_s,
      hazard: hazard([30, 30], { corridor: [at(30, 30), at(-120, -100)], radius_m: 60 }),
    }),
    vehicle(4, { is_flying: { value: false, age_s: 0.1 } }),
  ];
  const plain = station(vehicles, { time_ns: 1e9 * (1 + elapsed_s) });
  const pad = (name: string, serial: string | null, east_m: number) => {
    const [lon, lat] = at(east_m, -130);
    return { name, serial, longitude_deg: lon, latitude_deg: lat, altitude_m: 281.5 };
  };
  const returning = {
    since_age_s: 8,
    reason: null,
    layer_height_m: 48,
    layer_height_above_takeoff_m: 48,
    pad: "P1",
    hold_command_id: 7,
    mission_command_id: 8,
  };
  return {
    ...plain,
    station: { ...plain.station, separation_hold_on: false },
    site: plain.site && {
      ...plain.site,
      areas: [
        area("boundary", [0, 0], 190),
        area("keep_out", [-120, 60], 34),
        area("height", [115, -95], 55, {
          name: "Power line",
          floor_m: 45,
          ceiling_m: 90,
          datum: "ground",
        }),
      ],
      pads: [pad("P1", "SN-001", -120), pad("P2", null, -90)],
    },
    alarms: [
      alarm(1, {
        severity: "critical",
        vehicle_name: "Cedar",
        text: "Flying without telemetry for 5 s.",
      }),
    ],
    commands: [
      command(21, {
        kind: "goto",
        vehicle_name: "Birch",
        phase: "started",
        is_final: false,
        history: [
          { phase: "queued", age_s: 9, note: "" },
          { phase: "started", age_s: 8, note: "" },
        ],
      }),
      command(20, {
        kind: "mission",
        part: "part 2 of 3",
        repairs: ["waypoint 3 is 0.40 m from waypoint 2 and was merged into it"],
        phase: "started",
        is_final: false,
      }),
    ],
    fleet_return: {
      called_by: "api 127.0.0.1",
      age_s: 31,
      is_over: false,
      vehicles: [
        { ...returning, serial: "SN-001", vehicle_name: "Alder", stage: "flying", wave: 1 },
        {
          ...returning,
          serial: "SN-002",
          vehicle_name: "Birch",
          stage: "waiting",
          wave: 2,
          reason: "pad in use by Alder",
        },
        {
          ...returning,
          serial: "SN-003",
          vehicle_name: "Cedar",
          stage: "excluded",
          wave: null,
          layer_height_m: null,
          layer_height_above_takeoff_m: null,
          pad: null,
          reason: "no telemetry",
        },
      ],
    },
  };
}

function failsafeRow(condition: string, name: string, texts: readonly string[]): FailsafeRowView {
  const activities = ["mission", "steered", "holding", "returning"] as const;
  const cells = activities.map((activity, index) => ({
    activity,
    reaction: "alarm" as const,
    after_s: 0,
    text: texts[index] ?? "alarm",
    default: activity === "mission" && condition === "wind" ? "return after 30 s" : null,
    is_weaker: activity === "mission" && condition === "wind",
  }));
  return { condition, name, begins: name, cells };
}

/** A checklist with an item that blocks missions, and a failsafe matrix with a weaker cell. */
export const CHECKLIST: PreflightView = {
  serial: "SN-001",
  name: "Alder",
  is_passed: false,
  override: null,
  points: [
    {
      key: "battery",
      name: "Battery",
      state: "ok",
      text: "80 % at takeoff",
      to_do: "",
      holds_back: false,
    },
    {
      key: "go_home_height",
      name: "Go-home height",
      state: "fails",
      text: "not set in the site file",
      to_do: "Write go_home_height_m into the vehicle's profile.",
      holds_back: true,
    },
  ],
  failsafe: [
    failsafeRow("telemetry_lost", "telemetry lost", [
      "hold after 3 s",
      "hold after 3 s",
      "alarm",
      "alarm",
    ]),
    failsafeRow("battery_low", "battery low", [
      "return after 15 s",
      "return after 15 s",
      "return after 15 s",
      "alarm",
    ]),
    failsafeRow("wind", "wind", ["alarm", "alarm", "alarm", "alarm"]),
  ],
};
