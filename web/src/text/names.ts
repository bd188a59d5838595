import type {
  AlarmView,
  CommandView,
  Phase,
  Severity,
  VehicleView,
  WordResponse,
} from "../protocol";
import type { Outcome } from "../source/stationSource";

const COMMANDS: Readonly<Record<string, string>> = {
  hover: "Hover",
  land: "Land",
  return_home: "Return home",
  camera_start: "Camera on",
  camera_stop: "Camera off",
  mission: "Mission",
  stick: "Stick",
  goto: "Fly here",
  nudge: "Nudge",
  hold_position: "Hold position",
};

/** A command's kind in plain words; an unknown kind stands as the station said it. */
export function commandName(kind: string): string {
  return COMMANDS[kind] ?? plainWords(kind);
}

export const PHASE_NAMES: Readonly<Record<Phase, string>> = {
  queued: "Queued",
  sent: "Sent",
  acknowledged: "Acknowledged",
  confirmed: "Confirmed",
  started: "Started",
  done: "Done",
  refused_by_station: "Refused by station",
  refused_by_app: "Refused by app",
  timed_out: "Timed out",
  superseded: "Superseded",
  expired: "Expired",
  failed: "Failed",
};

/** A note beside a phase. A refusal by the station begins with its rule's name, said here in plain words. */
export function noteText(phase: Phase, note: string): string {
  const match = /^([a-z0-9_]+): (.*)$/s.exec(note);
  if (phase !== "refused_by_station" || match === null) return note;
  const [, rule = "", reason = ""] = match;
  return `rule ${plainWords(rule)}: ${reason}`;
}

export type Tone = "good" | "bad" | "over" | "underway";

const TONES: Readonly<Record<Phase, Tone>> = {
  queued: "underway",
  sent: "underway",
  acknowledged: "underway",
  confirmed: "good",
  started: "underway",
  done: "good",
  refused_by_station: "bad",
  refused_by_app: "bad",
  timed_out: "bad",
  superseded: "over",
  expired: "bad",
  failed: "bad",
};

/** Whether a command went well, badly, is over without either, or is still under way. */
export function phaseTone(command: Pick<CommandView, "phase">): Tone {
  return TONES[command.phase] ?? "underway";
}

export const SEVERITY_NAMES: Readonly<Record<Severity, string>> = {
  critical: "Critical",
  error: "Error",
  warning: "Warning",
  info: "Note",
};

/** An enumeration's word (`AUTO_LANDING`, `auto_landing`) in plain ones (`auto landing`). */
export function plainWords(word: string): string {
  return word.toLowerCase().replaceAll("_", " ");
}

/** A vehicle as every order and alarm names it: its number, then its name. */
export function vehicleLabel(vehicle: Pick<VehicleView, "number" | "name">): string {
  return vehicle.number > 0 ? `${vehicle.number} ${vehicle.name}` : `? ${vehicle.name}`;
}

/** Names joined for a sentence: `a`, `a and b`, `a, b and c`. */
export function listNames(names: readonly string[]): string {
  if (names.length <= 1) return names.join("");
  return `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
}

/** An alarm's text without the vehicle's name before it: where it is shown the name stands already. */
export function alarmText(alarm: Pick<AlarmView, "text" | "vehicle_name">): string {
  const name = `${alarm.vehicle_name}: `;
  const text = alarm.text.startsWith(name) ? alarm.text.slice(name.length) : alarm.text;
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** A refusal as it is read everywhere: the rule by name, then its sentence. */
export function refusalText(rule: string | null, reason: string | null): string {
  const name = rule === null || rule === "" ? "no rule given" : plainWords(rule);
  return `Refused (${name}): ${reason ?? "no reason given"}`;
}

/** Why a word to the station was not taken; null when it was. */
export function wordProblem(outcome: Outcome<WordResponse | null>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  const word = outcome.value;
  return word === null || word.accepted ? null : refusalText(word.rule, word.reason);
}
