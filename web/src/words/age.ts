/** What stands where nothing is known; never a zero. */
export const UNKNOWN = "—";

/** An age as people say it: `0.2 s`, `12 s`, `3 min 20 s`, `2 h 5 min`. */
export function formatAge(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return UNKNOWN;
  const age = Math.max(0, seconds);
  if (age < 9.95) return `${age.toFixed(1)} s`;
  if (age < 59.5) return `${Math.round(age)} s`;
  const whole = Math.round(age);
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  const minutes = Math.floor(whole / 60);
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** An age in the station's message, brought to the present. */
export function agedBy(ageS: number | null, behindS: number): number | null {
  return ageS === null ? null : ageS + behindS;
}
