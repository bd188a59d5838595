"""Whom to hold of two that come too near each other.

Theory of operation. Doing nothing, holding the one and holding the other are predicted equally far
ahead and compared by their closest approach:

    the hold just given may still show in time for the other to stop -> wait
    holds that are better than doing nothing -> the one that keeps them farther apart;
                                                alike: in the order of yielding
    none is better                           -> no hold: the alarm stays

Both are held one after the other: once the first brakes, holding the second is judged against that.
No option is taken whose closest approach is predicted to be nearer than that of doing nothing. A
vehicle that lands or returns may be anywhere between its path and the ground. Options alike in
closeness are ranked by how far the two may come into each other's heights, so that of two above
each other the upper one is held, and the lower one leaves.
"""

from typing import NamedTuple

import numpy as np

from recon.model.arrays import BoolArray
from recon.model.failsafe_matrix import FailsafeCondition
from recon.safety.separation_minima import SeparationMinima
from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.closest_approach import Approach, approach, closeness
from recon.safety.watchdogs.traffic_picture import TrafficPicture, WatchedVehicle

ROUNDING = 1e-9
"""Rounding error of a closeness: the same paths may be summed in another order."""


class PairConflict(NamedTuple):
    """Two vehicles in the order of yielding, their indices in `predicted`, and how near they come.

    `unknown` (V, V): the pairs whose heights say nothing about each other.
    """

    both: tuple[WatchedVehicle, WatchedVehicle]
    indices: tuple[int, int]
    found: Approach
    need: SeparationMinima
    unknown: BoolArray | None


def vehicle_to_hold(picture: TrafficPicture, conflict: PairConflict) -> WatchedVehicle | None:
    """Return which vehicle of a conflict that is due is to be held now; None: that is no better."""
    if _may_wait(picture, conflict):
        return None
    best: tuple[WatchedVehicle, Approach] | None = None
    for number, candidate in enumerate(conflict.both):
        if not can_be_held(picture, candidate):
            continue
        instead = _if_held(picture, conflict, number)
        if not is_better(picture.settings, conflict.found, instead):
            continue
        if best is None or _is_wider(instead, best[1], picture.settings):
            best = candidate, instead
    return None if best is None else best[0]


def can_be_held(picture: TrafficPicture, candidate: WatchedVehicle) -> bool:
    """Return whether the station may hold a vehicle now: it was not held a moment ago."""
    may_be_held = candidate.may_be_held_for(FailsafeCondition.SEPARATION)
    if not picture.is_hold_on or not may_be_held:
        return False
    return not candidate.was_held_within_s(picture.now_ns, picture.settings.hold_again_s)


def is_better(settings: WatchdogSettings, found: Approach, instead: Approach) -> bool:
    """Return whether an option is better than doing nothing; never if it comes nearer."""
    if instead.in_s is None:
        return True
    assert found.in_s is not None
    if instead.least < found.least - ROUNDING:
        return False
    if instead.in_s >= found.in_s + settings.helps_s:
        return True
    return instead.in_s >= found.in_s and _is_wider(instead, found, settings)


def speed_mps(watched: WatchedVehicle) -> float:
    """Return a vehicle's horizontal speed; one that was never placed has none."""
    return 0.0 if watched.motion is None else watched.motion.speed_mps


def _is_wider(one: Approach, other: Approach, settings: WatchdogSettings) -> bool:
    """Whether the one keeps more distance; what keeps the minima is as good as any other."""
    if other.in_s is None:
        return False
    wider_by = one.least - other.least
    if abs(wider_by) < settings.helps_share:
        return one.height_gap_m >= other.height_gap_m + settings.helps_height_m
    return wider_by >= settings.helps_share


def _may_wait(picture: TrafficPicture, conflict: PairConflict) -> bool:
    """Whether a hold just given may still show before the other one has to stop too."""
    assert conflict.found.in_s is not None
    settings, prediction = picture.settings, picture.prediction
    first, second = conflict.both
    for candidate, stays in ((first, second), (second, first)):
        needs_s = prediction.reaction_s + speed_mps(stays) / prediction.braking_mps2
        if candidate.was_held_within_s(picture.now_ns, settings.effect_s) and (
            conflict.found.in_s > needs_s + 0.5 * settings.hold_margin_s
        ):
            return True
    return False


def _if_held(picture: TrafficPicture, conflict: PairConflict, number: int) -> Approach:
    """How near they come if this one of the two is held now and the other flies on."""
    ahead = picture.ahead_apart
    held, stays = (np.array([conflict.indices[index]]) for index in (number, 1 - number))
    gaps = closeness(ahead.if_held, held, ahead.as_it_flies, stays, conflict.need, conflict.unknown)
    return approach(gaps, 0, ahead.times_s)
