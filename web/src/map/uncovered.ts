import type { Map as MapLibre } from "maplibre-gl";
import { type Frame, meets } from "./labels";

/** What stands over the map: panels, notes and buttons. */
const OVER_THE_MAP = ".card, .map-tools .button, .map-notes > *";

/** The map's window and what stands over it, in pixels of the map. */
export interface Uncovered {
  readonly window: Frame;
  readonly covers: readonly Frame[];
  /** The part that no panel covers, without its tools and notes. */
  readonly room: Frame;
}

/** Measures what of the map is in sight now. */
export function uncoveredOf(map: HTMLElement): Uncovered {
  const { left: x, top: y, width, height } = map.getBoundingClientRect();
  const frameOf = (element: Element): Frame => {
    const { left, top, right, bottom } = element.getBoundingClientRect();
    return { left: left - x, top: top - y, right: right - x, bottom: bottom - y };
  };
  const window = { left: 0, top: 0, right: width, bottom: height };
  const [free, tools, notes] = [".map-free", ".map-tools", ".map-notes"].map((part) => {
    const element = document.querySelector(part);
    return element === null ? window : frameOf(element);
  }) as [Frame, Frame, Frame];
  const covers = [...document.querySelectorAll(OVER_THE_MAP)].map(frameOf);
  return { window, covers, room: { ...free, right: tools.left, bottom: notes.top } };
}

/** Calls when a panel, a tool or a note takes room from the map, or gives it back. */
export function onCoversChange(map: Pick<MapLibre, "once">, changed: () => void): void {
  const observer = new ResizeObserver(changed);
  for (const part of document.querySelectorAll(".map-free, .map-tools, .map-notes"))
    observer.observe(part);
  map.once("remove", () => observer.disconnect());
}

/** Whether all of a frame is inside the map's window, and nothing stands over it. */
export function isInSight(
  frame: Frame,
  { window, covers }: Pick<Uncovered, "window" | "covers">,
): boolean {
  const { left, top, right, bottom } = window;
  const isInside =
    frame.left >= left && frame.right <= right && frame.top >= top && frame.bottom <= bottom;
  return isInside && !covers.some((cover) => meets(frame, cover));
}

/** A notice of one or two lines comes and goes over the top of the free part. */
const NOTICE_PX = 64;
/** Where the free part is lower, no room is kept for notices. */
const LEAST_HEIGHT_PX = 480;

/** Space around what is fitted: the covered edges of the map, a rim, and room for a notice. */
export function paddingOf(
  map: Pick<HTMLElement, "getBoundingClientRect">,
  free: Pick<HTMLElement, "getBoundingClientRect">,
) {
  const frame = map.getBoundingClientRect();
  const { left, top, right, bottom } = free.getBoundingClientRect();
  const rim = 24;
  const notice = bottom - top >= LEAST_HEIGHT_PX ? NOTICE_PX : 0;
  return {
    left: Math.max(0, left - frame.left) + rim,
    top: Math.max(0, top - frame.top) + rim + notice,
    right: Math.max(0, frame.right - right) + rim,
    bottom: Math.max(0, frame.bottom - bottom) + rim,
  };
}

/** The middle of the uncovered part, in pixels of the map. */
export function middleOf(map: HTMLElement, free: HTMLElement): [number, number] {
  const frame = map.getBoundingClientRect();
  const { left, top, width, height } = free.getBoundingClientRect();
  return [left - frame.left + width / 2, top - frame.top + height / 2];
}
