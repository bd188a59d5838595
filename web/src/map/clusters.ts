/** A point on the screen, in pixels. */
export interface Spot {
  readonly key: number;
  readonly x_px: number;
  readonly y_px: number;
  /** Never in a cluster: it is selected, or something is wrong with it. */
  readonly standsAlone: boolean;
}

export interface Cluster {
  readonly keys: readonly number[];
  readonly x_px: number;
  readonly y_px: number;
}

/** Symbols nearer than this hide each other. */
const RADIUS_PX = 24;
/** Fewer are drawn one over the other: a number of four tells less than four vehicles. */
const LEAST = 5;

/** Groups of vehicles that would hide each other on the screen, each around its first vehicle. */
export function clustersOf(spots: readonly Spot[]): Cluster[] {
  let left = spots.filter((spot) => !spot.standsAlone);
  const found: Cluster[] = [];
  while (left.length >= LEAST) {
    const [first] = left;
    if (first === undefined) break;
    const near = left.filter((spot) => distance_px(first, spot) < RADIUS_PX);
    left = left.filter((spot) => spot !== first && (near.length < LEAST || !near.includes(spot)));
    if (near.length < LEAST) continue;
    const mean = (of: (spot: Spot) => number) =>
      near.reduce((sum, spot) => sum + of(spot), 0) / near.length;
    found.push({
      keys: near.map(({ key }) => key),
      x_px: mean(({ x_px }) => x_px),
      y_px: mean(({ y_px }) => y_px),
    });
  }
  return found;
}

function distance_px(a: Spot, b: Spot): number {
  return Math.hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}
