import { type LonLat, metresPerDegree } from "../map/localGrid";
import { text } from "../text/catalogue";
import { formatAge, formatHeading } from "../text/quantities";
import { formatLength } from "../text/units";

/** The straight line from one position to another. */
export interface Course {
  readonly distance_m: number;
  /** Clockwise from north. */
  readonly bearing_deg: number;
  /** At the given speed, without acceleration and braking. */
  readonly time_s: number;
}

/** The course with a climb (negative: descent) of `climb_m` at `speed_mps`. */
export function courseOf(from: LonLat, to: LonLat, climb_m: number, speed_mps: number): Course {
  const per = metresPerDegree((from.lat + to.lat) / 2);
  const east_m = (to.lon - from.lon) * per.lon;
  const north_m = (to.lat - from.lat) * per.lat;
  const distance_m = Math.hypot(east_m, north_m);
  const bearing_deg = ((Math.atan2(east_m, north_m) * 180) / Math.PI + 360) % 360;
  return { distance_m, bearing_deg, time_s: Math.hypot(distance_m, climb_m) / speed_mps };
}

/** `120 m, bearing 045°, about 24 s`. */
export function courseText({ distance_m, bearing_deg, time_s }: Course): string {
  const distance = formatLength(distance_m, distance_m < 10 ? 1 : 0);
  return text.fly.course(distance, formatHeading(bearing_deg), formatAge(Math.ceil(time_s)));
}
