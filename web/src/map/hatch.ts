/** Stripes that fill an area, drawn once as a tile that repeats. */
export interface Hatch {
  /** Whether stripes run both paths. */
  readonly isCrossed: boolean;
  /** The tile's side, which is the distance between stripes along an edge; pixels. */
  readonly tile_px: number;
  readonly stripe_px: number;
  /** 0 to 1. */
  readonly opacity: number;
}

/** An image as MapLibre takes it. */
export interface HatchImage {
  readonly width: number;
  readonly height: number;
  readonly data: Uint8ClampedArray;
}

/** Renders the tile in a colour written `#rrggbb`. */
export function hatchImage(hatch: Hatch, colour: string): HatchImage {
  const { tile_px: side } = hatch;
  const [red, green, blue] = rgbOf(colour);
  const data = new Uint8ClampedArray(4 * side * side);
  for (let y = 0; y < side; y += 1) {
    for (let x = 0; x < side; x += 1) {
      if (!isStriped(hatch, x, y)) continue;
      data.set([red, green, blue, Math.round(255 * hatch.opacity)], 4 * (y * side + x));
    }
  }
  return { width: side, height: side, data };
}

/** Stripes continue across tiles: only the position modulo the tile size counts. */
function isStriped({ isCrossed, tile_px: side, stripe_px }: Hatch, x: number, y: number): boolean {
  const isUp = (x + y) % side < stripe_px;
  const isDown = (x - y + side) % side < stripe_px;
  return isUp || (isCrossed && isDown);
}

function rgbOf(colour: string): [number, number, number] {
  const match = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(colour);
  if (match === null) throw new Error(`A map colour must be written #rrggbb, not "${colour}".`);
  const [, red = "", green = "", blue = ""] = match;
  return [Number.parseInt(red, 16), Number.parseInt(green, 16), Number.parseInt(blue, 16)];
}
