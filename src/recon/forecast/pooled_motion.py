"""The shadows' velocity from all recent pairs of shade maps together.

Each pair's phase correlation is read as a function of velocity: the agreement at the shift that a
velocity makes in the pair's time. True motion agrees in all pairs, chance in none, so the sum has
its peak at the motion also where each pair alone is unclear: a field seen by half, or nearly clear.
Older pairs fade out. The peak counts if it stands out from all that is farther from it than a peak
is wide. A peak at rest is the ground's pattern in the maps, no motion: the next one may be it.
"""

from dataclasses import replace
from math import hypot

import cv2
import numpy as np

from recon.forecast.motion import ShadowMotion
from recon.forecast.phase_correlation import (
    ShadeSpectrum,
    agreement_between,
    between,
    spectrum_of,
)
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import Agreement, ForecastState
from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import ns_to_seconds, seconds_to_ns


def with_agreement(
    state: ForecastState, shade: ShadeMap, settings: ForecastSettings
) -> ForecastState:
    """Return the state with a map compared to those kept, once per `keep_every_s`."""
    at_ns, every_ns = shade.captured_at_ns, seconds_to_ns(settings.keep_every_s)
    if state.kept and at_ns // every_ns == state.kept[-1].at_ns // every_ns:
        return state
    now = spectrum_of(shade, settings, settings.least_pooled_contrast)
    oldest_ns = at_ns - seconds_to_ns(settings.longest_pair_s)
    kept = tuple(one for one in state.kept if one.at_ns >= oldest_ns)
    pooled = _faded(state.agreement, at_ns, settings)
    for before in kept:
        found = _by_velocity(before, now, settings)
        if found is not None:
            pooled += found
    return replace(state, kept=(*kept, now), agreement=Agreement(at_ns, pooled))


def pooled_motion(state: ForecastState, settings: ForecastSettings) -> ShadowMotion | None:
    """Return the velocity at the peak; None without one that stands out, or if it stands still."""
    if state.agreement is None:
        return None
    surface, step = state.agreement.by_velocity, settings.velocity_step_mps
    middle, near = surface.shape[0] // 2, round(settings.peak_mps / step)
    row, col = _highest(surface)
    left = surface
    if hypot(row - middle, col - middle) * step < settings.slowest_pooled_mps:
        left = _without(surface, middle, middle, near)
        row, col = _highest(left)
    peak, rival = float(left[row, col]), float(_without(left, row, col, near).max())
    if peak <= settings.least_over_rival * rival or peak <= 0.0:
        return None
    right = col - middle + between(surface[row], col)
    down = row - middle + between(surface[:, col], row)
    return ShadowMotion(right * step, -down * step)


def _highest(surface: FloatMap) -> tuple[int, int]:
    row, col = np.unravel_index(int(np.argmax(surface)), surface.shape)
    return int(row), int(col)


def _without(surface: FloatMap, row: int, col: int, near: int) -> FloatMap:
    """Return a surface with 0 around a peak."""
    others = surface.copy()
    others[max(0, row - near) : row + near + 1, max(0, col - near) : col + near + 1] = 0.0
    return others


def _faded(agreement: Agreement | None, at_ns: int, settings: ForecastSettings) -> FloatMap:
    size = 2 * round(settings.fastest_mps / settings.velocity_step_mps) + 1
    if agreement is None:
        return np.zeros((size, size), dtype=np.float32)
    passed_s = ns_to_seconds(at_ns - agreement.at_ns)
    faded: FloatMap = agreement.by_velocity * np.float32(
        np.exp(-passed_s / settings.agreement_memory_s)
    )
    return faded


def _by_velocity(
    before: ShadeSpectrum, now: ShadeSpectrum, settings: ForecastSettings
) -> FloatMap | None:
    """Return (N, N): a pair's agreement at each velocity; None without contrast."""
    agreement = agreement_between(before, now, settings)
    if agreement is None:
        return None
    half = round(settings.fastest_mps / settings.velocity_step_mps)
    speeds_mps = np.arange(-half, half + 1, dtype=np.float32) * np.float32(
        settings.velocity_step_mps
    )
    cells_per_mps = np.float32(ns_to_seconds(now.at_ns - before.at_ns) / now.grid.cell_m)
    middle_row, middle_col = agreement.shape[0] // 2, agreement.shape[1] // 2
    cols, rows = np.meshgrid(
        middle_col + speeds_mps * cells_per_mps, middle_row + speeds_mps * cells_per_mps
    )
    # Shifts of almost a grid overlap little: what agrees there is chance.
    found = cv2.remap(agreement, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    by_velocity: FloatMap = found.astype(np.float32, copy=False)
    return by_velocity
