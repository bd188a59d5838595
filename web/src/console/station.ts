import { type Accessor, createMemo } from "solid-js";
import { createFleetView, type FleetView } from "../fleet/fleetView";
import type { ReplayView, Role } from "../protocol";
import type { Clock, Instant } from "../source/clock";
import { lacking } from "../source/roles";
import type { StationSource } from "../source/stationSource";
import { text } from "../text/catalogue";

/** What the station says, and what may be asked of it. */
export interface StationPart {
  readonly source: StationSource;
  /** Clock for hold-to-confirm buttons. */
  readonly clock: Clock;
  /** The newest state as a store; a panel rerenders only where the state changed. */
  readonly fleet: FleetView;
  /** Where a replay stands; null on a live station. */
  readonly replay: Accessor<ReplayView | null>;
  /** Whether this is a replay; changes only when that does. */
  readonly isReplay: Accessor<boolean>;
  /** Why this person cannot do what needs a role; null when nothing is in the way. */
  lacks(needed: Role): string | null;
  /** Seconds to add to every age in the newest state; grows until the next state. */
  readonly behindS: Accessor<number>;
}

/** `now` changes as often as displayed ages are refreshed. */
export function createStationPart(
  source: StationSource,
  clock: Clock,
  now: Accessor<Instant>,
): StationPart {
  const replay = () => source.state()?.replay ?? null;
  const isReplay = createMemo(() => replay() !== null);
  const behindS = createMemo(() => {
    source.state();
    return source.behindS(now()) ?? 0;
  });
  return {
    source,
    clock,
    fleet: createFleetView(source),
    replay,
    isReplay,
    lacks: (needed) => (isReplay() ? text.page.noOrdersInReplay : lacking(source.person(), needed)),
    behindS,
  };
}
