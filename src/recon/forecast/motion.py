"""The shadows' velocity: robust median over many pairs of shade maps."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from recon.forecast.phase_correlation import ShadeSpectrum, shift_between, spectrum_of
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, PairVelocity
from recon.model.shade import ShadeMap
from recon.model.units import ns_to_seconds, seconds_to_ns

NORMAL_MAD = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution."""


@dataclass(frozen=True, slots=True)
class ShadowMotion:
    """The shadows' common velocity, and the spread of pairs about it (standard deviation)."""

    east_mps: float
    north_mps: float
    spread_mps: float


def with_pairs(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    """Return the state with a map compared to those kept, once per `keep_every_s`."""
    at_ns = shade.captured_at_ns
    every_ns = seconds_to_ns(settings.keep_every_s)
    if state.kept and at_ns // every_ns == state.kept[-1].at_ns // every_ns:
        return state
    now = spectrum_of(shade, settings, settings.least_contrast)
    found = (_velocity(before, now, settings) for before in _partners(state, at_ns, settings))
    recent_ns = at_ns - seconds_to_ns(settings.motion_window_s)
    velocities = (*state.velocities, *(one for one in found if one is not None))
    # Spectra older than the longest pair are never compared again.
    oldest_ns = at_ns - seconds_to_ns(max(settings.pair_s))
    return replace(
        state,
        velocities=tuple(one for one in velocities if one.at_ns > recent_ns),
        kept=(*(one for one in state.kept if one.at_ns >= oldest_ns), now),
    )


def motion_of(state: ForecastState, settings: ForecastSettings) -> ShadowMotion | None:
    """Return the median velocity of recent pairs; None when they are few or disagree."""
    if len(state.velocities) < settings.least_pairs:
        return None
    all_mps = np.array([(one.east_mps, one.north_mps) for one in state.velocities])
    # Median per component: up to half of the pairs may be wrong.
    middle_mps = np.median(all_mps, axis=0)
    spread_mps = NORMAL_MAD * float(np.median(np.hypot(*(all_mps - middle_mps).T)))
    if spread_mps > settings.most_spread_mps:
        return None
    east_mps, north_mps = (float(mps) for mps in middle_mps)
    return ShadowMotion(east_mps, north_mps, max(spread_mps, settings.least_spread_mps))


def _partners(state: ForecastState, at_ns: int, settings: ForecastSettings) -> list[ShadeSpectrum]:
    """Return the kept maps nearest to the wanted time differences, each once."""
    chosen: dict[int, ShadeSpectrum] = {}
    for wanted_s in settings.pair_s:
        slack_ns = seconds_to_ns(settings.keep_every_s)
        wanted_ns = at_ns - seconds_to_ns(wanted_s)
        near = [one for one in state.kept if abs(one.at_ns - wanted_ns) <= slack_ns]
        if near:
            best = min(near, key=lambda one: abs(one.at_ns - wanted_ns))
            chosen[best.at_ns] = best
    return list(chosen.values())


def _velocity(
    before: ShadeSpectrum, now: ShadeSpectrum, settings: ForecastSettings
) -> PairVelocity | None:
    shift = shift_between(before, now, settings)
    # Unclear pairs are dropped rather than weighted: a wrong velocity is worse than persistence.
    if shift is None or not shift.is_clear(settings):
        return None
    gap_s = ns_to_seconds(now.at_ns - before.at_ns)
    velocity = PairVelocity(now.at_ns, shift.east_m / gap_s, shift.north_m / gap_s)
    is_moving = hypot(velocity.east_mps, velocity.north_mps) >= settings.slowest_mps
    return velocity if is_moving else None
