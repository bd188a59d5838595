import type { JSX } from "solid-js";
import type { AuthorityHolder, VehicleView } from "../../protocol";
import { plural } from "./grammar";

/** A vehicle's details. */
export const detail = {
  none: "Select a vehicle to see its telemetry.",
  noSerial: "waiting for serial number: only ALL STOP reaches this vehicle",
  serial: (serial: string) => `serial ${serial}`,
  simulated: "simulated",
  conflict: (links: string) =>
    `Serial conflict: link ${links} reports the same serial number. Hover, land and return are sent to all of these links.`,
  /** Read before a value's age. */
  age: "age",
  reported: "Reported by its app",
};

/** What an app reports of its aircraft. */
export const appFacts = {
  goHomeHeight: "Go-home height",
  failsafe: "Controller lost",
  failsafes: { go_home: "goes home", hover: "hovers", land: "lands" } as Record<string, string>,
  homePoint: "Home point",
  maxHeight: "Maximum height",
  maxDistance: "Maximum distance",
  missions: "Flies missions",
  djiCheck: "Check with DJI",
  passed: "passed",
  failed: "failed",
  cameraMode: "Camera mode",
  photoInterval: "Photo interval",
  exposure: "Exposure",
  whiteBalance: "White balance",
  locked: "locked",
  automatic: "automatic",
  storagePhotos: "Photos that fit",
  storage: "Storage left",
  gimbalPitch: "Gimbal pitch",
  cells: "Battery cells",
  cellRange: (count: number, least: string, most: string) =>
    `${plural(count, "cell")}, ${least} to ${most} V`,
  batteryTemperature: "Battery temperature",
  rtk: "RTK",
  rtkStates: {
    off: "off",
    none: "no corrections",
    single: "single",
    float: "float",
    fixed: "fixed",
  } as Record<string, string>,
  model: "Model",
  firmware: "Firmware",
  app: "App",
  photosReported: "Photos reported",
  photosWithout: (count: number, missing: number) =>
    `${count}, of which ${missing} without a report`,
};

export const facts = {
  height: "Height above takeoff",
  altitude: "Altitude (WGS84, as reported)",
  groundSpeed: "Speed over ground",
  climbRate: "Climb rate",
  heading: "Heading",
  pitch: "Pitch (nose up)",
  roll: "Roll (right down)",
  latitude: "Latitude",
  longitude: "Longitude",
  battery: "Battery",
  batteryWarning: "Battery warning",
  flightMode: "Flight mode",
  flying: "Flying",
  doubted: "Telemetry doubted",
  satellites: "Satellites",
  gnssSignal: "GNSS signal (0 to 10)",
  windLevel: "Wind level",
  missionId: "Mission id",
  noMission: "none",
  camera: "Camera",
  waypointAltitude: "Waypoint altitude",
  waypointAltitudes: {
    takeoff: "above takeoff",
    wgs84: "WGS84",
  } satisfies Record<Exclude<VehicleView["waypoint_altitude"], "unset">, string>,
  waypointAltitudeUnset: "not set in the site file: missions are refused",
  yes: "yes",
  no: "no",
  uncertain: "uncertain",
  reportsFlight: (believed: string) => `${believed} (reports in flight)`,
  reportsGround: (believed: string) => `${believed} (reports on the ground)`,
  notReceived: "not received yet",
  notValid: "no valid value in telemetry",
};

export const camera = {
  name: "Camera",
  rates: "Pictures per second",
  rate: (count: number) => `${count} per second`,
  perSecond: "pictures per second",
  start: "Start camera",
  stop: "Stop camera",
  lock: "Lock exposure",
  unlock: "Unlock exposure",
  selectFirst: "Camera: select a vehicle first.",
  selectOne: "Camera: select only one vehicle.",
  noSerial: "Camera: waiting for serial number.",
  loading: "Loading picture",
  of: (vehicle: string) => `Camera of ${vehicle}`,
};

/** All cameras that send pictures. */
export const cameras = {
  none: "No camera sends pictures. Select a vehicle, and start its camera under Vehicle details.",
  enlarge: (vehicle: string) => `Enlarge the picture of ${vehicle}`,
  close: "Close the large picture",
};

/** Captions of pictures. */
export const frames = {
  frame: (id: number, age: string, sigma: string) => `frame ${id}, taken ${age} ago ± ${sigma}`,
  frameOfUnknownTime: (id: number) => `frame ${id}, capture time unknown`,
  unnumbered: (age: string, sigma: string) => `unnumbered frame, taken ${age} ago ± ${sigma}`,
  unnumberedOfUnknownTime: "unnumbered frame, capture time unknown",
  newerExists: "; a newer frame exists",
};

export const authority = {
  name: "Control authority",
  control: {
    pilot: "Pilot control",
    operator: "Operator control",
    guidance: "Guidance control",
  } satisfies Record<AuthorityHolder, string>,
  sinceStart: "since station start",
  since: (age: string) => `for ${age}`,
  takeOver: "Take over",
  takeOverFrom: (person: string) => `Take over from ${person}`,
  handOver: "Hand over to pilot",
  operatedBy: (person: JSX.Element): JSX.Element => ["Operated by ", person],
  you: (person: string) => `${person} (you)`,
  operatedFor: (age: string) => `for ${age}`,
  absent: (age: string, absent: string) => `for ${age}, not connected for ${absent}`,
  refused: "Your orders to move it are refused. Hover, return, land and all stop are accepted.",
};

/** A lost vehicle's hazard area. */
export const hazard = {
  name: "Hazard area",
  noTelemetry: (age: string) => `No telemetry for ${age}.`,
  where: (radius: string) =>
    `The vehicle may be anywhere within ${radius} of its last position, or returning home. Other vehicles keep clear until telemetry returns.`,
  clear: "Clear hazard area",
  clearWhen: "Only if the aircraft is confirmed on the ground or under manual control.",
};

export const preflight = {
  name: "Preflight checklist",
  state: (state: string) => `Preflight: ${state}`,
  loading: "loading",
  notUpdated: (problem: string) => `Checklist not updated: ${problem}`,
  overridden: "Overridden",
  overriddenBy: (
    overridden: JSX.Element,
    person: string,
    age: string,
    reason: string,
  ): JSX.Element => [overridden, ` by ${person}, ${age} ago: ${reason}. Ends at landing.`],
  itemsOk: (count: number) => `${plural(count, "item")} OK`,
  passed: "Preflight: passed",
  blocked: (count: number) =>
    `Preflight: ${count} ${count === 1 ? "item blocks" : "items block"} missions`,
  reason: "Reason for flying missions anyway",
  override: "Override the checklist",
  enterReason: (least: number) =>
    `Enter a reason of at least ${least} characters. It is recorded in the audit log.`,
};

/** The failsafe matrix. */
export const failsafe = {
  byDefault: "When something fails: default",
  changed: (changed: number, all: number, weaker: number) =>
    `When something fails: ${changed} of ${all} changed, ${weaker} weaker`,
  when: "When",
  mission: "Mission",
  steered: "Steered",
  holding: "Holding",
  routeHome: "Route home",
  cell: (action: string, usual: string) => `${action} (default: ${usual})`,
};
