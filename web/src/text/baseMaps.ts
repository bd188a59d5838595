import type { BaseMapView } from "../protocol";
import { text } from "./catalogue";
import { formatLength } from "./units";

/** What a map shows of the site, for before leaving: `covers 100 % of the site to zoom 19 (0.22 m a pixel)`. */
export function coverageText({ covers, min_zoom, max_zoom, problem }: BaseMapView): string {
  if (problem !== null) return problem;
  if (covers === null) return text.layers.coverageUnknown(min_zoom, max_zoom);
  if (covers.share === 0) return text.layers.coversNothing;
  const pixel = formatLength(covers.metres_per_pixel, 2);
  return text.layers.covers(percent(covers.share), covers.zoom, pixel);
}

/** Never 100 % for less, never 0 % for more. */
function percent(share: number): string {
  if (share === 1) return "100 %";
  return share < 0.01 ? text.layers.lessThanOne : `${Math.floor(share * 100)} %`;
}

/** Whether an operator should bring another map. */
export function isIncomplete({ covers, problem }: BaseMapView): boolean {
  return problem !== null || (covers !== null && covers.share < 1);
}
