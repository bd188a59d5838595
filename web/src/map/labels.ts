/** What a label asks for: its symbol's place on the screen, and its text. */
export interface LabelSpot {
  readonly key: number;
  readonly x_px: number;
  readonly y_px: number;
  readonly text: string;
  /** The lowest finds its place first. */
  readonly rank: number;
}

/** Where a label stands from its symbol. */
export const SIDES = ["right", "left", "below", "above"] as const;
export type Side = (typeof SIDES)[number];

/** Half a symbol's badge, with a rim. */
const SYMBOL_PX = 15;
/** From the middle of a symbol to its label. */
export const GAP_PX = 22;
export const LABEL_HEIGHT_PX = 24;
/** As wide as the widest digits and common letters are. */
const LETTER_PX = 9;
const EDGES_PX = 16;

/** A rectangle on the screen, pixels. */
export interface Frame {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** A label that stands above its place, whatever it covers: a target's. */
export type FixedLabel = Pick<LabelSpot, "x_px" | "y_px" | "text">;

/**
 * A side for each label at which it is in sight as a whole (of a height cut in half the rest reads as another height)
 * and covers no symbol and no other label, also none of the fixed ones; a label without such a side has none. A label
 * keeps its side for as long as that is free.
 */
export function placeLabels(
  wanted: readonly LabelSpot[],
  symbols: readonly { readonly key: number; readonly x_px: number; readonly y_px: number }[],
  before: ReadonlyMap<number, Side>,
  fixed: readonly FixedLabel[] = [],
  isInSight: (frame: Frame) => boolean = () => true,
): Map<number, Side> {
  const taken = symbols.map(({ key, x_px, y_px }) => ({ key, ...around(x_px, y_px, SYMBOL_PX) }));
  const labels = wanted.map((spot) => ({
    key: spot.key,
    rank: spot.rank,
    places: SIDES.map((side) => [side, frameOf(spot, side)] as const),
  }));
  const isBlocked = (key: number, frame: Frame) =>
    taken.some((symbol) => symbol.key !== key && meets(frame, symbol)) || !isInSight(frame);
  return placeFrames(
    labels,
    before,
    fixed.map((label) => frameOf(label, "above")),
    isBlocked,
  );
}

/** A label that may stand at several places, by key and rank; its frames on the screen, the best first. */
export interface MovableLabel<Key, Place> {
  readonly key: Key;
  /** The lowest finds its place first. */
  readonly rank: number;
  readonly places: readonly (readonly [Place, Frame])[];
}

/**
 * The place of each label at which it covers no label of a lower rank and nothing that is blocked; a label without such
 * a place is excluded. A label keeps the place it had `before` for as long as that is free.
 */
export function placeFrames<Key, Place>(
  wanted: readonly MovableLabel<Key, Place>[],
  before: ReadonlyMap<Key, Place> = new Map(),
  fixed: readonly Frame[] = [],
  isBlocked: (key: Key, frame: Frame) => boolean = () => false,
): Map<Key, Place> {
  const placed = [...fixed];
  const found = new Map<Key, Place>();
  for (const { key, places } of [...wanted].sort((a, b) => a.rank - b.rank)) {
    const isKept = ([place]: readonly [Place, Frame]) => place === before.get(key);
    const tried = [...places.filter(isKept), ...places.filter((place) => !isKept(place))];
    const free = tried.find(
      ([, frame]) => !placed.some((other) => meets(frame, other)) && !isBlocked(key, frame),
    );
    if (free === undefined) continue;
    placed.push(free[1]);
    found.set(key, free[0]);
  }
  return found;
}

function frameOf({ x_px: x, y_px: y, text }: FixedLabel, side: Side): Frame {
  const width = EDGES_PX + LETTER_PX * text.length;
  const half = LABEL_HEIGHT_PX / 2;
  if (side === "right")
    return { left: x + GAP_PX, right: x + GAP_PX + width, top: y - half, bottom: y + half };
  if (side === "left")
    return { left: x - GAP_PX - width, right: x - GAP_PX, top: y - half, bottom: y + half };
  const top = side === "below" ? y + GAP_PX : y - GAP_PX - LABEL_HEIGHT_PX;
  return { left: x - width / 2, right: x + width / 2, top, bottom: top + LABEL_HEIGHT_PX };
}

function around(x: number, y: number, half: number): Frame {
  return { left: x - half, right: x + half, top: y - half, bottom: y + half };
}

export function meets(a: Frame, b: Frame): boolean {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}
