import type { StationState } from "../protocol";

/** What the station sends instead of a whole state: its format is in `api/state_changes.py`. */
export interface StateChange {
  readonly since: number;
  readonly time_ns: number;
  readonly state: unknown;
}

type Members = Record<string, unknown>;

export function isStateChange(value: object): value is StateChange {
  return "since" in value;
}

/** A change put on its base; null when it is the change of another state, or none at all. */
export function changedState(base: StationState, change: StateChange): unknown {
  if (change.since !== base.time_ns || !isMembers(change.state)) return null;
  const grownMs = wholeMs(change.time_ns) - wholeMs(base.time_ns);
  const state = itemAfter(base, change.state, grownMs);
  return isMembers(state) ? { ...state, time_ns: change.time_ns } : null;
}

/** Nanoseconds since an epoch exceed what a number holds exactly, by less than a microsecond. */
const wholeMs = (timeNs: number) => Math.floor(timeNs / 1e6);

/** Ages of one item: those in `renewed` have become another, all others have grown. */
class Ages {
  constructor(
    readonly grownMs: number,
    private readonly renewed: ReadonlyMap<number, number>,
  ) {}

  after(wasS: number): number {
    const wasMs = Math.round(wasS * 1e3);
    return (this.renewed.get(wasMs) ?? wasMs + this.grownMs) / 1e3;
  }
}

function itemAfter(was: unknown, change: unknown, grownMs: number): unknown {
  const renewed = isMembers(change) && Array.isArray(change["@"]) ? change["@"] : [];
  return valueAfter(was, change, new Ages(grownMs, new Map(renewed)));
}

function valueAfter(was: unknown, change: unknown, ages: Ages): unknown {
  if (change !== undefined && !isMembers(change)) return change;
  if (change !== undefined && "=" in change) return change["="];
  if (Array.isArray(was)) return arrayAfter(was, change, ages.grownMs);
  return isMembers(was) ? membersAfter(was, change, ages) : was;
}

function arrayAfter(was: unknown[], change: Members | undefined, grownMs: number): unknown[] {
  const tail = change?.["+"];
  if (Array.isArray(tail)) return [...was.slice(-Number(tail[0])), ...tail.slice(1)];
  // Points and names have no ages; an array's items are all of one kind.
  if (!isMembers(was[0])) return was;
  const items = change?.["#"] as Members | undefined;
  return was.map((item, number) => itemAfter(item, items?.[number], grownMs));
}

/** The object with its changes and older ages; itself where nothing has changed. */
function membersAfter(was: Members, change: Members | undefined, ages: Ages): Members {
  let after: Members | null = null;
  for (const name in was) {
    const value = was[name];
    const given = change?.[name];
    const isAge = given === undefined && typeof value === "number" && name.endsWith("age_s");
    const next = isAge ? ages.after(value) : valueAfter(value, given, ages);
    if (next === value) continue;
    after ??= { ...was };
    after[name] = next;
  }
  return after ?? was;
}

function isMembers(value: unknown): value is Members {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
