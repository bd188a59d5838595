import type { AlarmView, Severity } from "../protocol";

/** Worst first, as everything is listed. */
export const SEVERITIES: readonly Severity[] = ["critical", "error", "warning", "info"];

/** 0 for the worst. */
export function severityRank(severity: Severity): number {
  return SEVERITIES.indexOf(severity);
}

/** The worst severity; null for an empty list. */
export function worstSeverity(severities: readonly Severity[]): Severity | null {
  return SEVERITIES.find((severity) => severities.includes(severity)) ?? null;
}

/** Alarms sorted for display: worst first, then unacknowledged, then newest. */
export function sortAlarms(alarms: readonly AlarmView[]): AlarmView[] {
  return [...alarms].sort(
    (a, b) =>
      severityRank(a.severity) - severityRank(b.severity) ||
      Number(a.is_acknowledged) - Number(b.is_acknowledged) ||
      a.raised_age_s - b.raised_age_s ||
      b.id - a.id,
  );
}
