import type { Role, Severity } from "../../protocol";
import { listNames, listSome, plural } from "./grammar";

export const page = {
  vehicles: "Vehicles",
  panels: "Panels",
  product: "Recon",
  alarmsTitle: (count: number) => `${count} ${count === 1 ? "ALARM" : "ALARMS"} · Recon`,
  enterSelects: (number: number) => `Enter selects ${number}`,
  replayTitle: (product: string) => `REPLAY · ${product}`,
  noOrdersInReplay: "This is a replay: no orders are possible",
};

/** How names stand in sentences. */
export const names = {
  list: listNames,
  some: listSome,
  /** A program in place of a person. */
  program: "a program",
  station: "Station",
  link: (id: number | string) => `link ${id}`,
  unknownLink: "unknown",
};

export const panels = {
  titles: {
    vehicle: "Vehicle details",
    alarms: "Alarms",
    survey: "Survey",
    cameras: "Cameras",
    sun: "Imaging drone",
    zones: "Temporary zones",
    site: "Edit site",
    vehicles: "Site vehicles",
    calibration: "Calibrate camera",
    return: "Return in layers",
    orders: "Orders",
    timeline: "Timeline",
    links: "Links",
    photos: "Photos",
    flights: "After the flight",
    station: "Station and site",
  },
  close: (title: string) => `Close ${title}`,
  noData: "No data from the station yet.",
};

export const lock = {
  name: "Locked",
  how: "Touches and keys do nothing but all stop and alarms.",
  lock: "Lock the page",
  hint: "Guard the page against stray touches; all stop and alarms stay usable",
  unlock: "Unlock",
};

export const severity = {
  ok: "OK",
  names: {
    critical: "Critical",
    error: "Error",
    warning: "Warning",
    info: "Note",
  } satisfies Record<Severity, string>,
};

export const roles = {
  observer: "observer",
  pilot: "pilot",
  operator: "operator",
  admin: "admin",
} satisfies Record<Role, string>;

export const guard = {
  replay: "replay",
  needs: (role: string) => `needs ${role}`,
  hold: (time: string) => `hold ${time}`,
  holdBriefly: "hold briefly",
  lacksRole: (needed: string, person: string, role: string) =>
    `Needs the role ${needed}; ${person} has ${role}`,
};

export const bar = {
  alarms: (count: number) => plural(count, "alarm"),
  /** Beside the count, where there is room. */
  alarmsWord: (count: number) => (count === 1 ? "alarm" : "alarms"),
  allMuted: "all muted",
  muted: (causes: readonly string[]) => `muted: ${causes.join(", ")}`,
  simulation: "Simulation",
  mixed: "Real and simulated mixed",
  shadows: (speed: string, heading: string) => `Shadows ${speed} from ${heading}`,
  help: "Help",
  helpHint: "Keys and orders (?)",
  changeColours: (theme: string) => `Colours: ${theme.toLowerCase()}. Change`,
  coloursHint: (theme: string) => `Colours: ${theme.toLowerCase()} (T: bright sun)`,
};

export const menu = {
  name: "Menu",
  hint: "Panels, colours, help",
  help: "Keys and orders",
  units: "Units",
  lengthUnits: { m: "Metres", ft: "Feet" },
  colours: "Colours",
  themes: {
    auto: "As the computer",
    light: "Light",
    dark: "Dark",
    sun: "Bright sun",
  },
};

export const help = {
  name: "Help",
  keys: "Keys",
  shortcuts: [
    { keys: "Shift + S", action: "ALL STOP: all flying vehicles hold position" },
    { keys: "Alt + Shift + S", action: "ALL STOP from everywhere, also while typing text" },
    { keys: "Shift + H", action: "Hover the selected vehicles" },
    { keys: "Hold Shift + R", action: "Return the selected vehicles home (1.5 s)" },
    { keys: "Hold Shift + L", action: "Land the selected vehicles (1.5 s)" },
    { keys: "1 to 9", action: "Select only that vehicle" },
    { keys: "Shift + 1 to 9", action: "Add that vehicle to the selection, or remove it" },
    { keys: "17 Enter", action: "Select that vehicle by its number; with Shift, add or remove it" },
    { keys: "Ctrl + A", action: "Select all vehicles" },
    { keys: "Shift + drag", action: "Add the vehicles in a box on the map to the selection" },
    { keys: "G", action: "Fly here: set a target on the map for the selected vehicle" },
    { keys: "M", action: "Draw a mission on the map for the selected vehicle" },
    { keys: "D", action: "Details of the selected vehicle" },
    {
      keys: "Z",
      action: "Draw a temporary zone on the map: a person, a tractor, a crewed aircraft",
    },
    {
      keys: "Esc",
      action:
        "Clear the target or the drawn zone, leave the mode, clear the selection; cancels a held order",
    },
    { keys: "Ctrl + Z, Ctrl + Y", action: "Undo or redo an edit of the site" },
    { keys: "F", action: "Show everything on the map" },
    { keys: "T", action: "High contrast for bright sun, on or off" },
    { keys: "Space", action: "Play or pause a replay" },
    { keys: "?", action: "Show this help" },
  ],
  orders: "Orders",
  ordersText: [
    "Hover, return home and land are sent to the selected vehicles only. Hover takes one press. Hold the others until the bar is full; releasing early, sliding off or changing the selection cancels the order. None of these makes a vehicle take off; Take off does, for those selected on the ground.",
    "Return home climbs to the aircraft's go-home height first. Return in layers flies each vehicle home at a separate height. Fly here shows the safety gate's result before you confirm; the vehicle holds the target while this page stays open and stops if it closes.",
    "ALL STOP takes one press. All flying vehicles hold position; motors stay on. It stays in force: only hover, return and land are sent until the vehicles are released. The pilot's sticks always override the station.",
  ],
  heights: "Heights",
  heightsText:
    "ATO is above the vehicle's own takeoff point. Other heights name their datum in full. The menu has metres or feet for heights and distances. The station writes metres, with feet behind them if these are chosen; the site's editor is in metres.",
  close: "Close",
};
