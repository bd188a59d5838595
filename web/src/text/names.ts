import type {
  ActionResponse,
  AlarmView,
  CommandView,
  Outcome,
  Phase,
  VehicleView,
} from "../protocol";
import { text } from "./catalogue";
import { withLengthUnit } from "./units";

/** A command kind for display; an unknown kind is shown as received. */
export function commandName(kind: string): string {
  return text.orders.kinds[kind] ?? plainWords(kind);
}

/**
 * A person or program for display: `anna (192.168.1.4): survey west` is `anna, survey west`. The address is in
 * the audit; here it would only hide the name.
 */
export function personName(label: string): string {
  return label
    .replace(/ \([^)]*\)/, "")
    .replace(/^api \S+/, text.names.program)
    .replace(": ", ", ");
}

/** A note without the station's order numbers, which no operator knows: `by order 5` is `by a newer order`. */
export function withoutNumbers(note: string): string {
  return withLengthUnit(note)
    .replace(/\bby order -?\d+\b/g, "by a newer order")
    .replace(/\border -?\d+\b/g, "an order");
}

/** Tooltip of a refusal: the safety rule behind its sentence; undefined without one. */
export function ruleTitle(rule: string | null): string | undefined {
  return rule === null ? undefined : text.commands.safetyRule(plainWords(rule));
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

/** An enum value (`AUTO_LANDING`, `auto_landing`) as text (`auto landing`). */
export function plainWords(word: string): string {
  return word.toLowerCase().replaceAll("_", " ");
}

/** A vehicle's label in orders and alarms: its number, then its name; the name alone if it has the number. */
export function vehicleLabel({ number, name }: Pick<VehicleView, "number" | "name">): string {
  if (number > 0 && new RegExp(`(^|\\D)${number}(\\D|$)`).test(name)) return name;
  return number > 0 ? `${number} ${name}` : `? ${name}`;
}

/** The words with their first letter in upper case. */
export function capitalised(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Names as a list in a sentence: `a`, `a and b`, `a, b and c`. */
export function listNames(names: readonly string[]): string {
  return text.names.list(names);
}

/** At most `most` names, then how many more. */
export function listSome(names: readonly string[], most: number): string {
  return text.names.some(names, most);
}

/** An alarm's text without the leading vehicle name, which is shown separately. */
export function alarmText(alarm: Pick<AlarmView, "text" | "vehicle_name">): string {
  const name = `${alarm.vehicle_name}: `;
  const own = alarm.text.startsWith(name) ? alarm.text.slice(name.length) : alarm.text;
  return capitalised(withLengthUnit(own));
}

/** A refusal as text. */
export function refusalText(reason: string | null): string {
  return text.requests.refused(withLengthUnit(reason ?? text.requests.noReason));
}

/** Why a request failed or was refused; null when the station accepted it. */
export function responseProblem(outcome: Outcome<ActionResponse | null>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  const response = outcome.value;
  return response === null || response.accepted ? null : refusalText(response.reason);
}
