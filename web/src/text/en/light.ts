import type {
  ImagerReliefView,
  LightSensorView,
  MoveUpwindView,
  SideStepView,
  SunAtView,
  SurveyRequest,
  SurveyView,
} from "../../protocol";
import { plural } from "./grammar";

const exposures = { locked: "locked", notLocked: "not locked", automatic: "automatic" };

/** What the imaging drone sees of sun and shade. */
export const sun = {
  none: "No imaging drone at this site.",
  noMap: "No shade map yet.",
  noGround: "No ground in view.",
  shares: "Light on the ground in view",
  lights: {
    sun: (share: string) => `Sun ${share}`,
    shade: (share: string) => `Shade ${share}`,
    unknown: (share: string) => `Light unknown ${share}`,
  } satisfies Record<SunAtView["light"], (share: string) => string>,
  inView: (age: string, exposure: keyof typeof exposures | null) =>
    exposure === null
      ? `of the ground in view, ${age} ago`
      : `of the ground in view, ${age} ago; exposure ${exposures[exposure]}`,
  reference: (what: string) => `Land in full sun: ${what}.`,
  motionUnknown: "Motion of the shadows unknown.",
  motion: (speed: string, bearing: string) => `Shadows move at ${speed}, bearing ${bearing}.`,
  ordered: (age: string, person: string) => `since ${age}, ordered by ${person}`,
};

/** Light sensors at the field, beside the shade map. */
export const lightSensors = {
  title: "Light sensors",
  shows: {
    sun: "In sun.",
    shade: "In shade.",
    unknown: "Has not seen sun and shade yet.",
  } satisfies Record<LightSensorView["shows"], string>,
  map: {
    sun: "Map: sun.",
    shade: "Map: shade.",
    unknown: "Map: unknown.",
    nowhere: "No place stated.",
  },
  right: (share: string, maps: number) => `Right in ${share} of ${plural(maps, "map")}.`,
  problem: (what: string, age: string) => `${what} (${age} ago)`,
  stale: (age: string) => `stale, ${age} ago`,
  ahead: (time: string) => `stale, clock ${time} ahead`,
  /** On the map. */
  mark: {
    sun: (name: string) => `Light sensor ${name}: in sun`,
    shade: (name: string) => `Light sensor ${name}: in shade`,
    unknown: (name: string) => `Light sensor ${name}: sun or shade not known yet`,
    stale: (name: string) => `Light sensor ${name}: stale`,
  },
};

/** What an imaging drone does, after its name, with a bearing or a distance. */
type Stages<View extends { readonly stage: string }> = Readonly<
  Partial<Record<View["stage"], (detail: string) => string>>
>;

export const sideStep = {
  name: "Side-step",
  how: (distance: string) =>
    `Under a uniform sky, an imaging drone flies ${distance} aside and back, to tell sun from shade.`,
  button: "Side-step",
  buttonFor: (vehicle: string) => `Side-step: ${vehicle}`,
  buttonOf: (vehicle: string, distance: string) => `fly ${vehicle} ${distance} aside and back`,
  imager: "the imaging drone",
  stages: {
    aside: (bearing: string) => `flies aside, bearing ${bearing}`,
    waiting: (bearing: string) => `waits beside its place, bearing ${bearing}`,
    back: (bearing: string) => `flies back, bearing ${bearing}`,
    done: (bearing: string) => `stepped aside and is back, bearing ${bearing}`,
    stopped: (bearing: string) => `stopped its side-step, bearing ${bearing}`,
  } as Stages<SideStepView>,
};

export const upwind = {
  name: "View upwind",
  noPlace: (vehicle: string, reason: string) => `No upwind position for ${vehicle}: ${reason}.`,
  fly: "Fly upwind",
  stages: {
    upwind: (distance: string) => `flies upwind automatically, ${distance}`,
    done: (distance: string) => `flew upwind automatically, ${distance}`,
    stopped: (distance: string) => `stopped its flight upwind, ${distance}`,
  } as Stages<MoveUpwindView>,
};

/** Until when a survey has light, and the relief of its imaging drone. */
export const relief = {
  name: "Light of the survey",
  leaves: (vehicle: string, time: string) => `${vehicle} must return at ${time}.`,
  leavesBefore: (vehicle: string, time: string, end: string) =>
    `${vehicle} must return at ${time}; the survey needs until about ${end}.`,
  leavesNow: (vehicle: string) => `${vehicle} must return now.`,
  notKnown: (vehicle: string, reason: string) =>
    `When ${vehicle} must return is not known: ${reason}.`,
  unknownFor: (minutes: number) =>
    `Without a second imaging drone, light is unknown from then on, for about ${minutes} min.`,
  unknown: "Without a second imaging drone, light is unknown from then on.",
  without: (age: string, area: string) =>
    `No shade map for ${age}: ${area} flown with light unknown.`,
  relieve: (spare: string) => `Relieve by ${spare}`,
  relieveOf: (spare: string, vehicle: string) => `${spare} flies to the place of ${vehicle}`,
  sendBack: (vehicle: string) => `Send ${vehicle} back`,
  sendBackOf: (vehicle: string) => `${vehicle} takes off and flies to its place`,
  stages: {
    to_place: (vehicle: string) => `flies to the place of ${vehicle}`,
    maps: (vehicle: string) => `is at the place of ${vehicle}, waits for its shade maps`,
    done: (vehicle: string) => `has taken the place of ${vehicle}`,
    stopped: (vehicle: string) => `stopped its flight to the place of ${vehicle}`,
  } as Stages<ImagerReliefView>,
  itsOwn: {
    to_place: "flies back to its place",
    maps: "is at its place, waits for its shade maps",
    done: "is back at its place",
    stopped: "stopped its flight back to its place",
  } as Readonly<Partial<Record<ImagerReliefView["stage"], string>>>,
};

/** The scale of the next minutes. */
export const forecast = {
  name: "Sun forecast",
  sunNow: "Sun now",
  sunIn: (time: string) => `Sun in ${time}`,
  ofField: (share: string) => `${share} of the field`,
  rightHint: "How often forecasts of this flight were right",
  right: (share: string) => `${share} correct recently`,
  show: "Show the forecast scale",
  fold: "Collapse the forecast scale",
  time: "Time of the forecast",
  now: "now",
};

export const surveys = {
  name: (survey: string) => `survey ${survey}`,
  noReason: "Refused without a reason.",
  phases: {
    planning: "Planning",
    refused: "Not feasible",
    created: "Planned, not started",
    running: "Running",
    paused: "Paused",
    aborted: "Aborted",
    done: "Complete",
  } satisfies Record<SurveyView["phase"], string>,
  stopped: "Stopped: no drone is flying rows",
  underMinute: "under 1 min left",
  minutesLeft: (minutes: number) => `≈ ${minutes} min left`,
  returnsHome: "returns home",
  fliesRows: "flies rows",
  noRows: "does not fly rows",
  waitsFor: (vehicle: string) => `waits for ${vehicle} to clear its way`,
  why: "Why",
  start: "Start with selected",
  /** After the drone's name; the order is the station's words: `hover, ordered by `. */
  stoppedBy: (order: string, by: string) => `does not fly rows: ${order}${by}. Select it to resume`,
  you: "you",
  add: "Resume or add selected",
  resume: "Resume with selected",
  allowTakeoff: "Allow takeoff for this start",
  stops: { pause: "Pause", abort: "Abort", hold: "Hold returning drones" },
  open: "Open the survey",
  aboveTakeoff: (height: string) => `${height} above takeoff`,
  aboveGround: (height: string) => `${height} above ground`,
  title: "Survey",
  inSun: (percent: number) => `${percent} % in sun`,
  inShade: (percent: number) => `${percent} % in shade`,
  lightUnknown: (percent: number) => `${percent} % light unknown`,
  toFly: (percent: number) => `${percent} % to fly`,
  notShown: (area: string, percent: number) =>
    `${area} (${percent} %) not shown by shade maps: flown once, light unknown.`,
  fewer: "Fewer",
  allDrones: (count: number) => `All ${count} drones`,
};

/** What a planned survey will take. */
export const exports = {
  name: "Export plan",
  unwatched: "For another program to fly. The station neither watches nor stops such a flight.",
  aircraft: "Aircraft, for .kmz",
  choose: "Choose",
  save: (title: string, kind: string) => `${title}: .${kind}`,
  byHand: (count: number) => `To set by hand: ${count}`,
};

export const estimate = {
  unknown: (dash: string) => `Estimate: ${dash}`,
  withOne: "With one drone, each row once:",
  withSelected: "With the selected drones, each row once:",
  draft: (of: { drones: number; time: string; batteries: number | null; photos: number | null }) =>
    [
      `${plural(of.drones, "drone")}: ${of.time}`,
      ...(of.batteries === null
        ? []
        : [of.batteries === 1 ? "1 battery" : `${of.batteries} batteries`]),
      ...(of.photos === null ? [] : [plural(of.photos, "photo")]),
    ].join(" · "),
  time: "Time",
  inAir: "In the air",
  photosOnRows: "Photos on rows",
  photos: "Total photos",
  batteries: "Batteries",
  aboveGround: "Height above ground",
  range: (least: string, most: string) => `${least} to ${most}`,
  pixel: "Pixel on the ground",
  fastest: "Fastest",
};

export const newSurvey = {
  noRegions: "The site has no survey regions.",
  draw: "Draw or import your field",
  title: "New survey",
  region: "Region",
  pixel: "Pixel size, cm",
  bearing: "Row bearing, °",
  front: "Front overlap, %",
  side: "Side overlap, %",
  unknown: "Unknown",
  best: "Automatic",
  height: (unit: string) => `Height, ${unit}`,
  above: "Height above",
  references: {
    takeoff: "Takeoff point",
    ground: "Ground",
    noGround: "Ground (no elevation model)",
  },
  speed: "Speed, m/s",
  camera: "Camera",
  otherCamera: "Other, 66° × 52°",
  interval: "Photo every, s",
  rows: "Rows",
  /** The usual one first. */
  planners: {
    sunlit_first: "Sunlit rows first",
    lawnmower_again: "Repeat until all is in sun",
    lawnmower_once: "All rows once",
  },
  whenDone: "When complete",
  thenDo: { return_home: "Return home", hover: "Hover" } satisfies Record<
    SurveyRequest["when_done"],
    string
  >,
  sideStep: "Imaging drone may side-step automatically",
  upwind: "Imaging drone may move upwind automatically",
  battery: "When the imaging drone's battery ends",
  batteryEnds: { warn: "Warn only", home: "Return it home" },
  spare: (vehicle: string) => `Relieve it by ${vehicle}`,
  plan: "Plan survey",
};
