"""The shadows' velocity from all recent pairs of shade maps together.

Each pair's phase correlation is read as a function of velocity: the agreement at the shift that a
velocity makes in the pair's time. True motion agrees in all pairs, chance in none, so the sum has
its peak at the motion also where each pair alone is unclear: a field seen by half, or nearly clear.
Older pairs fade out. The peak counts if it stands out from all that is farther from it than a peak
is wide. A peak at rest is the ground's pattern in the maps, no motion: the next one may be it.

A velocity must also explain what came (`matching`): maps of the last minute, moved by it, must
match later ones better than they do at rest, and at least half as much better as at the velocity
that explains most; or nothing explains them, and its peak is clear. Where no velocity agrees so,
the one that explains most counts, if over minutes it leaves clearly less than rest does; so shadows
are followed over sparse maps. Otherwise no motion is known.
"""

from dataclasses import replace
from math import hypot

import numpy as np

from recon.forecast.matching import Explained, Mismatch, matched_map, mismatch_by_velocity
from recon.forecast.motion import ShadowMotion
from recon.forecast.phase_correlation import (
    ShadeSpectrum,
    agreement_between,
    between,
    by_velocity,
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
    here = matched_map(shade)
    oldest_ns = at_ns - seconds_to_ns(settings.longest_pair_s)
    kept = tuple(one for one in state.kept if one.at_ns >= oldest_ns)
    matched = tuple(one for one in state.matched if one.at_ns >= oldest_ns)
    pooled = _faded(state.agreement, at_ns, settings)
    for before, there in zip(kept, matched, strict=True):
        found = _by_velocity(before, now, settings)
        if found is not None:
            mismatch = mismatch_by_velocity(there, here, settings)
            pooled = Agreement(
                at_ns,
                pooled.began_ns,
                pooled.by_velocity + found,
                _added(pooled.recent, mismatch),
                _added(pooled.long, mismatch),
            )
    return replace(state, kept=(*kept, now), matched=(*matched, here), agreement=pooled)


def pooled_motion(state: ForecastState, settings: ForecastSettings) -> ShadowMotion | None:
    """Return the velocity that most agree in, if it explains the maps; else the one that explains
    them best, if that is clear; None without one."""
    pooled = state.agreement
    if pooled is None:
        return None
    recent = Explained.of(pooled.recent, settings)
    motion, over_rival = _highest_agreement(pooled.by_velocity, settings)
    if motion is not None and recent.has(motion, settings.least_of_best):
        return motion
    if motion is not None and recent.best is None and over_rival >= settings.clear_over_rival:
        # What stands still is most of the maps, so that nothing explains them.
        return motion if motion.speed_mps >= settings.slowest_match_mps else None
    if ns_to_seconds(pooled.at_ns - pooled.began_ns) < settings.least_match_s:
        return None
    best = Explained.of(pooled.long, settings).best
    if best is not None and recent.has(best, settings.least_of_best):
        return best
    return None


def _highest_agreement(
    surface: FloatMap, settings: ForecastSettings
) -> tuple[ShadowMotion | None, float]:
    """Return the velocity at the peak, and the peak over the next one; None without one that stands
    out, or if it stands still."""
    step = settings.velocity_step_mps
    middle, near = surface.shape[0] // 2, round(settings.peak_mps / step)
    row, col = _highest(surface)
    left = surface
    if hypot(row - middle, col - middle) * step < settings.slowest_pooled_mps:
        left = _without(surface, middle, middle, near)
        row, col = _highest(left)
    peak, rival = float(left[row, col]), float(_without(left, row, col, near).max())
    if peak <= settings.least_over_rival * rival or peak <= 0.0:
        return None, 0.0
    right = col - middle + between(surface[row], col)
    down = row - middle + between(surface[:, col], row)
    return ShadowMotion(right * step, -down * step), peak / max(rival, 1e-9)


def _highest(surface: FloatMap) -> tuple[int, int]:
    row, col = np.unravel_index(int(np.argmax(surface)), surface.shape)
    return int(row), int(col)


def _without(surface: FloatMap, row: int, col: int, near: int) -> FloatMap:
    """Return a surface with 0 around a peak."""
    others = surface.copy()
    others[max(0, row - near) : row + near + 1, max(0, col - near) : col + near + 1] = 0.0
    return others


def _added(sums: Mismatch, pair: Mismatch) -> Mismatch:
    return Mismatch(sums.difference + pair.difference, sums.variance + pair.variance)


def _faded(agreement: Agreement | None, at_ns: int, settings: ForecastSettings) -> Agreement:
    if agreement is None:
        fine, coarse = (
            np.zeros((2 * round(settings.fastest_mps / step) + 1,) * 2, dtype=np.float32)
            for step in (settings.velocity_step_mps, settings.match_step_mps)
        )
        nothing = Mismatch(coarse, coarse)
        return Agreement(at_ns, at_ns, fine, nothing, nothing)
    passed_s = ns_to_seconds(at_ns - agreement.at_ns)
    short, long = (
        np.float32(np.exp(-passed_s / memory_s))
        for memory_s in (settings.agreement_memory_s, settings.match_memory_s)
    )
    return Agreement(
        at_ns,
        agreement.began_ns,
        agreement.by_velocity * short,
        *(
            Mismatch(one.difference * left, one.variance * left)
            for one, left in ((agreement.recent, short), (agreement.long, long))
        ),
    )


def _by_velocity(
    before: ShadeSpectrum, now: ShadeSpectrum, settings: ForecastSettings
) -> FloatMap | None:
    """Return (N, N): a pair's agreement at each velocity; None without contrast."""
    agreement = agreement_between(before, now, settings)
    if agreement is None:
        return None
    # Shifts of almost a grid overlap little: what agrees there is chance.
    gap_s = ns_to_seconds(now.at_ns - before.at_ns)
    return by_velocity(
        agreement, gap_s, now.grid.cell_m, settings.fastest_mps, settings.velocity_step_mps
    )
