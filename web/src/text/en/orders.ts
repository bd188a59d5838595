import type { JSX } from "solid-js";
import type { Order, Phase, ReturningView } from "../../protocol";
import { plural } from "./grammar";

/** How each order ends, after its count or its vehicle: `2 of 3 holding`. */
const reached = {
  holding: "holding",
  landing: "landing",
  returning: "returning",
};

export const orders = {
  name: "Orders to the selected vehicles",
  none: "Select one or more vehicles to command.",
  /** What is being held, and for which vehicles; both in bold. */
  keepHolding: (order: JSX.Element, vehicles: JSX.Element): JSX.Element => [
    "Keep holding to ",
    order,
    ": ",
    vehicles,
  ],
  selected: (vehicles: JSX.Element): JSX.Element => [vehicles, " selected"],
  notSentTo: (vehicles: string) => `Not sent to ${vehicles}: unidentified, ALL STOP only.`,
  selectFirst: "select vehicles first",
  labels: { hover: "Hover", return_home: "Return", land: "Land" },
  /** Completes `keepHolding`. */
  verbs: {
    hover: "hover",
    return_home: "climb to the go-home height and return home",
    land: "land",
  },
  notes: {
    hover: "Stop and hold position.",
    return_home: "Climbs to the aircraft's go-home height first.",
    land: "Land at the current position.",
  },
  takeOff: "Take off",
  takeOffTo: (height: string) => `Take off to ${height}`,
  flyHere: "Fly here",
  flyHereOff: "Select one vehicle to send it to a place",
  flyHereHint: "Fly the selected vehicle to a position on the map (G)",
  details: "Details",
  detailsHint: "Telemetry, camera, control and checklist (D)",
  /** Names of command kinds; an unknown kind is shown as received. */
  kinds: {
    hover: "Hover",
    land: "Land",
    return_home: "Return home",
    camera_start: "Camera on",
    camera_stop: "Camera off",
    camera_lock: "Exposure lock",
    mission: "Mission",
    stick: "Stick",
    goto: "Fly here",
    nudge: "Nudge",
    hold_position: "Hold position",
    follow_path: "Steered path",
  } satisfies Record<Order["kind"] | "follow_path", string> as Readonly<Record<string, string>>,
  allStop: "All stop",
  fleetReturn: "Return in layers (hold first)",
  allFlying: "all flying vehicles",
  noCheck: "No check result from the station. Try again.",
};

/** What became of an order. */
export const answers = {
  dismiss: "Dismiss",
  names: "Names",
  drones: (count: number) => plural(count, "drone"),
  sent: (order: string, vehicles: string) =>
    `${order}: sent to ${vehicles}, waiting for the station`,
  notConfirmed: (order: string, problem: string) => `${order}: not confirmed. ${problem}`,
  stopInForce: (order: string) => `${order}: in force; no drone is flying`,
  noneAddressed: (order: string) => `${order}: no drone was addressed`,
  reached,
  confirmedOne: "confirmed",
  acceptedOne: "accepted",
  one: (order: string, vehicle: string, state: string) => `${order} ${vehicle}: ${state}`,
  counted: (order: string, count: number, all: number, state: string) =>
    `${order}: ${count} of ${all} ${state}`,
  failedCount: (count: number) => `${count} failed`,
  refusedCount: (count: number) => `${count} refused`,
  refusedOne: (vehicle: string, reason: string) => `Refused: ${vehicle}: ${reason}`,
  failed: "Failed",
  accepted: "Accepted",
  confirmed: "Confirmed",
  onGround: "On the ground",
  notYet: (state: string) => `Not ${state} yet`,
};

const phases: Readonly<Record<Phase, string>> = {
  queued: "Queued",
  sent: "Sent",
  acknowledged: "Acknowledged",
  confirmed: "Confirmed",
  started: "Started",
  done: "Done",
  refused_by_station: "Refused by station",
  refused_by_app: "Rejected by app",
  timed_out: "Timed out",
  superseded: "Replaced",
  expired: "Expired",
  failed: "Failed",
};

/** Commands and their phases. */
export const commands = {
  none: "No orders yet.",
  phases,
  phaseInHistory: (phase: Phase) => phases[phase].toLowerCase(),
  safetyRule: (rule: string) => `Safety rule: ${rule}`,
  issued: (of: {
    person: string;
    age: string;
    timesSent: number;
    takeoff: boolean;
    altitudes: string | null;
  }) =>
    [
      `${of.person}, ${of.age} ago`,
      of.timesSent > 1 ? `, sent ${of.timesSent} times` : "",
      of.takeoff ? "; takeoff allowed" : "",
      of.altitudes ? `; waypoints ${of.altitudes}` : "",
    ].join(""),
  mission: (part: JSX.Element): JSX.Element => ["Mission: ", part],
  adjusted: (count: number) => `Adjusted before sending: ${plural(count, "change")}`,
  history: "Command history",
};

export const stop = {
  allStop: "ALL STOP",
  allStopOf: "all flying vehicles hold position",
  allStopHint: "All flying vehicles hold position. Motors stay on. (Shift+S)",
  inForceFor: (age: string) => `in force ${age}`,
  inForce: "All stop in force",
  /** Follows `inForce`. */
  inForceText: (person: string, age: string, held: number) => {
    const vehicles = held === 0 ? "Vehicles that connect later" : plural(held, "drone");
    return `by ${person}, ${age} ago. ${vehicles}: only hover, return and land are sent. An operator or an administrator can release it.`;
  },
  releaseAll: "Release all",
  releaseAllOf: (vehicles: string) => `the all stop of ${vehicles}`,
  later: "vehicles that connect later",
  section: "All stop",
  stopped: "Stopped.",
  stoppedText: "An all stop holds this vehicle. A release sends nothing, and nothing resumes.",
  release: "Release this vehicle",
};

export const fly = {
  name: (vehicle: string) => `Fly ${vehicle} here`,
  title: (vehicle: string) => `Fly here: ${vehicle}`,
  leave: "Leave fly here",
  noDistance: "Distance unknown",
  course: (distance: string, bearing: string, time: string) =>
    `${distance}, bearing ${bearing}, about ${time}`,
  height: (unit: string) => `Above takeoff, ${unit}`,
  speed: "Speed, m/s",
  go: "Fly there and hold",
  aim: "Press the target position on the map.",
  useCentre: "Use map centre",
  allowed: "Allowed by the safety gate.",
  checking: "Checking with the safety gate",
  notNumbers: "Height and speed must be numbers; speed above 0.",
  nudge: "Nudge in small steps",
  stepSize: "Step size",
  nudgeHow: "Hold a button briefly.",
  /** Letters of the compass on the buttons, and what each button does. */
  north: "N",
  west: "W",
  south: "S",
  east: "E",
  nudges: {
    left: (vehicle: string, turn: string) => `nudge ${vehicle} turn left by ${turn}`,
    north: (vehicle: string) => `nudge ${vehicle} north`,
    right: (vehicle: string, turn: string) => `nudge ${vehicle} turn right by ${turn}`,
    up: (vehicle: string) => `nudge ${vehicle} up`,
    west: (vehicle: string) => `nudge ${vehicle} west`,
    south: (vehicle: string) => `nudge ${vehicle} south`,
    east: (vehicle: string) => `nudge ${vehicle} east`,
    down: (vehicle: string) => `nudge ${vehicle} down`,
  },
};

/** A mission drawn on the map. */
export const mission = {
  button: "Mission",
  hint: "Draw a mission on the map for the selected vehicle (M)",
  selectOne: "Select one vehicle to draw a mission for it",
  fliesNone: (vehicle: string) =>
    `${vehicle} flies no missions: its model is steered. Use Fly here`,
  name: (vehicle: string) => `Mission: ${vehicle}`,
  leave: "Leave the mission",
  first: "Press the points on the map, in the order in which they are flown.",
  next: "Press for the next point; drag to move one.",
  atCentre: "At map centre",
  more: "A mission has at least two points.",
  notNumbers: "Heights and speed must be numbers; speed above 0.",
  point: (number: number) => `Point ${number}`,
  pointHint: "The next point is added behind the selected one",
  pointOnMap: (number: number, height: string) =>
    `Point ${number}, ${height}. Drag it, or move it by arrow keys; Delete removes it`,
  heightOf: (number: number, unit: string) => `Point ${number}: above takeoff, ${unit}`,
  remove: (number: number) => `Remove point ${number}`,
  removeShort: "Remove",
  discard: "Clear points",
  figures: (distance: string, time: string) => `${distance}, about ${time}`,
  land: "Land at the end",
  go: "Fly the mission",
  takeOffAndFly: "Take off and fly",
};

/** Return in layers. */
export const fleetReturn = {
  how: "Each vehicle holds first, then flies home at its own height and lands; one vehicle at a time per pad.",
  all: "Return all",
  allOf: "every vehicle, in layers",
  inReach: "all vehicles in reach",
  selected: "Return selected",
  selectedOf: (vehicles: string) => `${vehicles}, in layers`,
  progress: "Progress of the return",
  finished: (landed: number, all: number) => `Finished: ${landed} of ${all} landed`,
  inProgress: (landed: number, all: number) => `In progress: ${landed} of ${all} landed`,
  started: (age: string, person: string) => `Started ${age} ago by ${person}`,
  landed: "Vehicles landed",
  /** After the vehicle's name. */
  stages: {
    stopping: "stopping",
    waiting: "waiting",
    ordered: "return ordered",
    flying: "flying home",
    landed: "landed",
    released: "under other control",
    excluded: "not included",
  } satisfies Record<ReturningView["stage"], string>,
  since: (age: string, height: string | null, pad: string | null) =>
    [
      `for ${age}`,
      ...(height === null ? [] : [`${height} above takeoff`]),
      ...(pad === null ? [] : [`pad ${pad}`]),
    ].join(", "),
  notIncluded: "Not included: operator action needed",
  wave: (number: number) => `Wave ${number}`,
  notScheduled: "Not scheduled yet",
};
