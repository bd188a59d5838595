"""How alike sun and shade are at a distance, measured in this flight's maps.

It decides how much the nearest seen shade shows of places that are not seen. Large clouds shade
alike over a kilometre, small ones not over a hundred metres. And half shade may be the edge of a
cloud, or thin even cloud that is half shade everywhere. Until much has been seen, the usual skies
count more than what was measured.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import exp, sqrt

import numpy as np

from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, Likeness, prior_sunlit, sunlit_now
from recon.model.shade import ShadeMap
from recon.model.units import ns_to_seconds


def with_likeness(
    state: ForecastState, shade: ShadeMap, settings: ForecastSettings
) -> ForecastState:
    """Return the state with the likeness of a map's cells to those `likeness_apart_m` away."""
    before, at_ns = state.likeness, shade.captured_at_ns
    passed_s = settings.keep_every_s if before is None else ns_to_seconds(at_ns - before.at_ns)
    if passed_s < settings.keep_every_s:
        return state
    kept = exp(-passed_s / settings.cover_memory_s)
    # Weighted by time, so that the frame rate does not matter; gaps do not count more.
    weight = min(passed_s, 2.0 * settings.keep_every_s)
    old, seen = before or Likeness(at_ns), _likeness(shade, prior_sunlit(state, settings), settings)
    found = Likeness(
        at_ns,
        together=kept * old.together + weight * seen.together,
        alone=kept * old.alone + weight * seen.alone,
        changed=kept * old.changed + weight * seen.changed,
        partly=kept * old.partly + weight * seen.partly,
    )
    return replace(state, likeness=found)


def shade_scale_m(state: ForecastState, settings: ForecastSettings) -> float:
    """Return the distance at which the nearest seen shade shows half as much: the usual one, times
    how much farther or less far shade is alike in this flight than usually."""
    usual, count = settings.usual_likeness, settings.usual_likeness_s
    together, alone = usual * count, count
    if state.likeness is not None:
        together, alone = together + state.likeness.together, alone + state.likeness.alone
    alike = min(max(together / alone, settings.least_likeness), settings.most_likeness)
    # Likeness falls with distance as 1 / (1 + distance / scale).
    return settings.shade_scale_m * (alike / (1.0 - alike)) / (usual / (1.0 - usual))


def soft_edge_share(state: ForecastState, settings: ForecastSettings) -> float:
    """Return how wide soft edges are in this flight, as a share of the usual ones: by how much
    transmittance changes with distance where it is neither full sun nor full shade."""
    changed, partly = settings.usual_change**2 * settings.usual_change_s, settings.usual_change_s
    if state.likeness is not None:
        changed, partly = changed + state.likeness.changed, partly + state.likeness.partly
    return sqrt(changed / partly) / settings.usual_change


def _likeness(shade: ShadeMap, prior: float, settings: ForecastSettings) -> Likeness:
    """Return the means over a map's pairs of cells along rows and columns; 0 where no two are
    seen."""
    deviation = sunlit_now(shade, prior, settings) - np.float32(prior)
    apart = max(1, round(settings.likeness_apart_m / shade.grid.cell_m))
    sums, pairs = np.zeros(4), 0
    for one, other in _apart(apart):
        both = shade.valid[one] & shade.valid[other]
        first, second = deviation[one][both], deviation[other][both]
        direct, there = shade.transmittance[one][both], shade.transmittance[other][both]
        middle = (direct + there) / 2.0
        partly = 4.0 * middle * (1.0 - middle)
        found = (
            first * second,
            (first**2 + second**2) / 2.0,
            partly * (direct - there) ** 2,
            partly,
        )
        sums += [each.sum(dtype=np.float64) for each in found]
        pairs += int(both.sum())
    return Likeness(shade.captured_at_ns, *(sums / max(1, pairs)).tolist())


def _apart(cells: int) -> Iterator[tuple[tuple[slice, slice], tuple[slice, slice]]]:
    """Yield where both cells of all pairs are: down the columns, then along the rows."""
    everywhere, first, second = slice(None), slice(None, -cells), slice(cells, None)
    yield (second, everywhere), (first, everywhere)
    yield (everywhere, second), (everywhere, first)
