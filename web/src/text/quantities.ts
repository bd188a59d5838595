import { text } from "./catalogue";

/** Shown for an unknown value; never a zero. */
export const UNKNOWN = "—";

/** An age in seconds as text: `0.2 s`, `12 s`, `3 min 20 s`, `2 h 5 min`. */
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

/** An age in the station's message plus the time since that message, seconds. */
export function agedBy(ageS: number | null, behindS: number): number | null {
  return ageS === null ? null : ageS + behindS;
}

const MINUS = "\u2212";

/** A number with its unit, such as `12.3 m`; a dash when unknown. */
export function formatQuantity(value: number | null, unit: string, digits = 1): string {
  if (value === null || !Number.isFinite(value)) return UNKNOWN;
  const text = value.toFixed(digits).replace("-", MINUS);
  const isNegativeZero = Number(value.toFixed(digits)) === 0;
  const shown = isNegativeZero ? text.replace(MINUS, "") : text;
  return unit === "" ? shown : `${shown}\u00a0${unit}`;
}

/** A fraction as whole per cent, rounded down so that a battery never reads too full. */
export function formatFraction(fraction: number | null): string {
  if (fraction === null || !Number.isFinite(fraction)) return UNKNOWN;
  // The small addition keeps 0.29 x 100 = 28.999... at 29.
  return `${Math.floor(fraction * 100 + 1e-6)}\u00a0%`;
}

/** Degrees clockwise from north, `000°` to `359°`. */
export function formatHeading(degrees: number | null): string {
  if (degrees === null || !Number.isFinite(degrees)) return UNKNOWN;
  const whole = ((Math.round(degrees) % 360) + 360) % 360;
  return `${String(whole).padStart(3, "0")}°`;
}

/** Speed over ground from its north and east parts, metres per second. */
export function groundSpeedMps(north: number | null, east: number | null): number | null {
  return north === null || east === null ? null : Math.hypot(north, east);
}

/** Why a value is unknown, given the age in seconds of the message that carries it. */
export function unknownReason(ageS: number | null): string {
  return ageS === null ? text.facts.notReceived : text.facts.notValid;
}

/** A byte count in B, kB, MB or GB. */
export function formatBytes(count: number): string {
  if (count < 1000) return `${count} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(1)} kB`;
  if (count < 1e9) return `${(count / 1e6).toFixed(1)} MB`;
  return `${(count / 1e9).toFixed(2)} GB`;
}
