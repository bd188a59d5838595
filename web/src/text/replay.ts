/** Seconds as `4:05`, or as `1:04:05` from an hour on. */
export function formatPosition(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const pad = (value: number) => String(value).padStart(2, "0");
  const minutes = Math.floor(whole / 60);
  const rest = pad(whole % 60);
  return minutes < 60
    ? `${minutes}:${rest}`
    : `${Math.floor(minutes / 60)}:${pad(minutes % 60)}:${rest}`;
}

/** The local time of day of a moment, in 24 hours. */
export function formatTimeOfDay(unixMs: number): string {
  return new Date(unixMs).toLocaleTimeString("en-GB");
}

/** The local time of day of a moment to the minute. */
export function formatMinuteOfDay(unixMs: number): string {
  return new Date(unixMs).toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit" });
}

/** The local date of a moment. */
export function formatDay(unixMs: number): string {
  return new Date(unixMs).toLocaleDateString("en-GB", {
    day: "numeric",
    month: "short",
    year: "numeric",
  });
}
