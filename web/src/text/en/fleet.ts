import type { JSX } from "solid-js";
import { plural } from "./grammar";

/** What vehicles do. */
export const activity = {
  names: {
    "Contact lost": "Contact lost",
    Unidentified: "Unidentified",
    Landing: "Landing",
    Returning: "Returning",
    Flying: "Flying",
    "On the ground": "On the ground",
    Unknown: "Unknown",
  },
  waitingForSerial: "Waiting for serial number",
  onGroundStopped: "On the ground · all stop",
  mayTakeOff: "On the ground · may take off",
  unknown: "Flight state unknown",
  allStop: "All stop",
  surveying: "Surveying",
  toTarget: "To target",
  holding: "Holding",
};

const fly = (names: string, count: number) => `${names} ${count === 1 ? "flies" : "fly"} rows`;

/** What happens now. */
export const happening = {
  sunlit: (names: string, count: number, time: string | null) =>
    time === null
      ? `${fly(names, count)}, sunlit ones first.`
      : `${fly(names, count)}, sunlit ones first; more of the field has sun at ${time}.`,
  unknownLight: (names: string, count: number) =>
    `${fly(names, count)}; the light is not known yet.`,
  rows: (names: string, count: number) => `${fly(names, count)}.`,
  waits: (name: string, decision: string) => `${name} ${decision}.`,
  nobody: "No drone flies rows.",
  paused: "The survey is paused.",
  landing: (names: string, count: number) =>
    `The survey is complete. ${names} ${count === 1 ? "is" : "are"} still flying.`,
  complete: "The survey is complete.",
  another: "The survey is complete. Another one begins when all batteries are good.",
};

/** The state of station and fleet, with its reasons. */
export const readiness = {
  labels: {
    "Station lost": "Station lost",
    "Contact lost": "Contact lost",
    Landing: "Landing",
    Flying: "Flying",
    "Not ready": "Not ready",
    Warnings: "Warnings",
    Ready: "Ready",
  },
  why: "Why",
  reasons: "Reasons",
  noProblems: "All vehicles connected, no problems",
  simulation: "Simulation",
  mixed: "Real and simulated",
  countOf: (count: number, all: number) => `${count} of ${all}`,
  waiting: "Waiting for data from the station.",
  lastData: (reason: string, age: string) => `${reason}. Last data ${age} ago.`,
  noTelemetryYet: "No telemetry yet.",
  noTelemetry: (age: string) => `No telemetry for ${age}.`,
  noSerial: "Waiting for serial number.",
  serialConflict: "A second link reports the same serial number.",
  noPosition: "Position unknown.",
  battery: (warning: string, left: string) => `Aircraft battery warning: ${warning}, ${left} left.`,
  isMixed: "Real and simulated vehicles are connected together.",
  noVehicle: "No vehicle connected. Start a companion app and enter the station's address.",
};

/** The list of vehicles. */
export const vehicles = {
  tools: "Search, sort and filter",
  all: "All",
  none: "None",
  show: "Show the vehicles",
  fold: "Collapse the vehicles",
  noneMatches: "None matches.",
  search: "Search",
  searchName: "Search by number, name or serial",
  filter: "Show",
  filters: {
    all: "All",
    flying: "Flying",
    trouble: "With a problem",
    selected: "Selected",
  },
  sort: "Sort by",
  sorts: {
    number: "Number",
    name: "Name",
    battery: "Battery",
    trouble: "Trouble",
  },
  group: "Group by",
  groups: {
    none: "No groups",
    activity: "What they do",
    role: "Kind",
  },
  imagers: "Imaging drones",
  surveyors: "Survey drones",
  noApp: "No companion app connected.",
  appAddress: "App address:",
  selectHint: "Add to the selection, or remove",
  doingHint: (doing: string) => `${doing} (ATO: above its own takeoff point)`,
  select: (vehicle: string) => `Add ${vehicle} to the selection`,
  simulated: "SIM",
  serialConflict: "serial conflict",
  telemetryAge: (age: string) => `Telemetry is ${age} old`,
  battery: "Battery",
  operatedBy: (person: string) => `Operated by ${person}`,
};

export const alarms = {
  none: "No active alarms.",
  ended: (count: number) => `Ended, not acknowledged: ${count}`,
  acknowledge: (alarm: string) => `OK: acknowledge ${alarm}`,
  acknowledgeHint: "Seen: the colour goes, the alarm stays while its cause lasts",
  ok: "OK",
  since: (age: string, isActive: boolean, isAcknowledged: boolean) =>
    `${age} ago${isActive ? "" : ", ended"}${isAcknowledged ? ", acknowledged" : ""}`,
  showEach: "Show each",
  noConnection: "No connection",
  /** Causes by the station's rule, as operators name them; any other is read from its rule. */
  causes: {
    separation: "Separation",
    link_lost: "Telemetry lost",
    connection: "Connection to the station",
    stop_waits: "Stop not confirmed",
    serial_conflict: "Serial conflict",
    unidentified: "Serial number missing",
    battery: "Battery",
    geofence: "Geofence",
    gnss: "GNSS",
    side_step: "Side-step",
    move_upwind: "Move upwind",
    imager_relief: "Imaging drone",
  } as Readonly<Record<string, string>>,
  pairs: (cause: string, count: number) => `${cause}: ${count} pairs`,
  drones: (cause: string, count: number) => `${cause}: ${plural(count, "drone")}`,
  alarms: (cause: string, count: number) => `${cause}: ${plural(count, "alarm")}`,
};

export const sound = {
  name: "Sound of alarms",
  replay: "A replay makes no sound.",
  allMuted: "All alarms are muted in this browser.",
  problems: {
    blocked: "Press anywhere on this page to allow sound.",
    absent: "This browser plays no sound: watch the screen.",
  },
  full: "Tone and speech.",
  toneOnly: "Tone only: no English voice is installed.",
  muteAll: "Mute all",
  test: "Test sound",
  allowNotes: "Notify in the background",
  testSentence: "This is a test",
  mute: (cause: string) => `Mute ${cause}`,
  unmute: (cause: string) => `Unmute ${cause}`,
  unmuteAll: "Unmute",
  isMuted: "Muted in this browser",
  muteHint: "Mute this kind of alarm in this browser",
  silent: "No sound for:",
  /** How units are spoken. */
  units: {
    s: (digit: string) => `${digit} seconds`,
    m: (digit: string) => `${digit} metres`,
    ft: (digit: string) => `${digit} feet`,
    "m/s": (digit: string) => `${digit} metres per second`,
    "%": (digit: string) => `${digit} per cent`,
  } as Readonly<Record<string, (digit: string) => string>>,
};

export const separation = {
  isOff: "Separation hold is OFF.",
  offText: "Vehicles that come too close raise an alarm but are not stopped.",
  switchOn: "Switch separation hold on",
  switchOff: "Switch separation hold off",
  name: "Separation hold",
  state: (state: JSX.Element): JSX.Element => ["Separation hold: ", state],
  on: "on",
  off: "OFF",
};
