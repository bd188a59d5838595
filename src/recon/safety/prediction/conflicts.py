"""Where and when one vehicle's trajectory comes too near to others'."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.safety.prediction.protected_volumes import ProtectedVolumes, cut
from recon.safety.prediction.trajectory import (
    EAST_0,
    FOREVER_S,
    NORTH_0,
    FlightPart,
    Trajectory,
    sample,
)
from recon.safety.prediction_settings import PredictionSettings
from recon.safety.separation_minima import SeparationMinima

_APART_S = 4.0 * FOREVER_S
"""Trajectories' times are placed one behind the other on one axis, this far apart."""

CLOSER_M = 0.5
"""Two vehicles led apart may seem this much nearer by the noise of their positions."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """The first violation of the minima to another trajectory, and the closest approach."""

    other: int
    """Index into the others' trajectories."""
    own_part: int
    other_part: int
    at_s: float
    horizontal_m: float
    vertical_m: float


def first_conflict(
    own: Trajectory,
    others: Sequence[Trajectory],
    need: SeparationMinima,
    settings: PredictionSettings,
    *,
    may_lead_apart: bool = True,
) -> Conflict | None:
    """Return where `own` first comes nearer than `need` to any other trajectory; None if it does
    not.

    To another that is too near already, for the first seconds only coming nearer counts, if `own`
    `may_lead_apart`: one on the ground is not in the air yet, and stays there.
    """
    if not others:
        return None
    mine, theirs = cut([own], settings), cut(others, settings)
    pairs = _pairs(mine, theirs)
    vertical_m = _vertical_gap_m(mine, theirs, pairs)
    pairs = _kept(pairs, (vertical_m < need.vertical_m) & _may_be_near(mine, theirs, pairs, need))
    if len(pairs.own) == 0:
        return None
    apart_m = _apart_m(mine, theirs, pairs)
    gap_m = apart_m - mine.radius_m[pairs.own] - theirs.radius_m[pairs.other]
    is_near = gap_m < need.horizontal_m
    now = _now(own, others, theirs, need)
    comes_nearer = apart_m < now.apart_m[pairs.trajectory] - CLOSER_M
    comes_nearer |= _comes_up_or_down_to(mine, pairs, now)
    is_conflict = is_near
    if may_lead_apart:
        is_conflict = is_near & (comes_nearer | ~_is_leaving(mine, settings)[pairs.own])
    if not is_conflict.any():
        return None
    met = _kept(pairs, is_conflict)
    same = met.trajectory == met.trajectory[0]
    for volumes, piece in ((mine, met.own), (theirs, met.other)):
        same &= volumes.part[piece] == volumes.part[piece[0]]
    vertical_m = _vertical_gap_m(mine, theirs, met)
    return Conflict(
        other=int(met.trajectory[0]),
        own_part=int(mine.part[met.own[0]]),
        other_part=int(theirs.part[met.other[0]]),
        at_s=max(0.0, float(mine.at_s[met.own[0]])),
        horizontal_m=max(0.0, float(gap_m[is_conflict][same].min())),
        vertical_m=max(0.0, float(vertical_m[same].min())),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Pairs:
    """Pieces that overlap in time, in order of mine: indices (P,) of mine, theirs and their
    trajectory."""

    own: IntArray
    other: IntArray
    trajectory: IntArray


def _kept(pairs: _Pairs, mask: BoolArray) -> _Pairs:
    return _Pairs(pairs.own[mask], pairs.other[mask], pairs.trajectory[mask])


def _pairs(mine: ProtectedVolumes, theirs: ProtectedVolumes) -> _Pairs:
    """Return the pairs of pieces that overlap in time; times ascend, so they lie together."""
    counts_of = np.diff(theirs.first)
    shift_s = np.arange(len(counts_of)) * _APART_S
    piece_shift_s = np.repeat(shift_s, counts_of)
    asked_early = mine.early_s[:, np.newaxis] + shift_s
    asked_late = mine.late_s[:, np.newaxis] + shift_s
    low = np.searchsorted(theirs.late_s + piece_shift_s, asked_early)
    high = np.searchsorted(theirs.early_s + piece_shift_s, asked_late, side="right")
    counts = np.maximum(high - low, 0).ravel()
    group = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)
    own, trajectory = np.divmod(group, len(counts_of))
    return _Pairs(own, low.ravel()[group] + step, trajectory)


def _vertical_gap_m(mine: ProtectedVolumes, theirs: ProtectedVolumes, pairs: _Pairs) -> FloatArray:
    below = theirs.low_m[pairs.other] - mine.high_m[pairs.own]
    above = mine.low_m[pairs.own] - theirs.high_m[pairs.other]
    gap: FloatArray = np.maximum(below, above)
    return gap


def _may_be_near(
    mine: ProtectedVolumes, theirs: ProtectedVolumes, pairs: _Pairs, need: SeparationMinima
) -> BoolArray:
    """Whether their boxes are: cheap, and right for all but the few that are then looked at."""
    reach_m = need.horizontal_m + mine.radius_m[pairs.own] + theirs.radius_m[pairs.other]
    mine_low, mine_high = _box(mine)
    their_low, their_high = _box(theirs)
    beyond_m = their_low[pairs.other] - mine_high[pairs.own]
    before_m = mine_low[pairs.own] - their_high[pairs.other]
    is_near: BoolArray = np.maximum(beyond_m, before_m).max(axis=1) < reach_m
    return is_near


def _box(volumes: ProtectedVolumes) -> tuple[FloatArray, FloatArray]:
    low: FloatArray = np.minimum(volumes.starts_m, volumes.ends_m)
    high: FloatArray = np.maximum(volumes.starts_m, volumes.ends_m)
    return low, high


def _apart_m(mine: ProtectedVolumes, theirs: ProtectedVolumes, pairs: _Pairs) -> FloatArray:
    """How far the straight lines of each pair are apart, (P,)."""
    return segments_apart_m(
        mine.starts_m[pairs.own],
        mine.ends_m[pairs.own],
        theirs.starts_m[pairs.other],
        theirs.ends_m[pairs.other],
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Now:
    """How near each other is now, (G,): how far apart horizontally, infinite if that is not too
    near; its lowest and highest height, and how far apart in height. What is not seen may be at
    any height, and is as near at one as at another."""

    apart_m: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    vertical_m: FloatArray


def _now(
    own: Trajectory, others: Sequence[Trajectory], theirs: ProtectedVolumes, need: SeparationMinima
) -> _Now:
    """How near the others are from here.

    Here is all the path since its last telemetry: a leaving vehicle was nearer then.
    """
    here = sample([own.rows], [0.0])
    now = sample([trajectory.rows for trajectory in others], [0.0])
    last_known_m = own.rows[:1, [EAST_0, NORTH_0]]
    place_m = np.column_stack([here.east_m[:, 0], here.north_m[:, 0]])
    starts_m = np.column_stack([now.east_m[:, 0], now.north_m[:, 0]])
    ends_m = starts_m.copy()
    radius_m = now.radius_m[:, 0]
    # A hazard area is all of its route home now, and as wide as it may grow.
    whole = theirs.first[:-1]
    is_hazard = theirs.part[whole] == FlightPart.HAZARD
    starts_m[is_hazard] = theirs.starts_m[whole[is_hazard]]
    ends_m[is_hazard] = theirs.ends_m[whole[is_hazard]]
    radius_m = np.where(is_hazard, theirs.radius_m[whole], radius_m)
    last_known_m, place_m = (
        np.broadcast_to(each, starts_m.shape) for each in (last_known_m, place_m)
    )
    apart_m = segments_apart_m(last_known_m, place_m, starts_m, ends_m)
    gap_m = apart_m - radius_m  # its own place is known now, how far a turn may lead is not counted
    low_m, high_m = np.array([trajectory.here_m for trajectory in others]).T
    vertical_m = np.maximum(low_m - own.here_m[1], own.here_m[0] - high_m)
    is_near = (gap_m < need.horizontal_m) & (vertical_m < need.vertical_m)
    return _Now(
        apart_m=np.where(is_near, apart_m, np.inf),
        low_m=low_m,
        high_m=high_m,
        vertical_m=np.where(is_hazard, -np.inf, vertical_m),
    )


def _is_leaving(mine: ProtectedVolumes, settings: PredictionSettings) -> BoolArray:
    """Which pieces are of the time for leading apart; what stays for long does not leave."""
    leaving: BoolArray = (mine.at_s < settings.escape_s) & (mine.until_s < 2.0 * settings.escape_s)
    return leaving


def _comes_up_or_down_to(mine: ProtectedVolumes, pairs: _Pairs, now: _Now) -> BoolArray:
    """Whether a piece is nearer in height to where the other is now than here is."""
    below_m = now.low_m[pairs.trajectory] - mine.high_m[pairs.own]
    above_m = mine.low_m[pairs.own] - now.high_m[pairs.trajectory]
    nearer: BoolArray = np.maximum(below_m, above_m) < now.vertical_m[pairs.trajectory] - CLOSER_M
    return nearer


def segments_apart_m(p0: FloatArray, p1: FloatArray, q0: FloatArray, q1: FloatArray) -> FloatArray:
    """Return how far apart the segments p0-p1 and q0-q1 are, each (P, 2); 0 where they cross."""
    nearest = np.minimum(
        np.minimum(_to_segment_m(p0, q0, q1), _to_segment_m(p1, q0, q1)),
        np.minimum(_to_segment_m(q0, p0, p1), _to_segment_m(q1, p0, p1)),
    )
    crosses = (_side(p0, p1, q0) * _side(p0, p1, q1) < 0.0) & (
        _side(q0, q1, p0) * _side(q0, q1, p1) < 0.0
    )
    apart: FloatArray = np.where(crosses, 0.0, nearest)
    return apart


def _to_segment_m(point: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    along = end - start
    to_point = point - start
    squared = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip((to_point * along).sum(axis=1) / squared, 0.0, 1.0)
    off = to_point - share[:, np.newaxis] * along
    far: FloatArray = np.hypot(off[:, 0], off[:, 1])
    return far


def _side(start: FloatArray, end: FloatArray, point: FloatArray) -> FloatArray:
    """Return on which side of the line each point lies: positive left, negative right."""
    along, to_point = end - start, point - start
    side: FloatArray = along[:, 0] * to_point[:, 1] - along[:, 1] * to_point[:, 0]
    return side
