import type { AlarmView, Severity } from "../protocol";
import { text } from "../text/catalogue";
import { alarmText, capitalised, plainWords } from "../text/names";
import { severityRank, worstSeverity } from "./severity";

/** Alarms of one cause, shown and acknowledged as one. */
export interface AlarmGroup {
  readonly key: string;
  readonly severity: Severity;
  /** What it is about: a cause with its count, or one vehicle's own text. */
  readonly title: string;
  /** The alarms, worst and newest first. */
  readonly alarms: readonly AlarmView[];
  readonly isActive: boolean;
  readonly isAcknowledged: boolean;
}

/** Whether its cause lasts, and it is more than a note. */
export function isAlarmNow({ is_active, severity }: AlarmView): boolean {
  return is_active && severity !== "info";
}

/** Causes whose every alarm is about two vehicles. */
const PAIRED = ["separation"];

/** Groups alarms by cause and severity, active ones first, then the worst; a group with one alarm keeps that alarm's text. */
export function groupAlarms(alarms: readonly AlarmView[]): AlarmGroup[] {
  const groups = new Map<string, AlarmView[]>();
  for (const alarm of alarms) {
    // What has ended is apart from what lasts, so that an acknowledgement is of one thing.
    const key = [alarm.rule, alarm.severity, alarm.is_active, alarm.is_acknowledged].join();
    groups.set(key, [...(groups.get(key) ?? []), alarm]);
  }
  return [...groups].map(([key, members]) => groupOf(key, members)).sort(byUrgency);
}

function groupOf(key: string, members: readonly AlarmView[]): AlarmGroup {
  const alarms = [...members].sort((a, b) => a.raised_age_s - b.raised_age_s || b.id - a.id);
  const isActive = alarms.some((alarm) => alarm.is_active);
  const isAcknowledged = alarms.every((alarm) => alarm.is_acknowledged);
  const severity = worstSeverity(alarms.map((alarm) => alarm.severity)) ?? "info";
  return {
    key,
    severity,
    title: titleOf(alarms),
    alarms,
    isActive,
    isAcknowledged,
  };
}

function titleOf(alarms: readonly AlarmView[]): string {
  const [only, ...others] = alarms;
  if (only === undefined) return "";
  const subject = only.vehicle_name || text.names.station;
  if (others.length === 0) return `${subject}: ${alarmText(only)}`;
  const names = new Set(alarms.map(({ vehicle_name }) => vehicle_name));
  return counted(only.rule, alarms.length, names.size);
}

function counted(rule: string, alarms: number, vehicles: number): string {
  const cause = causeName(rule);
  if (PAIRED.includes(rule)) return text.alarms.pairs(cause, alarms);
  return vehicles > 1 ? text.alarms.drones(cause, vehicles) : text.alarms.alarms(cause, alarms);
}

/** A cause by the station's rule, as a person names it. */
export function causeName(rule: string): string {
  return text.alarms.causes[rule] ?? capitalised(plainWords(rule));
}

/** Active ones first, then by severity, those not acknowledged, the newest. */
function byUrgency(a: AlarmGroup, b: AlarmGroup): number {
  return (
    Number(b.isActive) - Number(a.isActive) ||
    severityRank(a.severity) - severityRank(b.severity) ||
    Number(a.isAcknowledged) - Number(b.isAcknowledged) ||
    (a.alarms[0]?.raised_age_s ?? 0) - (b.alarms[0]?.raised_age_s ?? 0)
  );
}
