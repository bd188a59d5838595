/** Places the vehicles' labels on the screen so that they hide neither each other nor a vehicle. All in pixels. */

/** A label to place: its vehicle's position on the screen and the label's size. */
export interface LabelSpot {
  readonly key: number;
  readonly x_px: number;
  readonly y_px: number;
  readonly width_px: number;
  readonly height_px: number;
}

/** A label's position: its upper left corner relative to its vehicle. */
export interface LabelPlace {
  /** Index of the candidate position; 0 is the default, below the vehicle. */
  readonly slot: number;
  readonly dx_px: number;
  readonly dy_px: number;
}

/** The line from a moved label's edge to its vehicle. */
export interface LabelLine {
  /** Start relative to the label's upper left corner. */
  readonly x_px: number;
  readonly y_px: number;
  readonly length_px: number;
  /** Clockwise from the screen's right. */
  readonly angle_rad: number;
}

/** Half the side of the square reserved for a vehicle's symbol. */
const SYMBOL_HALF_PX = 18;
/** Distances from the vehicle at which positions are tried; all clear the symbol and its margin. */
const REACHES_PX = [26, 60, 94] as const;
/** A label moves only to a position with this much free space on every side, so that it does not flicker. */
const MARGIN_PX = 8;
/** Labels beyond this number stay below their vehicles, which bounds the work per frame. */
export const MOST_LABELS = 64;

type LabelOffset = readonly [dx_px: number, dy_px: number];

/** Candidate positions at one distance, best first: below, right, left, above, then the diagonals. */
function cornersAt(reach: number, width: number, height: number): readonly LabelOffset[] {
  return [
    [-width / 2, reach],
    [reach, -height / 2],
    [-reach - width, -height / 2],
    [-width / 2, -reach - height],
    [reach, reach],
    [-reach - width, reach],
    [reach, -reach - height],
    [-reach - width, -reach - height],
  ];
}

/** A rectangle on the screen, pixels. */
export interface ScreenBox {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** The map's size on the screen and the elements covering it. */
export interface LabelView {
  readonly width_px: number;
  readonly height_px: number;
  /** Other elements on the map that would hide a label. */
  readonly covered: readonly ScreenBox[];
}

/**
 * Places labels one after the other, in the order of `spots`: at the first free position, else at the
 * one with the smallest hidden area, which includes any part outside `view`. `previous` holds the positions
 * of the last frame; a label leaves its position only when that is taken or a better one has room to spare.
 */
export function placeLabels(
  spots: readonly LabelSpot[],
  previous: ReadonlyMap<number, LabelPlace>,
  view: LabelView,
): Map<number, LabelPlace> {
  const taken: ScreenBox[] = [...view.covered, ...spots.slice(0, MOST_LABELS).map(symbolBox)];
  const places = new Map<number, LabelPlace>();
  spots.forEach((spot, index) => {
    const isArranged = index < MOST_LABELS;
    const place = isArranged ? choose(spot, previous.get(spot.key)?.slot ?? 0, taken, view) : null;
    places.set(spot.key, place ?? placeAt(spot, 0));
    if (place !== null) taken.push(labelBox(spot, place));
  });
  return places;
}

function choose(
  spot: LabelSpot,
  kept: number,
  taken: readonly ScreenBox[],
  view: LabelView,
): LabelPlace {
  const slots = slotsOf(spot);
  let best = slots[0] ?? placeAt(spot, 0);
  let least = Number.POSITIVE_INFINITY;
  for (const place of slots) {
    const box = labelBox(spot, place);
    const isKept = place.slot === kept;
    const hidden = hiddenArea(isKept ? box : grown(box), taken) + outsideArea(box, view);
    if (hidden === 0) return place;
    // Without a free position, prefer the previous one.
    const cost = isKept ? hidden / 2 : hidden;
    if (cost >= least) continue;
    least = cost;
    best = place;
  }
  return best;
}

function slotsOf(spot: LabelSpot): LabelPlace[] {
  const { width_px, height_px } = spot;
  return REACHES_PX.flatMap((reach) => cornersAt(reach, width_px, height_px)).map(
    ([dx_px, dy_px], slot) => ({ slot, dx_px, dy_px }),
  );
}

function placeAt(spot: LabelSpot, slot: number): LabelPlace {
  return slotsOf(spot)[slot] ?? { slot: 0, dx_px: 0, dy_px: REACHES_PX[0] };
}

function symbolBox({ x_px, y_px }: LabelSpot): ScreenBox {
  const half = SYMBOL_HALF_PX;
  return { left: x_px - half, top: y_px - half, right: x_px + half, bottom: y_px + half };
}

function labelBox(spot: LabelSpot, place: LabelPlace): ScreenBox {
  const left = spot.x_px + place.dx_px;
  const top = spot.y_px + place.dy_px;
  return { left, top, right: left + spot.width_px, bottom: top + spot.height_px };
}

function grown({ left, top, right, bottom }: ScreenBox): ScreenBox {
  return {
    left: left - MARGIN_PX,
    top: top - MARGIN_PX,
    right: right + MARGIN_PX,
    bottom: bottom + MARGIN_PX,
  };
}

function hiddenArea(box: ScreenBox, taken: readonly ScreenBox[]): number {
  let area = 0;
  for (const other of taken) {
    const width = Math.min(box.right, other.right) - Math.max(box.left, other.left);
    const height = Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top);
    if (width > 0 && height > 0) area += width * height;
  }
  return area;
}

function outsideArea(box: ScreenBox, view: LabelView): number {
  const width = Math.min(box.right, view.width_px) - Math.max(box.left, 0);
  const height = Math.min(box.bottom, view.height_px) - Math.max(box.top, 0);
  const inside = Math.max(0, width) * Math.max(0, height);
  return (box.right - box.left) * (box.bottom - box.top) - inside;
}

/** The line from a label to its vehicle; null at the default position. */
export function labelLine(
  place: LabelPlace,
  size: { readonly width_px: number; readonly height_px: number },
): LabelLine | null {
  if (place.slot === 0) return null;
  const { dx_px, dy_px } = place;
  const nearX = Math.min(Math.max(0, dx_px), dx_px + size.width_px);
  const nearY = Math.min(Math.max(0, dy_px), dy_px + size.height_px);
  const length_px = Math.hypot(nearX, nearY) - SYMBOL_HALF_PX;
  if (length_px <= 0) return null;
  return {
    x_px: nearX - dx_px,
    y_px: nearY - dy_px,
    length_px,
    angle_rad: Math.atan2(-nearY, -nearX),
  };
}
