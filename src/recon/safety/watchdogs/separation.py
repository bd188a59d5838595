"""Keeps vehicles in the air apart: alarms ten seconds ahead, and holds in time.

First an alarm. When what is left is little more than the time that both need to stop, the vehicle
of lower priority is held; while the conflict stays predicted although that hold has had its time to
show, or when the other's own time to stop runs out, the other one too.

Who yields: first the one with the lower `priority` in its profile, then any other before the eye,
then what guidance leads before what an operator leads, then the later serial. A vehicle that lands
or returns yields last, for it is leaving the air and its battery may not last. And nobody is held
whom that does not help: the one in front of a faster one behind, one that flies out of a hazard
area's circle, one that lands out of another's way. What a pilot leads is never held, only alarmed
about; what is on the ground is neither held nor a reason to hold.
"""

from collections.abc import Iterator

import numpy as np

from recon.model.authority import AuthorityHolder
from recon.model.severity import Severity
from recon.safety.prediction import HazardArea
from recon.safety.separation_minima import SeparationMinima
from recon.safety.watchdogs.closest_approach import (
    Approach,
    IntArray,
    approach,
    closeness,
    hazard_closeness,
    near_pairs,
)
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture, WatchedVehicle

RULE = "separation"
HOLDS_OFF = "holding is switched off"


def separation(picture: TrafficPicture) -> Iterator[Finding]:
    """Find the pairs of vehicles, and of vehicles and hazard areas, that come too near."""
    if not picture.flying:
        return
    need, heard = (
        picture.minima,
        len(picture.flying),
    )
    for watched in picture.watched:
        if watched.hazard is not None:
            yield from _hazard(picture, watched.hazard, need)
    if len(picture.predicted) < 2:
        return
    flies, times_s = picture.ahead.as_it_flies, picture.ahead.times_s
    first, second = near_pairs(flies, need)
    if len(first) == 0:
        return
    close, horizontal_m, vertical_m = closeness(flies, first, flies, second, need)
    for row in np.flatnonzero((close < 1.0).any(axis=1)):
        if min(first[row], second[row]) >= heard:
            continue  # nobody hears either: there is nothing to be done
        found = approach(close[row], horizontal_m[row], vertical_m[row], times_s)
        yield _pair(picture, int(first[row]), int(second[row]), found, need)


def in_order_of_yielding(
    one: WatchedVehicle, other: WatchedVehicle
) -> tuple[WatchedVehicle, WatchedVehicle]:
    """Return who yields first and who second: always who is heard before who is not."""

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
    yielding, second = in_order_of_yielding(*both)
    indices = {id(both[0]): one, id(both[1]): other}
    keys = sorted((yielding.key, second.key))
    key = f"{RULE}:{keys[0]}:{keys[1]}"
    held = None
    if _is_due(picture, key, found, yielding, second):
        for candidate, stays in ((yielding, second), (second, yielding)):
            pair = np.array([indices[id(candidate)]]), np.array([indices[id(stays)]])
            if _may_wait(picture, candidate, stays, found):
                break
            if _can_be_held(picture, candidate) and _helps(picture, pair, found, need):
                held = candidate
                break
    text = f"{_text(found, second.name + _lost_text(second))}{_outcome(picture, *both)}"
    return _finding(picture, key, yielding, text, found, held)


def _hazard(
    picture: TrafficPicture, hazard: HazardArea, need: SeparationMinima
) -> Iterator[Finding]:
    ahead = picture.ahead
    flies = hazard_closeness(ahead.as_it_flies, ahead.times_s, hazard, need)
    rows = np.flatnonzero((flies[0][: len(picture.flying)] < 1.0).any(axis=1))
    if len(rows) == 0:
        return
    if_held = hazard_closeness(ahead.if_held, ahead.times_s, hazard, need)
    for row in rows:
        watched = picture.flying[row]
        found = approach(flies[0][row], flies[1][row], flies[2][row], ahead.times_s)
        instead = approach(if_held[0][row], if_held[1][row], if_held[2][row], ahead.times_s)
        key = f"{RULE}:{watched.key}:hazard area of {hazard.name}"
        is_due = _is_due(picture, key, found, watched)
        can = is_due and _can_be_held(picture, watched) and _is_better(picture, found, instead)
        held = watched if can else None
        where = f"where {hazard.name} may be, which has not been heard for {hazard.age_s:.0f} s"
        text = f"{_text(found, where)}{_outcome(picture, watched)}"
        yield _finding(picture, key, watched, text, found, held)


def _is_due(picture: TrafficPicture, key: str, found: Approach, *both: WatchedVehicle) -> bool:
    """Whether it is time to hold: the alarm has been there, and little more time is left than all
    of them need to stop, one after the other."""
    settings, prediction = picture.settings, picture.prediction
    assert found.in_s is not None
    stop_s = prediction.reaction_s + settings.hold_margin_s
    stop_s += sum(_speed_mps(watched) for watched in both) / prediction.braking_mps2
    return picture.lasted_s(key) >= settings.confirm_s and found.in_s <= stop_s


def _may_wait(
    picture: TrafficPicture, candidate: WatchedVehicle, stays: WatchedVehicle, found: Approach
) -> bool:
    """Whether a hold just given may still show before the other one has to stop too."""
    settings, prediction = picture.settings, picture.prediction
    if not candidate.was_held_within_s(picture.now_ns, settings.effect_s):
        return False
    assert found.in_s is not None
    needs_s = prediction.reaction_s + _speed_mps(stays) / prediction.braking_mps2
    return found.in_s > needs_s + 0.5 * settings.hold_margin_s


def _can_be_held(picture: TrafficPicture, candidate: WatchedVehicle) -> bool:
    if not picture.is_hold_on or not candidate.may_be_held:
        return False
    return not candidate.was_held_within_s(picture.now_ns, picture.settings.hold_again_s)


def _helps(
    picture: TrafficPicture,
    pair: tuple[IntArray, IntArray],
    found: Approach,
    need: SeparationMinima,
) -> bool:
    """Whether the first of the pair, held, comes less near to the second, which flies on."""
    ahead = picture.ahead
    close, horizontal_m, vertical_m = closeness(
        ahead.if_held, pair[0], ahead.as_it_flies, pair[1], need
    )
    instead = approach(close[0], horizontal_m[0], vertical_m[0], ahead.times_s)
    return _is_better(picture, found, instead)


def _is_better(picture: TrafficPicture, found: Approach, instead: Approach) -> bool:
    settings = picture.settings
    if instead.in_s is None:
        return True
    assert found.in_s is not None
    if instead.in_s >= found.in_s + settings.helps_s:
        return True
    is_no_sooner = instead.in_s >= found.in_s
    return is_no_sooner and instead.least >= found.least + settings.helps_share


def _speed_mps(watched: WatchedVehicle) -> float:
    return 0.0 if watched.motion is None else watched.motion.speed_mps


def _text(found: Approach, what: str) -> str:
    assert found.in_s is not None
    how = "is too near" if found.in_s == 0.0 else f"comes too near in {found.in_s:.0f} s"
    apart = f"{found.horizontal_m:.0f} m, and {found.vertical_m:.0f} m in height"
    return f"{how} to {what}: {apart}"


def _lost_text(watched: WatchedVehicle) -> str:
    if watched.hazard is None:
        return ""
    return f" (not heard for {watched.hazard.age_s:.0f} s, if it flies its mission on)"


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
