import { type Accessor, createEffect, createMemo, createSignal, on } from "solid-js";
import type { BaseMapsView, BaseMapView } from "../protocol";
import type { StationSource } from "../source/stationSource";

/** Where a browser keeps choices. */
export type Kept = Pick<Storage, "getItem" | "setItem">;

const STORED_AS = "recon.baseMap";
/** Stored for no map; file names are never empty. */
const NONE = "";

/** The base maps of the site's folder, and the one that is shown. */
export interface BaseMaps {
  /** Those that can be shown and those that cannot; null before the first answer. */
  readonly maps: Accessor<readonly BaseMapView[] | null>;
  /** Why there is no map, or why they are not known; null otherwise. */
  readonly note: Accessor<string | null>;
  /** The map that is shown; null for none. */
  readonly shown: Accessor<BaseMapView | null>;
  /** Shows the map of this name, or none, also after the page is loaded again. */
  choose(name: string | null): void;
  /** Looks for maps that were added or changed. */
  refresh(): Promise<void>;
}

/** The one that shows most of the site first, of several the finest. */
function byCoverage({ covers: one }: BaseMapView, { covers: other }: BaseMapView): number {
  const percent = (share = 0) => Math.round(100 * share);
  const more = percent(other?.share) - percent(one?.share);
  return more !== 0 ? more : (other?.zoom ?? 0) - (one?.zoom ?? 0);
}

/** Until one is chosen in this browser, the one that shows most of the site is. */
export function createBaseMaps(
  source: Pick<StationSource, "maps" | "connection">,
  kept: Kept,
): BaseMaps {
  const [read, setRead] = createSignal<BaseMapsView | null>(null);
  const [problem, setProblem] = createSignal<string | null>(null);
  const [chosen, setChosen] = createSignal(kept.getItem(STORED_AS));
  const refresh = async () => {
    const outcome = await source.maps.list();
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "answered") setRead(outcome.value);
  };
  const isLive = createMemo(() => source.connection().kind === "live");
  createEffect(
    on(isLive, (live) => {
      if (live) void refresh();
    }),
  );
  const shown = () => {
    const usable = (read()?.maps ?? []).filter((map) => map.problem === null);
    const name = chosen();
    if (name === null) return [...usable].sort(byCoverage)[0] ?? null;
    return usable.find((map) => map.name === name) ?? null;
  };
  return {
    maps: () => read()?.maps ?? null,
    note: () => problem() ?? read()?.note ?? null,
    // A new list of the same maps moves nothing on the screen.
    shown: createMemo(shown, null, {
      equals: (one, other) => one?.name === other?.name && one?.version === other?.version,
    }),
    choose: (name) => {
      kept.setItem(STORED_AS, name ?? NONE);
      setChosen(name ?? NONE);
    },
    refresh,
  };
}
