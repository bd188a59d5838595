import type { AreaView, ZoneKind } from "../../protocol";
import { listSome, plural } from "./grammar";

export const map = {
  name: "Map",
  fit: "Fit",
  fitHint: "Show everything (F)",
  band: "Select by dragging",
  bandHint: "Add the vehicles in a box to the selection (Shift and drag)",
  zoomIn: "Zoom in",
  zoomOut: "Zoom out",
  northArrow: "N ↑",
  northHint: "North is up",
  base: (map: string) => `Map: ${map}`,
  unplaced: (vehicles: string) => `Position unknown, not on the map: ${vehicles}`,
  vehicle: (vehicle: string, activity: string) => `vehicle ${vehicle}, ${activity}`,
  simulatedVehicle: (vehicle: string, activity: string) =>
    `simulated vehicle ${vehicle}, ${activity}`,
  manyOut: (count: number) => `${count}×`,
  outOfSight: (vehicles: readonly string[]) =>
    vehicles.length > 1
      ? `${vehicles.length}× out of sight: ${listSome(vehicles, 3)}. Move the map there`
      : `Out of sight: ${listSome(vehicles, 1)}. Move the map there`,
  cluster: (count: number) => `${count} vehicles: zoom in`,
  old: (age: string) => `${age} old`,
  onGround: "on ground",
  holdingHere: (vehicle: string, height: string) => `${vehicle} holding here, ↥ ${height}`,
  flyingHere: (vehicle: string, height: string) => `${vehicle} flying here, ↥ ${height}`,
  padSign: "H",
  padOfAny: (pad: string) => `${pad}: any vehicle`,
  padOf: (pad: string, vehicle: string) => `${pad}: reserved for ${vehicle}`,
  pad: (pad: string) => `Landing pad ${pad}`,
  /** Read after the pad's sign. */
  padRead: (pad: string) => `: landing pad ${pad}`,
  areas: {
    boundary: "Boundary",
    keep_out: "Keep out",
    height: "Height limit",
    survey: "Survey",
  } satisfies Record<AreaView["kind"], string>,
  aboveGround: "above ground",
  wgs84: "WGS84",
  upTo: (height: string, datum: string) => `up to ${height} ${datum}`,
  from: (height: string, datum: string) => `from ${height} ${datum}`,
  fromTo: (floor: string, ceiling: string, datum: string) => `${floor} to ${ceiling} ${datum}`,
};

export const groundImage = {
  none: "No ground image yet",
  loading: "Loading ground image",
  old: "old",
  image: (caption: string) => `Ground image: ${caption}`,
  notAligned: "not aligned",
  lost: "alignment lost: positions may be off by metres",
  aligned: "aligned",
  alignedTo: (distance: string) => `aligned to ${distance}`,
};

export const layers = {
  name: "Map and overlay",
  overlay: "Map overlay",
  ato: "Heights: ATO is above the takeoff point.",
  overlays: {
    none: "No overlay",
    shade: "Shade now",
    forecast: "Sun forecast",
    cells: "Coverage",
  },
  legend: "Legend",
  sun: "sun",
  shade: "shade",
  unknown: "not known",
  estimated: "not known: an estimate",
  inSun: "photographed in sun",
  inShade: "photographed in shade",
  lightUnknown: "photographed, light unknown",
  map: "Map",
  none: "None",
  looking: "Looking for maps",
  coverageUnknown: (from: number, to: number) =>
    `zoom ${from} to ${to}; what it covers of the site is not known`,
  coversNothing: "covers nothing of the site",
  covers: (share: string, zoom: number, pixel: string) =>
    `covers ${share} of the site to zoom ${zoom} (${pixel} a pixel)`,
  lessThanOne: "less than 1 %",
};

/** The light at the place pointed at, and when it changes. */
export const sunHere = {
  here: (light: string) => `Here: ${light}`,
  unknown: "light unknown",
  inSun: "in sun",
  inShade: "in shade",
  shadeIn: (time: string, early: string, late: string) =>
    `in sun; shade in about ${time} (${early} to ${late})`,
  sunIn: (time: string, early: string, late: string) =>
    `in shade; sun in about ${time} (${early} to ${late})`,
  noShade: (time: string) => `in sun; no shade within ${time}`,
  noSun: (time: string) => `in shade; no sun within ${time}`,
  maybeShade: (chance: string, time: string) => `in sun; shade with ${chance} within ${time}`,
  maybeSun: (chance: string, time: string) => `in shade; sun with ${chance} within ${time}`,
  soon: "less than 10 s",
};

export const zones = {
  drawHint: "Keep drones out of a place at once (Z)",
  draw: "Draw a zone",
  cancel: "Cancel",
  none: "No temporary zone is in force.",
  kinds: {
    person: { name: "Person", reason: "Person in the field" },
    tractor: { name: "Tractor", reason: "Tractor in the field" },
    crewed_aircraft: { name: "Crewed aircraft", reason: "Crewed aircraft nearby" },
  } satisfies Record<ZoneKind, { name: string; reason: string }>,
  upFrom: (floor: string) => `from ${floor} above ground up`,
  allHeights: "all heights",
  upTo: (ceiling: string) => `up to ${ceiling} above ground`,
  between: (floor: string, ceiling: string) => `${floor} to ${ceiling} above ground`,
  untilEnded: "until ended",
  endsIn: (time: string) => `ends in ${time}`,
  new: "new",
  label: (zone: string, age: string, heights: string) => `${zone}, ${age}: keep out, ${heights}`,
  drawn: (age: string, person: string, end: string) => `${age} ago by ${person}, ${end}`,
  end: "End zone",
  endOf: (zone: string) => `${zone}, flights may enter it again`,
  form: "Draw a temporary zone",
  useCentre: "Use map centre",
  undoCorner: "Undo corner",
  kind: "Kept clear for",
  shape: "Shape",
  circle: "Circle",
  outline: "Outline",
  radius: (unit: string) => `Radius, ${unit}`,
  minutes: "Minutes (empty: until ended)",
  reason: "Reason",
  go: "Keep clear now",
  pressCentre: "Press the centre on the map.",
  moveCentre: "Press again to move the centre.",
  pressCorners: (left: number) => `Press the corners on the map: ${left} more at least.`,
  corners: (count: number) => `${plural(count, "corner")}. Press the map for more.`,
};
