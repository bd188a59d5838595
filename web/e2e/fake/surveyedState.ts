import type { StationState, SurveyPaths } from "../../src/protocol";
import { shadeLine, survey, surveyLight } from "../../src/testing/fakeField";
import { area, at, station, vehicle } from "../../src/testing/fakeState";

const ID = 4;
const ROWS = [-60, -30, 0, 30, 60].map((east_m): [number, number][] => [
  at(east_m, -70),
  at(east_m, 70),
]);

/** A field during a survey: one vehicle flies rows, one returns for a battery, one waits. */
export function surveyedState(elapsed_s: number): StationState {
  const authority = {
    holder: "guidance",
    holder_name: "survey",
    age_s: 64,
    reason: "survey running",
  };
  const vehicles = [
    vehicle(1, { authority: { ...authority, holder: "guidance" } }),
    vehicle(2, { authority: { ...authority, holder: "guidance" } }),
    vehicle(3, { is_flying: { value: false, age_s: 0.1 } }),
    vehicle(4, { is_imager: true }),
  ];
  const plain = station(vehicles, { time_ns: 1e9 * (1 + elapsed_s) });
  const waits = {
    is_flying_rows: false,
    refused: null,
    waits_for: null,
    has_come_home: false,
    takes_off_automatically: false,
    mission_command_id: null,
  };
  return {
    ...plain,
    site: plain.site && {
      ...plain.site,
      areas: [
        area("boundary", [0, 0], 190),
        area("survey", [0, 0], 75, { name: "south-east field by the long brook" }),
        area("survey", [-130, 120], 30, { name: "orchard" }),
      ],
    },
    shade: shadeLine(),
    imager_relief: {
      serial: "SN-005",
      vehicle_name: "Elm",
      stage: "stopped",
      since_age_s: 95,
      begun_by: "anna (10.0.0.2): survey south-east field by the long brook",
      begun_age_s: 180,
      reason: "no 3 shade maps in a row within 60 s of its arrival: no frames",
      survey_id: ID,
      relieved: "SN-004",
      relieved_name: "Dogwood",
      maps: 0,
    },
    surveys: [
      survey(ID, {
        name: "south-east field by the long brook",
        light: surveyLight({
          imagers: [
            { serial: "SN-004", vehicle_name: "Dogwood", return_due_in_s: 540, unknown: null },
          ],
          absent: [{ serial: "SN-005", vehicle_name: "Elm", gone_age_s: 90, is_on_ground: true }],
        }),
        vehicles: [
          {
            serial: "SN-001",
            vehicle_name: "Alder",
            is_flying_rows: true,
            not_flying_reason: null,
            decision: null,
            refused: null,
            waits_for: null,
            has_come_home: false,
            takes_off_automatically: false,
            mission_command_id: -3,
          },
          {
            ...waits,
            serial: "SN-002",
            vehicle_name: "Birch",
            not_flying_reason: "recalled: battery too low for the remaining rows",
            decision: null,
          },
          {
            ...waits,
            serial: "SN-003",
            vehicle_name: "Cedar",
            not_flying_reason: "On the ground; takeoff was not allowed",
            decision: null,
          },
        ],
      }),
      survey(3, {
        name: "orchard",
        phase: "paused",
        reason: "every mission was refused; Cedar: path at 52 m above ground; the site allows 50 m",
        vehicles: [],
        figures: null,
        cells: null,
      }),
    ],
  };
}

/** The survey's rows, a current mission, and flown paths. */
export const WAYS: SurveyPaths = {
  survey_id: ID,
  rows: ROWS,
  flying: [{ serial: "SN-001", number: 2, places: [at(0, -70), at(0, 70), at(30, 70)] }],
  flown: [{ serial: "SN-001", number: 1, places: [at(-60, -70), at(-60, 70), at(-30, 70)] }],
};
