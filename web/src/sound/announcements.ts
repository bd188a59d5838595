import type { AlarmGroup } from "../fleet/alarmGroups";
import { severityRank } from "../fleet/severity";
import type { Severity } from "../protocol";
import { text } from "../text/catalogue";

/**
 * Which alarm is announced when, by tone and speech.
 *
 * A cause (a group of alarms of one rule and severity) is new when it appears, active and not acknowledged. It is
 * gathered for a moment, so that 31 pairs that come too close are one announcement, and then announced once with its
 * title. It is announced again when alarms were added, at most every `AGAIN_MS`, and a critical one every `REPEAT_MS`
 * until it ends or is acknowledged. A cause that has just ended is remembered for `AGAIN_MS`, so that one that comes
 * and goes does not sound each time.
 *
 * One announcement at a time: new causes before repeated ones, the worst first, `GAP_MS` apart. A more severe one
 * interrupts. Nothing is queued: what is announced next is decided when there is time for it, from the alarms as they
 * are then.
 */

/** Alarms of one cause come within one or two checks of the station, ten a second. */
export const GATHER_MS = 400;
export const AGAIN_MS = 10_000;
export const REPEAT_MS = 15_000;
/** A tone and the time to tell it from the next. */
export const GAP_MS = 2500;
/** Speech longer than this is taken for ended: some browsers never report the end. */
export const LONGEST_SPEECH_MS = 8000;

/** Causes to announce; muted ones, notes, ended and acknowledged ones are not among them. */
export type AudibleCause = Pick<AlarmGroup, "key" | "severity" | "title" | "alarms">;

export interface Announcement {
  readonly severity: Severity;
  readonly text: string;
  /** Whether it ends the speech before it. */
  readonly interrupts: boolean;
}

interface Cause {
  readonly since_ms: number;
  readonly given: { readonly at_ms: number; readonly ids: readonly number[] } | null;
}

export interface Announcer {
  readonly causes: ReadonlyMap<string, Cause>;
  readonly last: { readonly at_ms: number; readonly severity: Severity } | null;
}

export const SILENT: Announcer = { causes: new Map(), last: null };

/** One step: the announcement to begin now, if any. `groups` come worst first. */
export function announce(
  before: Announcer,
  groups: readonly AudibleCause[],
  isSpeaking: boolean,
  now_ms: number,
): readonly [Announcer, Announcement | null] {
  const causes = new Map<string, Cause>();
  for (const [key, cause] of before.causes)
    if (cause.given !== null && now_ms - cause.given.at_ms < AGAIN_MS) causes.set(key, cause);
  for (const { key } of groups)
    causes.set(key, before.causes.get(key) ?? { since_ms: now_ms, given: null });

  const reasons = groups.map((group) => [group, dueReason(group, causes, now_ms)] as const);
  const [next] =
    reasons.find(([, reason]) => reason === "new") ??
    reasons.find(([, reason]) => reason === "repeated") ??
    [];
  if (next === undefined || !mayBegin(next.severity, before.last, isSpeaking, now_ms))
    return [{ ...before, causes }, null];
  const ids = next.alarms.map(({ id }) => id);
  causes.set(next.key, { since_ms: now_ms, given: { at_ms: now_ms, ids } });
  const last = { at_ms: now_ms, severity: next.severity };
  const announcement = { severity: next.severity, text: next.title, interrupts: isSpeaking };
  return [{ causes, last }, announcement];
}

function dueReason(
  { key, severity, alarms }: AudibleCause,
  causes: ReadonlyMap<string, Cause>,
  now_ms: number,
): "new" | "repeated" | null {
  const cause = causes.get(key);
  if (cause === undefined) return null;
  const { since_ms, given } = cause;
  if (given === null) return now_ms - since_ms >= GATHER_MS ? "new" : null;
  const waited_ms = now_ms - given.at_ms;
  const hasMore = alarms.some(({ id }) => !given.ids.includes(id));
  if (hasMore && waited_ms >= AGAIN_MS) return "new";
  return severity === "critical" && waited_ms >= REPEAT_MS ? "repeated" : null;
}

function mayBegin(
  severity: Severity,
  last: Announcer["last"],
  isSpeaking: boolean,
  now_ms: number,
): boolean {
  if (last === null || severityRank(severity) < severityRank(last.severity)) return true;
  const waited_ms = now_ms - last.at_ms;
  return waited_ms >= (isSpeaking ? LONGEST_SPEECH_MS : GAP_MS);
}

/** So much is spoken of a text that may come from a vehicle. */
const LONGEST_TEXT = 160;

/** A title as it is spoken: units as words, nothing that a voice could take for markup. */
export function spokenText(title: string): string {
  return title
    .replace(/[<>&]/g, " ")
    .replace(/(\d)[ \u00a0](m\/s|ft|[ms%])(?![\w/])/g, (_, digit, unit) => {
      return text.sound.units[unit]?.(digit) ?? `${digit} ${unit}`;
    })
    .replace(/\s+/g, " ")
    .trim()
    .slice(0, LONGEST_TEXT);
}
