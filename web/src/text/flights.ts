import { text } from "./catalogue";

/** When a record was begun, by its name: `2025-06-20 16:00`, UTC; any other name as it is.
 * A record without a flight is marked. */
export function flightTime(name: string): string {
  const found =
    /^(flight|ground|recon)-(\d{4})(\d{2})(\d{2})T(\d{2})(\d{2})\d{2}Z(?:-(\d+))?$/.exec(name);
  if (found === null) return name;
  const [, kind, year, month, day, hour, minute, number] = found;
  const time = `${year}-${month}-${day} ${hour}:${minute}`;
  const numbered = number === undefined ? time : `${time} (${number})`;
  return kind === "ground" ? text.flights.onGround(numbered) : numbered;
}
