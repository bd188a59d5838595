"""The spatial correlation of sun and shade, measured in this flight's maps.

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
from recon.forecast.state import ForecastState, SpatialCorrelation, prior_sunlit, sunlit_now
from recon.model.shade import ShadeMap
from recon.model.units import ns_to_seconds


def with_correlation(
    state: ForecastState, shade: ShadeMap, settings: ForecastSettings
) -> ForecastState:
    """Return the state with the correlation of cells with those `correlation_lag_m` away."""
    before, at_ns = state.correlation, shade.captured_at_ns
    passed_s = settings.keep_every_s if before is None else ns_to_seconds(at_ns - before.at_ns)
    if passed_s < settings.keep_every_s:
        return state
    kept = exp(-passed_s / settings.cover_memory_s)
    # Weighted by time, so that the frame rate does not matter; gaps do not count more.
    weight = min(passed_s, 2.0 * settings.keep_every_s)
    old, seen = (
        before or SpatialCorrelation(at_ns),
        _correlation_of(shade, prior_sunlit(state, settings), settings),
    )
    found = SpatialCorrelation(
        at_ns,
        covariance_s=kept * old.covariance_s + weight * seen.covariance_s,
        variance_s=kept * old.variance_s + weight * seen.variance_s,
        change_s=kept * old.change_s + weight * seen.change_s,
        partly_shaded_s=kept * old.partly_shaded_s + weight * seen.partly_shaded_s,
    )
    return replace(state, correlation=found)


def shade_scale_m(state: ForecastState, settings: ForecastSettings) -> float:
    """Return the distance at which the nearest seen shade shows half as much: the usual one, times
    how much farther or less far shade is correlated in this flight than usually."""
    usual, variance_s = settings.usual_correlation, settings.usual_correlation_s
    covariance_s = usual * variance_s
    if state.correlation is not None:
        covariance_s += state.correlation.covariance_s
        variance_s += state.correlation.variance_s
    measured = covariance_s / variance_s
    found = min(max(measured, settings.least_correlation), settings.most_correlation)
    # Correlation falls with distance as 1 / (1 + distance / scale).
    return settings.shade_scale_m * (found / (1.0 - found)) / (usual / (1.0 - usual))


def soft_edge_share(state: ForecastState, settings: ForecastSettings) -> float:
    """Return how wide soft edges are in this flight, as a share of the usual ones: by how much
    transmittance changes with distance where it is neither full sun nor full shade."""
    partly_shaded_s = settings.usual_change_s
    change_s = settings.usual_change**2 * partly_shaded_s
    if state.correlation is not None:
        change_s += state.correlation.change_s
        partly_shaded_s += state.correlation.partly_shaded_s
    return sqrt(change_s / partly_shaded_s) / settings.usual_change


def _correlation_of(
    shade: ShadeMap, prior: float, settings: ForecastSettings
) -> SpatialCorrelation:
    """Return the means over a map's pairs of cells along rows and columns; 0 where no two are
    seen."""
    deviation = sunlit_now(shade, prior, settings) - np.float32(prior)
    apart = max(1, round(settings.correlation_lag_m / shade.grid.cell_m))
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
    return SpatialCorrelation(shade.captured_at_ns, *(sums / max(1, pairs)).tolist())


def _apart(cells: int) -> Iterator[tuple[tuple[slice, slice], tuple[slice, slice]]]:
    """Yield where both cells of all pairs are: down the columns, then along the rows."""
    everywhere, first, second = slice(None), slice(None, -cells), slice(cells, None)
    yield (second, everywhere), (first, everywhere)
    yield (everywhere, second), (everywhere, first)
