import type { JSX } from "solid-js";
import type { AreaView, LayerName, VehicleView } from "../../protocol";
import { plural } from "./grammar";

/** A draft of the site that is checked and saved as a whole. */
export const draft = {
  save: "Save, in force at once",
  discard: "Discard",
  reload: "Reload",
  undo: "Undo",
  redo: "Redo",
  undoSave: (what: string, person: string) => `Undo last save: ${what}, by ${person}`,
  saveFirst: "Save or discard the changes first",
  noChanges: "No changes.",
  changesNothing: "Nothing changes.",
  cannotSave: "Cannot be saved as it is:",
  notSaved: (reason: string) => `Not saved: ${reason}`,
  notUndone: (reason: string) => `Not undone: ${reason}`,
  editedMeanwhile: "Not loaded again: the draft was edited meanwhile",
  saved: (changed: string | null) => `Saved${withChanges(changed)}`,
  undone: (changed: string | null) => `Undone${withChanges(changed)}`,
  undoneButEdited: (changed: string | null) =>
    `Undone${withChanges(changed)}. This draft was edited meanwhile and still has what was undone`,
};

/** What has changed; empty: nothing; null: unknown. */
function withChanges(changed: string | null): string {
  if (changed === "") return ": nothing changes";
  return `${changed === null ? "" : `: ${changed}`}. In force now`;
}

/** The layers of the site; each as a title, inside a sentence, and in the plural there. */
export const siteLayers = {
  boundary: { name: "Boundary", one: "boundary", many: "boundary" },
  survey_regions: { name: "Survey region", one: "survey region", many: "survey regions" },
  keep_out: { name: "Keep-out zone", one: "keep-out zone", many: "keep-out zones" },
  height_zones: { name: "Height zone", one: "height zone", many: "height zones" },
  landing_pads: { name: "Landing pad", one: "landing pad", many: "landing pads" },
} satisfies Record<LayerName, { name: string; one: string; many: string }>;

export const site = {
  edit: "Edit",
  close: "Close",
  unsaved: "There are changes that are not saved.",
  what: "Boundary, zones, regions and pads are drawn here, or imported.",
  loading: "Loading the site.",
  empty: "Nothing is drawn yet.",
  features: "Features of the site",
  newFeature: "New feature",
  add: "Add",
  draw: "Draw on map",
  atCentre: "At map centre",
  pressPlace: "Press the place on the map. Esc cancels.",
  pressCorners: (layer: string) =>
    `Press the corners of the ${layer} on the map; press the first one again to finish. Esc cancels.`,
  pressHoleCorners:
    "Press the corners of the hole on the map; press the first one again to finish. Esc cancels.",
  holes: (count: number) => plural(count, "hole"),
  save: "Save the site",
  checking: "Checking the drawing.",
  willChange: (changes: string) => `Ready to save. Changes: ${changes}.`,
};

/** The selected feature. */
export const feature = {
  selected: (feature: string) => `Selected: ${feature}`,
  name: "Name",
  floor: "Floor",
  ceiling: "Ceiling",
  datum: "Heights count from",
  datums: { ground: "ground", wgs84: "WGS84 ellipsoid" } satisfies Record<
    NonNullable<AreaView["datum"]>,
    string
  >,
  altitude: "Altitude (WGS84)",
  serial: "Serial of its drone (empty: any)",
  tooManyCorners: (most: number) =>
    `More than ${most} corners: they are changed in the list, not on the map. Simplify the shape in the program it comes from to drag them.`,
  drawHole: "Draw a hole",
  remove: (feature: string) => `Remove ${feature}`,
  place: "Place",
  outline: (corners: number) => `Outline: ${plural(corners, "corner")}`,
  hole: (number: number, corners: number) => `Hole ${number}: ${plural(corners, "corner")}`,
  removeHole: (number: number) => `Remove hole ${number}`,
  cornersAre: "Latitude, longitude, degrees",
  earlier: "Earlier corners",
  later: "Later corners",
  placeField: "Place: latitude, longitude",
  cornerField: (number: number) => `Corner ${number}: latitude, longitude`,
  addCorner: (after: number) => `Add a corner after corner ${after}`,
  addCornerHint: "Add a corner after this one",
  removeCorner: (number: number) => `Remove corner ${number}`,
  removeCornerHint: "Remove this corner",
};

export const imports = {
  name: "Import",
  file: "Import a file",
  formats:
    "KML, KMZ, Shapefile (zip), GeoPackage, GeoJSON, ISOXML, GPX or a flight plan; or drop it here.",
  reading: "Reading the file",
  search: "Find by name",
  excluded: "Excluded",
  closePaths: "Take paths as areas",
  noFences: "Survey regions only: where these shapes are is not known well enough for a fence.",
  choose: "Choose what each becomes. A press on its shape includes or excludes it.",
  list: "Imported features",
  add: (count: number) => `Add ${plural(count, "feature")}`,
  leaveAll: "Exclude all",
  leave: "Exclude",
  unnamed: (number: number) => `Feature ${number}`,
  read: (file: string, count: number) => `${file}: ${count} read`,
  readSome: (file: string, count: number, left: number) =>
    `${file}: ${count} read, ${left} excluded`,
};

/** The site's vehicles as a table. */
export const siteVehicles = {
  loading: "Loading the vehicles.",
  none: "No vehicles are listed.",
  table: "Vehicles of the site",
  vehicle: "Vehicle",
  number: "Number",
  name: "Name",
  reference: "Altitude reference",
  camera: "Camera",
  remove: "Remove",
  references: {
    unset: "Not set: missions are refused",
    takeoff: "Above takeoff",
    wgs84: "WGS84 ellipsoid",
  } satisfies Record<VehicleView["waypoint_altitude"], string>,
  notConnected: "not connected",
  imager: "imaging drone",
  connected: "connected",
  automatic: "auto",
  numberOf: (serial: string) => `Number of ${serial}`,
  nameOf: (serial: string) => `Name of ${serial}`,
  referenceOf: (serial: string) => `Altitude reference of ${serial}`,
  cameraOf: (serial: string) => `Camera of ${serial}`,
  noCamera: "No survey camera",
  removeOf: (serial: string) => `Remove ${serial}`,
  removeHint: "Remove from the site",
  add: "Add a vehicle",
  notListed: "Connected and not listed: missions are refused for them.",
  addOf: (serial: JSX.Element): JSX.Element => ["Add ", serial],
  bySerial: "Vehicle by serial",
  serial: "Serial, as the app shows it",
  isListed: "It is listed already",
  addButton: "Add vehicle",
  save: "Save the vehicles",
  checking: "Checking the vehicles.",
  willChange: (changes: string) => `Ready to save: ${changes}.`,
  changed: (count: number) => plural(count, "vehicle"),
};

export const calibration = {
  noImager: "The site has no imaging drone: give it an [imager] first.",
  freeze: "Freeze a frame",
  freezeOf: (serial: string) => `Freeze a frame of ${serial}`,
  freezeAnother: "Freeze another frame",
  freezeAnotherOf: (serial: string) => `Freeze another frame of ${serial}`,
  frame: "Frozen frame",
  frameView: "Frame, scrolls when enlarged",
  picture: "The frozen frame of the imaging drone",
  point: (point: string) => `${point} on the frame`,
  enlarge: "Enlarge the frame",
  reduce: "Reduce the frame",
  markCentre: "Mark frame centre",
  placeAtCentre: "Place at map centre",
  pressThing: "Press a thing on the frame that can be found on the map.",
  pressFrame: (point: string) => `Press ${point} on the frame.`,
  pressMap: (point: string) => `Press ${point} on the map.`,
  pressNext: (point: string) =>
    `${point}: press the next point on the frame; a press on the map moves ${point}.`,
  points: "Control points",
  useSurveyed: (count: number) => `Use the site's ${plural(count, "surveyed point")}`,
  notOnFrame: "not on the frame yet",
  notOnMap: "not on the map yet",
  remove: (point: string) => `Delete ${point}`,
  place: "Latitude, longitude",
  altitude: "Altitude (WGS84), m",
  onGround: "ground",
  result: "Result",
  completeFirst: (point: string) => `Mark or delete ${point} first`,
  noCamera: "There is no camera by these points yet",
  accept: "Accept and save",
  summary: (rms: string, height: string, tilt: string) =>
    `RMS ${rms} · ${height} above ground · ${tilt} off straight down`,
  saved: "Saved. The next frames are placed by these points",
  frozeMeanwhile: "Another frame was frozen meanwhile; try again",
};
