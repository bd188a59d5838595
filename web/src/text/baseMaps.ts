import type { BaseMapView } from "../protocol";
import { formatLength } from "./units";

/** What a map shows of the site, for before leaving: `covers 100 % of the site to zoom 19 (0.22 m a pixel)`. */
export function coverageText({ covers, min_zoom, max_zoom, problem }: BaseMapView): string {
  if (problem !== null) return problem;
  if (covers === null)
    return `zoom ${min_zoom} to ${max_zoom}; what it covers of the site is not known`;
  if (covers.share === 0) return "covers nothing of the site";
  const pixel = `${formatLength(covers.metres_per_pixel, 2)} a pixel`;
  return `covers ${percent(covers.share)} of the site to zoom ${covers.zoom} (${pixel})`;
}

/** Never 100 % for less, never 0 % for more. */
function percent(share: number): string {
  if (share === 1) return "100 %";
  return share < 0.01 ? "less than 1 %" : `${Math.floor(share * 100)} %`;
}

/** Whether an operator should bring another map. */
export function isIncomplete({ covers, problem }: BaseMapView): boolean {
  return problem !== null || (covers !== null && covers.share < 1);
}
