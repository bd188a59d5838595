import type { Map as MapLibre } from "maplibre-gl";
import { type Accessor, createEffect, createMemo, on, onCleanup, onMount } from "solid-js";
import { useMapModes, useSiteEditing, useStation } from "../console";
import type { Box } from "./localGrid";
import { type DraftShapes, wholeView } from "./scene";
import { middleOf, paddingOf } from "./uncovered";

/** Nothing is fitted into a smaller part of the map: only a wide land would be in it. */
const LEAST_ROOM_PX = 120;

/** What of the land is in view. */
export interface MapCamera {
  /** Shows everything. */
  fit(): void;
  /** A move by a person: the view stays as it is then. */
  byHand(move: () => void): void;
}

/** The parts of the page that the map lies in: all of it, and what nothing covers. */
export interface MapParts {
  readonly holder: HTMLElement;
  readonly free: HTMLElement;
}

/**
 * Fits the view to everything: when there is first something, when it is asked for, and, until a person moves the map,
 * when the free part of it changes, unless a press on the map would then mean another place.
 */
export function createMapCamera(
  map: Accessor<MapLibre | null>,
  parts: () => MapParts,
  draft: Accessor<DraftShapes | null>,
  isAiming: Accessor<boolean>,
): MapCamera {
  const { source } = useStation();
  const { fitRequests } = useMapModes();
  const { siteDraft } = useSiteEditing();
  const whole = createMemo<Box | null>(() => {
    const state = source.state();
    return state === null ? null : wholeView(state, draft());
  });
  let isFitted = false;
  let hasFitted = false;
  const fit = (isFirst: boolean) => {
    const [box, shown] = [whole(), map()];
    if (box === null || shown === null) return;
    const { holder, free } = parts();
    const moves = { maxZoom: 19, animate: !isFirst, duration: 400 };
    const options = { ...moves, padding: paddingOf(holder, free) };
    shown.fitBounds([box.west, box.south, box.east, box.north], options);
    isFitted = true;
  };
  onMount(() => {
    const { free } = parts();
    const room = new ResizeObserver(() => {
      const isEnough = Math.min(free.clientWidth, free.clientHeight) >= LEAST_ROOM_PX;
      if (isFitted && isEnough && !isAiming()) fit(false);
    });
    room.observe(free);
    onCleanup(() => room.disconnect());
  });
  createEffect(() => {
    map()?.on("movestart", ({ originalEvent }) => {
      if (originalEvent !== undefined) isFitted = false;
    });
  });
  createEffect(on(fitRequests, () => fit(false), { defer: true }));
  // What was imported may be anywhere.
  createEffect(on(siteDraft.imported, (read) => read.length > 0 && fit(false), { defer: true }));
  createEffect(() => {
    if (hasFitted || map() === null || whole() === null) return;
    hasFitted = true;
    fit(true);
  });
  return {
    fit: () => fit(false),
    byHand: (move) => {
      isFitted = false;
      move();
    },
  };
}

/** The middle of what nothing covers, where an order goes, and the width in view around it. */
export function centreOf(map: MapLibre, { holder, free }: MapParts) {
  const [x, y] = middleOf(holder, free);
  const half_px = free.clientWidth / 2;
  const { lng: lon, lat } = map.unproject([x, y]);
  const width_m = map.unproject([x - half_px, y]).distanceTo(map.unproject([x + half_px, y]));
  return { lon, lat, width_m };
}
