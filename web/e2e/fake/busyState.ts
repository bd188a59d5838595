import type { StationState } from "../../src/protocol";
import { alarm, at, command, link, station, vehicle } from "../../src/testing/fakeState";
import { REPORTS } from "../../src/testing/fullState";

/** A field with many problems: everything the page must be able to show at once. */
export function busyState(elapsed_s: number): StationState {
  const vehicles = [
    vehicle(1, {
      is_imager: true,
      frame: { id: 12, received_age_s: 0.3, captured_age_s: 0.8, captured_sigma_s: 0.2 },
    }),
    vehicle(2, {
      flight_mode: { value: "auto_landing", age_s: 0.4 },
      app_facts: REPORTS,
      app_facts_age_s: 3.2,
      photos: { count: 41, missing: 2 },
      newest_photo_age_s: 1.4,
    }),
    vehicle(3, {
      staleness: "lost",
      telemetry_age_s: 4.2,
      position: { ...vehicle(3).position, age_s: 4.2 },
    }),
    vehicle(4, {
      is_simulated: true,
      battery_fraction: { value: 0.28, age_s: 0.4 },
      battery_warning: { value: "low", age_s: 0.4 },
    }),
    vehicle(5, { is_flying: { value: false, age_s: 0.1 }, conflict_link_ids: [9] }),
    vehicle(6, {
      number: 0,
      serial: null,
      name: "link 6",
      position: { latitude_deg: null, longitude_deg: null, age_s: null },
      is_flying: { value: null, age_s: null },
    }),
  ];
  return station(vehicles, {
    time_ns: 1e9 * (1 + elapsed_s),
    links: [
      ...vehicles.map((one) =>
        link(one.number, {
          claimed_serial: one.serial,
          status: one.serial === null ? "unidentified" : "identified",
        }),
      ),
      link(9, { status: "conflict", claimed_serial: "SN-005", bad_hash: 3, bytes_skipped: 812 }),
    ],
    alarms: [
      alarm(1),
      alarm(2, {
        severity: "critical",
        vehicle_name: "Cedar",
        text: "Flying without telemetry for 4 s.",
        raised_age_s: 1.2,
      }),
      alarm(3, {
        severity: "error",
        vehicle_name: "Elm",
        text: "Link 9 reports the same serial number.",
        raised_age_s: 60,
        is_acknowledged: true,
      }),
    ],
    commands: [
      command(14),
      command(15, {
        kind: "land",
        vehicle_name: "Birch",
        phase: "acknowledged",
        is_final: false,
        history: command(1).history.slice(0, 3),
      }),
      command(16, {
        kind: "return_home",
        vehicle_name: "Elm",
        phase: "refused_by_station",
        history: [{ phase: "refused_by_station", age_s: 3, note: "" }],
        rule: "flying",
        note: "On the ground; takeoff was not allowed",
      }),
    ],
    ground_image: {
      frame_id: 12,
      serials: ["SN-001"],
      captured_age_s: 0.8,
      captured_sigma_s: 0.2,
      registration: "unregistered",
      exposure_locked: false,
      registration_residual_m: null,
      reference: "telemetry at the marked frame",
      corners: [at(-170, 130), at(90, 130), at(90, -130), at(-170, -130)],
      cell_m: 0.5,
      rows: 520,
      cols: 520,
    },
  });
}
