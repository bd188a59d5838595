"""How alike sun and shade are at a distance, measured in this flight's maps.

It decides how much the nearest seen shade shows of places that are not seen. Large clouds shade
alike over a kilometre, small ones not over a hundred metres. Until much has been seen, the usual
skies count more than what was measured.
"""

from dataclasses import replace

import numpy as np

from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, Likeness, prior_sunlit, sunlit_now
from recon.model.shade import FloatMap, MaskMap, ShadeMap
from recon.model.units import ns_to_seconds


def with_likeness(
    state: ForecastState, shade: ShadeMap, settings: ForecastSettings
) -> ForecastState:
    """Return the state with the likeness of a map's cells to those `likeness_apart_m` away."""
    before, at_ns = state.likeness, shade.captured_at_ns
    passed_s = settings.keep_every_s if before is None else ns_to_seconds(at_ns - before.at_ns)
    if passed_s < settings.keep_every_s:
        return state
    prior = prior_sunlit(state, settings)
    deviation = sunlit_now(shade, prior, settings) - np.float32(prior)
    apart = max(1, round(settings.likeness_apart_m / shade.grid.cell_m))
    together, alone = _products(deviation, shade.valid, apart)
    kept = np.exp(-passed_s / settings.cover_memory_s)
    # Weighted by time, so that the frame rate does not matter; gaps do not count more.
    weight = min(passed_s, 2.0 * settings.keep_every_s)
    old = before or Likeness(at_ns, 0.0, 0.0)
    found = Likeness(
        at_ns, kept * old.together + weight * together, kept * old.alone + weight * alone
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


def _products(deviation: FloatMap, seen: MaskMap, apart: int) -> tuple[float, float]:
    """Return the mean product of cells so far apart along rows and columns, and their mean square;
    0 where no two are seen."""
    products, squares, pairs = 0.0, 0.0, 0
    for one, other in (
        ((slice(apart, None), slice(None)), (slice(None, -apart), slice(None))),
        ((slice(None), slice(apart, None)), (slice(None), slice(None, -apart))),
    ):
        both = seen[one] & seen[other]
        first, second = deviation[one][both], deviation[other][both]
        products += float((first * second).sum(dtype=np.float64))
        squares += float((first**2 + second**2).sum(dtype=np.float64)) / 2.0
        pairs += int(both.sum())
    return (products / pairs, squares / pairs) if pairs else (0.0, 0.0)
