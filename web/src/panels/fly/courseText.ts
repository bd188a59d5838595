import type { Course } from "../../orders/course";
import { formatAge } from "../../words/age";
import { formatHeading, formatQuantity } from "../../words/quantity";

/** `120 m towards 045°, about 24 s`. */
export function courseText({ distance_m, bearing_deg, time_s }: Course): string {
  const far = formatQuantity(distance_m, "m", distance_m < 10 ? 1 : 0);
  return `${far} towards ${formatHeading(bearing_deg)}, about ${formatAge(Math.ceil(time_s))}`;
}
