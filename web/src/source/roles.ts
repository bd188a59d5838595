import type { AccessView } from "../protocol";
import { text } from "../text/catalogue";

export type Role = AccessView["role"];

const ROLES: readonly Role[] = ["observer", "pilot", "operator", "admin"];

/**
 * Why a person cannot do what needs a role, or null. The station decides; buttons only show it. Before the
 * person is known nothing is disabled.
 */
export function lacking(person: AccessView | null, needed: Role): string | null {
  if (person === null || ROLES.indexOf(person.role) >= ROLES.indexOf(needed)) return null;
  return text.guard.lacksRole(text.roles[needed], person.name, text.roles[person.role]);
}
