/** Where the vehicles' labels stand on the screen, so that none hides another or a vehicle. Pixels throughout. */

/** A label that wants a place: its vehicle's point on the screen and its own size. */
export interface LabelSpot {
  readonly key: number;
  readonly x_px: number;
  readonly y_px: number;
  readonly width_px: number;
  readonly height_px: number;
}

/** Where a label stands: its upper left corner as seen from its vehicle's point. */
export interface LabelPlace {
  /** Which of the places was taken; 0 is the usual one, below the vehicle. */
  readonly slot: number;
  readonly dx_px: number;
  readonly dy_px: number;
}

/** A line from the vehicle to a label that was moved away, starting at the label's edge. */
export interface Leader {
  /** The start as seen from the label's upper left corner. */
  readonly x_px: number;
  readonly y_px: number;
  readonly length_px: number;
  /** Clockwise from the screen's right. */
  readonly angle_rad: number;
}

/** Half the side of the square a vehicle's symbol keeps for itself. */
const SYMBOL_HALF_PX = 18;
/** How far from the vehicle's point labels are tried, nearest first: symbol and margin are cleared by all. */
const REACHES_PX = [26, 60, 94] as const;
/** A label moves only to a place this much wider than itself on every side: without, it would flicker. */
const MARGIN_PX = 8;
/** More labels than this are not looked after: they stay below. It bounds the work of one frame. */
export const MOST_LABELS = 64;

type Corner = readonly [dx_px: number, dy_px: number];

/** The places around a vehicle at one reach, best first: below, right, left, above, then the diagonals. */
function cornersAt(reach: number, width: number, height: number): readonly Corner[] {
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
export interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** The part of the screen the map fills, from its upper left corner. */
export interface LabelView {
  readonly width_px: number;
  readonly height_px: number;
  /** What else stands on the map, and would hide a label. */
  readonly covered: readonly Box[];
}

/**
 * Places labels one after the other, in the order of `spots`: the first free place, else the one that
 * hides least. What sticks out of `view` is hidden too. `previous` holds where they stood in the last frame; a label leaves its place only when it
 * is taken, or when a better one is free with some room to spare.
 */
export function placeLabels(
  spots: readonly LabelSpot[],
  previous: ReadonlyMap<number, LabelPlace>,
  view: LabelView,
): Map<number, LabelPlace> {
  const taken: Box[] = [...view.covered, ...spots.slice(0, MOST_LABELS).map(symbolBox)];
  const places = new Map<number, LabelPlace>();
  spots.forEach((spot, index) => {
    const isLookedAfter = index < MOST_LABELS;
    const place = isLookedAfter
      ? choose(spot, previous.get(spot.key)?.slot ?? 0, taken, view)
      : null;
    places.set(spot.key, place ?? placeAt(spot, 0));
    if (place !== null) taken.push(labelBox(spot, place));
  });
  return places;
}

function choose(spot: LabelSpot, kept: number, taken: readonly Box[], view: LabelView): LabelPlace {
  const slots = slotsOf(spot);
  let best = slots[0] ?? placeAt(spot, 0);
  let least = Number.POSITIVE_INFINITY;
  for (const place of slots) {
    const box = labelBox(spot, place);
    const isKept = place.slot === kept;
    const hidden = hiddenArea(isKept ? box : grown(box), taken) + outsideArea(box, view);
    if (hidden === 0) return place;
    // In a crowd without a free place, staying counts for something too.
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

function symbolBox({ x_px, y_px }: LabelSpot): Box {
  const half = SYMBOL_HALF_PX;
  return { left: x_px - half, top: y_px - half, right: x_px + half, bottom: y_px + half };
}

function labelBox(spot: LabelSpot, place: LabelPlace): Box {
  const left = spot.x_px + place.dx_px;
  const top = spot.y_px + place.dy_px;
  return { left, top, right: left + spot.width_px, bottom: top + spot.height_px };
}

function grown({ left, top, right, bottom }: Box): Box {
  return {
    left: left - MARGIN_PX,
    top: top - MARGIN_PX,
    right: right + MARGIN_PX,
    bottom: bottom + MARGIN_PX,
  };
}

function hiddenArea(box: Box, taken: readonly Box[]): number {
  let area = 0;
  for (const other of taken) {
    const width = Math.min(box.right, other.right) - Math.max(box.left, other.left);
    const height = Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top);
    if (width > 0 && height > 0) area += width * height;
  }
  return area;
}

function outsideArea(box: Box, view: LabelView): number {
  const width = Math.min(box.right, view.width_px) - Math.max(box.left, 0);
  const height = Math.min(box.bottom, view.height_px) - Math.max(box.top, 0);
  const inside = Math.max(0, width) * Math.max(0, height);
  return (box.right - box.left) * (box.bottom - box.top) - inside;
}

/** The line that ties a label to its vehicle; null while it stands in its usual place. */
export function leaderOf(
  place: LabelPlace,
  size: { readonly width_px: number; readonly height_px: number },
): Leader | null {
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
