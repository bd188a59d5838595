import type { TemporaryZoneView } from "../protocol";
import { text } from "./catalogue";
import { formatAge } from "./quantities";
import { formatLength } from "./units";

/** Each kind's name, and the reason that is sent when none is typed. */
export const ZONE_KINDS = text.zones.kinds;

/** A zone's name, such as "Person 3". */
export function zoneName({ kind, id }: Pick<TemporaryZoneView, "kind" | "id">): string {
  return `${ZONE_KINDS[kind].name} ${id}`;
}

/** The heights that are kept clear. */
export function zoneHeights({
  floor_m,
  ceiling_m,
}: Pick<TemporaryZoneView, "floor_m" | "ceiling_m">): string {
  if (ceiling_m === null)
    return floor_m ? text.zones.upFrom(formatLength(floor_m)) : text.zones.allHeights;
  const ceiling = formatLength(ceiling_m);
  return floor_m ? text.zones.between(formatLength(floor_m), ceiling) : text.zones.upTo(ceiling);
}

/** When it ends, `behindS` seconds after the state. */
export function zoneEnd(ends_in_s: number | null, behindS: number): string {
  if (ends_in_s === null) return text.zones.untilEnded;
  return text.zones.endsIn(formatAge(ends_in_s - behindS));
}

/** Its label on the map: what, how old in whole minutes, which heights. */
export function zoneLabel(zone: TemporaryZoneView, behindS: number): string {
  const minutes = Math.floor((zone.age_s + behindS) / 60);
  const age = minutes < 1 ? text.zones.new : `${minutes} min`;
  return text.zones.label(zoneName(zone), age, zoneHeights(zone));
}
