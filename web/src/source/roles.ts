import type { AccessView, Role } from "../protocol";
import { text } from "../text/catalogue";

/** Each role may do what those below it may. */
const RANKS: Readonly<Record<Role, number>> = { observer: 0, pilot: 1, operator: 2, admin: 3 };

/**
 * Why a person cannot do what needs a role, or null. The station decides; buttons only show it. Before the
 * person is known nothing is disabled.
 */
export function lacking(person: AccessView | null, needed: Role): string | null {
  if (person === null || RANKS[person.role] >= RANKS[needed]) return null;
  return text.guard.lacksRole(text.roles[needed], person.name, text.roles[person.role]);
}
