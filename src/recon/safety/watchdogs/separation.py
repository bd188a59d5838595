"""The separation watchdog: predicted loss of separation within the next seconds.

Theory of operation. No vehicle is predicted whose bound (`reach`) keeps it apart from all others.
Pairs whose reach within the horizon cannot bring them below the minima are dropped next
(`near_pairs`). For the rest the closest approach of the sampled trajectories is
computed, in shares of the minima: below 1 both the horizontal and the vertical one are violated.

    no conflict -> predicted: alarm -> lasted `confirm_s`, and the time left is what both need to
    stop and `hold_margin_s`: the one whose hold keeps them farther apart is held (`resolution`) ->
    still predicted after `effect_s`, or the other's own time to stop runs out: the other vehicle is
    held too, if that helps

The order of yielding, among what keeps them equally far apart: a vehicle in contact before a lost
one; one that lands or returns last, for its battery may not last; then the lower `priority` of the
profile first, then any vehicle before the imaging drone, then one under guidance before one under
operator control, then the later serial. A vehicle is held only if that helps: not one in front of a
faster one, nor one leaving a hazard area. A vehicle of a pilot is never held. Lost vehicles are
hazard areas, and may continue a mission.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from recon.model.arrays import BoolArray
from recon.model.control import AuthorityHolder
from recon.model.severity import Severity
from recon.safety.prediction import HazardArea, unknown_heights
from recon.safety.separation_minima import SeparationMinima
from recon.safety.watchdogs.closest_approach import (
    Approach,
    approach,
    closeness,
    hazard_closeness,
    near_pairs,
)
from recon.safety.watchdogs.reach import near_each_other
from recon.safety.watchdogs.resolution import (
    PairConflict,
    can_be_held,
    is_better,
    speed_mps,
    vehicle_to_hold,
)
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture, WatchedVehicle

RULE = "separation"
HOLDS_OFF = "holding is switched off"


def separation(picture: TrafficPicture) -> Iterator[Finding]:
    """Find the pairs of vehicles, and of vehicles and hazard areas, that come too near."""
    need, reaches = picture.minima, picture.reaches
    if reaches is not None:
        unknown = _unknown_heights(picture.flying)
        near = near_each_other(reaches, need, picture.settings.horizon_s, unknown)
        picture = picture.only(near)
    in_contact = len(picture.flying)
    if in_contact == 0:
        return
    for watched in picture.watched:
        if watched.hazard is not None:
            yield from _hazard(picture, watched, watched.hazard, need)
    if len(picture.predicted) < 2:
        return
    flies, times_s = picture.ahead_apart.as_it_flies, picture.ahead.times_s
    unknown = _unknown_heights(picture.predicted)
    first, second = near_pairs(flies, need, unknown)
    can_help = first < in_contact  # of two lost ones no hold can reach either
    first, second = first[can_help], second[can_help]
    if len(first) == 0:
        return
    gaps = closeness(flies, first, flies, second, need, unknown)
    for row in np.flatnonzero((gaps.closeness < 1.0).any(axis=1)):
        found = approach(gaps, row, times_s)
        yield _pair(picture, int(first[row]), int(second[row]), found, need)


def _unknown_heights(vehicles: Sequence[WatchedVehicle]) -> BoolArray | None:
    """Return the pairs whose heights cannot be compared, (V, V); None: no pair."""
    return unknown_heights([one.motion for one in vehicles if one.motion is not None])


def in_order_of_yielding(
    one: WatchedVehicle, other: WatchedVehicle
) -> tuple[WatchedVehicle, WatchedVehicle]:
    """Return the vehicles in order of yielding; one in contact yields before a lost one."""

    def rank(watched: WatchedVehicle) -> tuple[bool, bool, int, bool, bool]:
        profile = watched.state.profile
        priority = 0 if profile is None else profile.priority
        is_operators = watched.holder is not AuthorityHolder.GUIDANCE
        is_stale = watched.hazard is not None
        return is_stale, watched.is_coming_down, priority, watched.is_imager, is_operators

    later, earlier = sorted((one, other), key=lambda watched: watched.key, reverse=True)
    return (later, earlier) if rank(later) <= rank(earlier) else (earlier, later)


def _pair(
    picture: TrafficPicture, one: int, other: int, found: Approach, need: SeparationMinima
) -> Finding:
    both = picture.predicted[one], picture.predicted[other]
    ordered = in_order_of_yielding(*both)
    yielding, second = ordered
    indices = (one, other) if yielding is both[0] else (other, one)
    keys = sorted((yielding.key, second.key))
    key = f"{RULE}:{keys[0]}:{keys[1]}"
    held = None
    if _is_due(picture, key, found, yielding, second):
        unknown = _unknown_heights(picture.predicted)
        held = vehicle_to_hold(picture, PairConflict(ordered, indices, found, need, unknown))
    text = f"{_text(found, second.name + _lost_text(second))}{_outcome(picture, *both)}"
    return _finding(picture, key, yielding, text, found, held)


def _hazard(
    picture: TrafficPicture, lost: WatchedVehicle, hazard: HazardArea, need: SeparationMinima
) -> Iterator[Finding]:
    ahead = picture.ahead_apart
    pairs = _unknown_heights((*picture.predicted, lost))
    unknown = None if pairs is None else pairs[-1, :-1]
    flies = hazard_closeness(ahead.as_it_flies, ahead.times_s, hazard, need, unknown)
    rows = np.flatnonzero((flies.closeness[: len(picture.flying)] < 1.0).any(axis=1))
    if len(rows) == 0:
        return
    if_held = hazard_closeness(ahead.if_held, ahead.times_s, hazard, need, unknown)
    for row in rows:
        watched = picture.flying[row]
        found = approach(flies, row, ahead.times_s)
        instead = approach(if_held, row, ahead.times_s)
        key = f"{RULE}:{watched.key}:hazard area of {hazard.name}"
        is_due = _is_due(picture, key, found, watched)
        can = is_due and can_be_held(picture, watched)
        held = watched if can and is_better(picture.settings, found, instead) else None
        where = f"the hazard area of {hazard.name}, telemetry lost for {hazard.age_s:.0f} s"
        text = f"{_text(found, where)}{_outcome(picture, watched)}"
        yield _finding(picture, key, watched, text, found, held)


def _is_due(picture: TrafficPicture, key: str, found: Approach, *both: WatchedVehicle) -> bool:
    """Whether it is time to hold: the alarm has been there, and little more time is left than all
    of them need to stop, one after the other."""
    settings, prediction = picture.settings, picture.prediction
    assert found.in_s is not None
    stop_s = prediction.reaction_s + settings.hold_margin_s
    stop_s += sum(speed_mps(watched) for watched in both) / prediction.braking_mps2
    return picture.lasted_s(key) >= settings.confirm_s and found.in_s <= stop_s


def _text(found: Approach, what: str) -> str:
    assert found.in_s is not None
    how = "is too near" if found.in_s == 0.0 else f"comes too near in {found.in_s:.0f} s"
    apart = f"{found.horizontal_m:.0f} m, and {found.vertical_m:.0f} m in height"
    return f"{how} to {what}: {apart}"


def _lost_text(watched: WatchedVehicle) -> str:
    if watched.hazard is None:
        return ""
    return f" (telemetry lost for {watched.hazard.age_s:.0f} s, if it continues its mission)"


def _outcome(picture: TrafficPicture, *both: WatchedVehicle) -> str:
    """What has been done: what the station did, never what it is about to try."""
    if not picture.is_hold_on:
        return f"; {HOLDS_OFF}: act now"
    return "".join(f"; {one.name} {one.hold_outcome}" for one in both if one.hold_outcome)


def _finding(
    picture: TrafficPicture,
    key: str,
    watched: WatchedVehicle,
    text: str,
    found: Approach,
    held: WatchedVehicle | None,
) -> Finding:
    assert found.in_s is not None
    is_near = found.in_s <= picture.settings.near_s
    return Finding(
        key=key,
        rule=RULE,
        severity=Severity.CRITICAL if is_near else Severity.ERROR,
        vehicle_name=watched.name,
        text=f"{watched.name}: {text}",
        serial=watched.state.serial,
        link_id=watched.state.link_id,
        holds=None if held is None else held.state.serial,
    )
