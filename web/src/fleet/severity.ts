import type { Severity } from "../protocol";
import { valuesOf } from "../protocol/values";

/** 0 for the worst. */
const RANKS: Readonly<Record<Severity, number>> = { critical: 0, error: 1, warning: 2, info: 3 };

/** Worst first, as everything is listed. */
const SEVERITIES = valuesOf(RANKS);

/** 0 for the worst. */
export function severityRank(severity: Severity): number {
  return RANKS[severity];
}

/** The worst severity; null for an empty list. */
export function worstSeverity(severities: readonly Severity[]): Severity | null {
  return SEVERITIES.find((severity) => severities.includes(severity)) ?? null;
}
