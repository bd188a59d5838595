import type {
  ActionResponse,
  AlarmView,
  CommandView,
  Phase,
  Severity,
  VehicleView,
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

/** A command kind for display; an unknown kind is shown as received. */
export function commandName(kind: string): string {
  return COMMANDS[kind] ?? plainWords(kind);
}

/**
 * A person or program for display: `anna (192.168.1.4): survey west` is `anna, survey west`. The address is in
 * the audit; here it would only hide the name.
 */
export function personName(label: string): string {
  return label
    .replace(/ \([^)]*\)/, "")
    .replace(/^api \S+/, "a program")
    .replace(": ", ", ");
}

/** A note without the station's order numbers, which no operator knows: `by order 5` is `by a newer order`. */
export function withoutNumbers(note: string): string {
  return note
    .replace(/\bby order -?\d+\b/g, "by a newer order")
    .replace(/\border -?\d+\b/g, "an order");
}

export const PHASE_NAMES: Readonly<Record<Phase, string>> = {
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

/** Tooltip of a refusal: the safety rule behind its sentence; undefined without one. */
export function ruleTitle(rule: string | null): string | undefined {
  return rule === null ? undefined : `Safety rule: ${plainWords(rule)}`;
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

/** How a phase is coloured: good, bad, over (ended without success or failure) or underway. */
export function phaseTone(command: Pick<CommandView, "phase">): Tone {
  return TONES[command.phase] ?? "underway";
}

export const SEVERITY_NAMES: Readonly<Record<Severity, string>> = {
  critical: "Critical",
  error: "Error",
  warning: "Warning",
  info: "Note",
};

/** An enum value (`AUTO_LANDING`, `auto_landing`) as text (`auto landing`). */
export function plainWords(word: string): string {
  return word.toLowerCase().replaceAll("_", " ");
}

/** A vehicle's label in orders and alarms: its number, then its name. */
export function vehicleLabel(vehicle: Pick<VehicleView, "number" | "name">): string {
  return vehicle.number > 0 ? `${vehicle.number} ${vehicle.name}` : `? ${vehicle.name}`;
}

/** The text with its first letter in upper case. */
export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Names as a list in a sentence: `a`, `a and b`, `a, b and c`. */
export function listNames(names: readonly string[]): string {
  if (names.length <= 1) return names.join("");
  return `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
}

/** At most `most` names, then how many more. */
export function listSome(names: readonly string[], most: number): string {
  if (names.length <= most) return listNames(names);
  return `${names.slice(0, most).join(", ")} and ${names.length - most} more`;
}

/** A count with its noun: `1 drone`, `20 drones`. */
export function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

/** An alarm's text without the leading vehicle name, which is shown separately. */
export function alarmText(alarm: Pick<AlarmView, "text" | "vehicle_name">): string {
  const name = `${alarm.vehicle_name}: `;
  const text = alarm.text.startsWith(name) ? alarm.text.slice(name.length) : alarm.text;
  return capitalised(text);
}

/** A refusal as text. */
export function refusalText(reason: string | null): string {
  return `Refused: ${reason ?? "no reason given"}`;
}

/** Why a request failed or was refused; null when the station accepted it. */
export function responseProblem(outcome: Outcome<ActionResponse | null>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  const response = outcome.value;
  return response === null || response.accepted ? null : refusalText(response.reason);
}
