"""Trajectories cut into pieces that are compared in space and time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from recon.model.arrays import FloatArray, IntArray
from recon.safety.prediction.trajectory import (
    CURVE,
    EAST_0,
    EAST_1,
    END_S,
    FOREVER_S,
    HIGH_0,
    HIGH_1,
    LOW_0,
    LOW_1,
    NORTH_0,
    NORTH_1,
    PART,
    RADIUS_0,
    RADIUS_1,
    START_S,
    FlightPart,
    Trajectory,
)
from recon.safety.prediction_settings import PredictionSettings

MOST_PIECES = 400
"""Most pieces of one row: enough for 2 km at walking pace; slower rows get longer pieces."""


@dataclass(frozen=True, slots=True, eq=False)
class ProtectedVolumes:
    """N pieces of trajectories: within the time from `early_s` to `late_s` the vehicle may be
    anywhere
    within `radius_m` of the straight line and between the two heights. Each array is (N,).

    `at_s` is when it is thought to enter the piece, `until_s` when to leave it. `first` (G + 1,)
    is the index at which each trajectory begins.
    """

    early_s: FloatArray
    late_s: FloatArray
    at_s: FloatArray
    until_s: FloatArray
    starts_m: FloatArray
    """(N, 2)"""
    ends_m: FloatArray
    """(N, 2)"""
    low_m: FloatArray
    high_m: FloatArray
    radius_m: FloatArray
    part: FloatArray
    first: IntArray


def cut(trajectories: Sequence[Trajectory], settings: PredictionSettings) -> ProtectedVolumes:
    """Return the trajectories in pieces, each with the time it may be flown in."""
    rows = np.concatenate([trajectory.rows for trajectory in trajectories])
    counts = np.array([len(trajectory.rows) for trajectory in trajectories])
    delays_s = np.repeat([trajectory.delay_s for trajectory in trajectories], counts)
    pieces = _pieces(rows, settings)
    index = np.repeat(np.arange(len(rows)), pieces)
    number = np.arange(len(index)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    found, of = rows[index], pieces[index]
    lasts_s = found[:, END_S] - found[:, START_S]
    start, end = number / of, (number + 1) / of
    share_0, share_1 = _share(found, start, lasts_s), _share(found, end, lasts_s)
    enters_s = found[:, START_S] + start * lasts_s
    leaves_s = found[:, START_S] + end * lasts_s
    row_first = np.concatenate([[0], np.cumsum(pieces)])
    return ProtectedVolumes(
        early_s=_earlier(enters_s, settings),
        late_s=_later(leaves_s, settings) + delays_s[index],
        at_s=enters_s,
        until_s=leaves_s,
        starts_m=_place(found, share_0),
        ends_m=_place(found, share_1),
        low_m=_extreme(found, LOW_0, LOW_1, share_0, share_1, np.minimum),
        high_m=_extreme(found, HIGH_0, HIGH_1, share_0, share_1, np.maximum),
        radius_m=_extreme(found, RADIUS_0, RADIUS_1, start, end, np.maximum),
        part=found[:, PART],
        first=row_first[np.concatenate([[0], np.cumsum(counts)])],
    )


def latest_s(trajectory: Trajectory, settings: PredictionSettings) -> float:
    """Return the latest time at which any of a trajectory may be flown: its delay included."""
    end_s = trajectory.rows[-1:, END_S]
    return float(_later(end_s, settings)[0]) + trajectory.delay_s


def latest_entry_s(until_s: float, settings: PredictionSettings) -> float:
    """Return how late a piece may be thought to begin that is flown by then all the same: it may be
    flown early."""
    steady = 1.0 - settings.time_uncertainty
    if steady <= 0.0:
        return FOREVER_S
    return min(FOREVER_S, (until_s + settings.slack_s) / steady)


def _pieces(rows: FloatArray, settings: PredictionSettings) -> IntArray:
    """How many pieces each row needs; what does not move needs one."""
    lasts_s = rows[:, END_S] - rows[:, START_S]
    piece_s = np.maximum(settings.piece_s, settings.time_uncertainty * rows[:, START_S])
    moved = (rows[:, EAST_0] != rows[:, EAST_1]) | (rows[:, NORTH_0] != rows[:, NORTH_1])
    sinks = (rows[:, LOW_0] != rows[:, LOW_1]) | (rows[:, HIGH_0] != rows[:, HIGH_1])
    grows = rows[:, RADIUS_0] != rows[:, RADIUS_1]
    moves = (moved | sinks | grows) & (rows[:, PART] != FlightPart.HAZARD)
    wanted = np.where(moves, np.ceil(lasts_s / piece_s), 1.0)
    return np.clip(wanted, 1, MOST_PIECES).astype(np.int64)


def _share(found: FloatArray, in_time: FloatArray, lasts_s: FloatArray) -> FloatArray:
    """How far along its row each is, at a share of the row's time."""
    bend = found[:, CURVE] * lasts_s**2
    share: FloatArray = (1.0 - bend) * in_time + bend * in_time**2
    return share


def _place(found: FloatArray, share: FloatArray) -> FloatArray:
    east = found[:, EAST_0] + share * (found[:, EAST_1] - found[:, EAST_0])
    north = found[:, NORTH_0] + share * (found[:, NORTH_1] - found[:, NORTH_0])
    return np.column_stack([east, north])


def _extreme(
    found: FloatArray,
    start: int,
    end: int,
    share_0: FloatArray,
    share_1: FloatArray,
    pick: np.ufunc,
) -> FloatArray:
    change = found[:, end] - found[:, start]
    value: FloatArray = pick(found[:, start] + share_0 * change, found[:, start] + share_1 * change)
    return value


def _earlier(at_s: FloatArray, settings: PredictionSettings) -> FloatArray:
    return at_s - settings.time_uncertainty * np.maximum(at_s, 0.0) - _slack_s(at_s, settings)


def _later(at_s: FloatArray, settings: PredictionSettings) -> FloatArray:
    return at_s + settings.time_uncertainty * np.maximum(at_s, 0.0) + _slack_s(at_s, settings)


def _slack_s(at_s: FloatArray, settings: PredictionSettings) -> FloatArray:
    """Grows in the first seconds: now's place is known."""
    slack_s: FloatArray = np.clip(0.5 + 0.5 * at_s, 0.5, settings.slack_s)
    return slack_s
