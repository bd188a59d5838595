import type { TemporaryZoneView } from "../protocol";
import { formatAge } from "./quantities";
import { formatLength } from "./units";

export type ZoneKind = TemporaryZoneView["kind"];

/** Each kind's name, and the reason that is sent when none is typed. */
export const ZONE_KINDS: Readonly<Record<ZoneKind, { name: string; reason: string }>> = {
  person: { name: "Person", reason: "Person in the field" },
  tractor: { name: "Tractor", reason: "Tractor in the field" },
  crewed_aircraft: { name: "Crewed aircraft", reason: "Crewed aircraft nearby" },
};

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
    return floor_m ? `from ${formatLength(floor_m)} above ground up` : "all heights";
  const from = floor_m ? `${formatLength(floor_m)} to ` : "up to ";
  return `${from}${formatLength(ceiling_m)} above ground`;
}

/** When it ends, `behindS` seconds after the state. */
export function zoneEnd(ends_in_s: number | null, behindS: number): string {
  return ends_in_s === null ? "until ended" : `ends in ${formatAge(ends_in_s - behindS)}`;
}

/** Its label on the map: what, how old in whole minutes, which heights. */
export function zoneLabel(zone: TemporaryZoneView, behindS: number): string {
  const minutes = Math.floor((zone.age_s + behindS) / 60);
  const age = minutes < 1 ? "new" : `${minutes} min`;
  return `${zoneName(zone)}, ${age}: keep out, ${zoneHeights(zone)}`;
}
