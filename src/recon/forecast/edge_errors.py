"""How far off the edges of followed shade were, measured in this flight.

Each kept map, moved on by the shadows' velocity, is held against the newest one. The share of cells
that differ in sun and shade, over the share that differ one metre apart, is how far edges are off
in metres: by the velocity's error, by clouds that change, and by the maps' own errors. It grows
with the time between the maps. Chances of sun are spread as far around each place.
"""

from dataclasses import replace

import cv2
import numpy as np

from recon.forecast.motion import ShadowMotion
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import EdgeErrors, ForecastState
from recon.forecast.upwind import upwind
from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import ns_to_seconds, seconds_to_ns

FEWEST_SHARE = 0.1
"""Share of a map's known cells that must be in both: fewer are chance."""
ROUNDING = 0.38
"""Mean distance in cells by which a map is off that is moved by whole cells."""
DEVIATION = 0.8
"""Standard deviation along one axis over the mean distance, of errors in all directions."""
RADIUS = 2.45
"""Radius of the blur with triangular weights over its standard deviation."""


def with_edge_errors(
    state: ForecastState, motion: ShadowMotion | None, settings: ForecastSettings
) -> ForecastState:
    """Return the state with its newest map compared with the kept ones, moved by the motion."""
    newest, every_ns = state.newest, seconds_to_ns(settings.keep_every_s)
    at_ns, recent = newest.captured_at_ns, state.recent
    if recent and at_ns // every_ns == recent[-1].captured_at_ns // every_ns:
        return state
    before = state.edge_errors or EdgeErrors(at_ns)
    sums = before.faded(
        float(np.exp(-ns_to_seconds(at_ns - before.at_ns) / settings.edge_memory_s))
    )
    edge = _edge_per_m(newest)
    if motion is not None and edge > 0.0:
        for then in recent:
            gap_s = ns_to_seconds(at_ns - then.captured_at_ns)
            off = _differing_share(then, newest, motion, gap_s)
            if off is not None and gap_s <= settings.longest_pair_s:
                off = max(0.0, off - edge * ROUNDING * newest.grid.cell_m)
                sums += np.array([edge, edge * gap_s, edge * gap_s**2, off, off * gap_s])
    return replace(state, edge_errors=EdgeErrors(at_ns, tuple(sums.tolist())))


def edge_error_m(state: ForecastState, lead_s: float, settings: ForecastSettings) -> float:
    """Return the standard deviation of the place of a followed edge, along each axis."""
    usual = settings.usual_edge_weight
    far_s = settings.longest_pair_s
    growth_m = settings.least_spread_mps * far_s
    # Two usual maps stand beside the measured ones: one at once, one after the longest pair.
    edge, edge_s, edge_ss, off, off_s = np.array(
        [2.0 * usual, usual * far_s, usual * far_s**2, usual * growth_m, usual * growth_m * far_s]
    ) + (state.edge_errors.sums if state.edge_errors is not None else 0.0)
    slope = max(0.0, (edge * off_s - edge_s * off) / (edge * edge_ss - edge_s**2))
    now_m = max(0.0, (off - slope * edge_s) / edge)
    return DEVIATION * min(float(now_m + slope * lead_s), settings.most_edge_m)


def spread(chances: FloatMap, error_m: float, cell_m: float) -> FloatMap:
    """Return chances of sun (R, C), spread over places as far off as edges may be."""
    radius = round(RADIUS * error_m / cell_m)
    if radius < 1:
        return chances
    size = min(2 * radius + 1, 2 * (min(chances.shape) // 2) - 1)
    found: FloatMap = cv2.stackBlur(chances, (size, size)).astype(np.float32, copy=False)
    return found


def _edge_per_m(shade: ShadeMap) -> float:
    """Return the share of a map's cells that change between sun and shade over one metre."""
    lit, known, changed, pairs = shade.is_sunlit, shade.valid, 0, 0
    for one, other in (
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
    ):
        both = known[one] & known[other]
        changed += int(((lit[one] != lit[other]) & both).sum())
        pairs += int(both.sum())
    return changed / max(1, pairs) / shade.grid.cell_m


def _differing_share(
    then: ShadeMap, now: ShadeMap, motion: ShadowMotion, gap_s: float
) -> float | None:
    """Return the share of cells that differ from an earlier map moved on; None of too few."""
    if then.grid != now.grid or gap_s <= 0.0:
        return None
    to_then = upwind(now.grid, motion, gap_s)
    size = (now.grid.cols, now.grid.rows)
    how = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    was = then.valid.astype(np.uint8) + then.is_sunlit.astype(np.uint8)
    moved = cv2.warpAffine(was, to_then, size, flags=how, borderMode=cv2.BORDER_CONSTANT)
    both = (moved > 0) & now.valid
    count = int(both.sum())
    if count < FEWEST_SHARE * now.valid.sum() or count == 0:
        return None
    return float((((moved == 2) != now.is_sunlit) & both).sum()) / count
