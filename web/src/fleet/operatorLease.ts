import type { AccessView, LeaseView } from "../protocol";

/**
 * The lease of another person than this page's, or null. Before the page knows its own person every lease
 * counts as another's: shown once too often, never hidden.
 */
export function anothersLease(
  lease: LeaseView | null,
  person: AccessView | null,
): LeaseView | null {
  return lease !== null && lease.person !== person?.name ? lease : null;
}
