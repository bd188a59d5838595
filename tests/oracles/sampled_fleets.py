"""An independent, slow model of the separation rule: every instant against every other.

The rule as SAFETY.md and the prediction's settings state it. An order to move is predicted to its
end, and so is everything that flies, from its state and its last command. Both may be anywhere on
their paths a tenth of the time earlier or later, and some seconds (`sampled_flights`); a mission
that has not started may also start 8 s late. Whenever both may be there together they must be apart
by the horizontal or by the vertical distance. Two that are too near already may separate: for 20 s
only what is nearer than now counts (or than at the last telemetry), half a metre of noise and what
the present velocity carries aside. A vehicle with lost telemetry is as near as its widest volume.

The margin is the larger of both distances' room, at the worst pair of instants: positive, kept;
negative, broken. Uses nothing of `recon.safety` or `recon.geo`.
"""

from dataclasses import dataclass

import numpy as np
from tests.oracles.sampled_flights import (
    AT_S,
    CARRIED_M,
    EARLY_S,
    EAST,
    HIGH,
    LATE_S,
    LOW,
    NORTH,
    PIECE_S,
    RADIUS,
    STEP_M,
    STEP_S,
    Flight,
    FloatArray,
)

ESCAPE_S = 20.0
CLOSER_M = 0.5
BETWEEN_SAMPLES_M = STEP_M + 0.3
"""Half a step of either, and what the plane's scale and rounding come to."""
FAR_M = 8.0
"""What is farther apart than needed by more is not looked at closely."""


@dataclass(frozen=True, slots=True)
class Need:
    """What two vehicles must keep: the one horizontally, or the other vertically."""

    horizontal_m: float
    vertical_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """One vehicle's path, or the volume of one with lost telemetry, in both readings.

    `now` is (N, 9) samples of where it is now; for a volume, where its middle may be. `lately` is
    its way from its last telemetry to there.
    """

    kind: str
    certain: FloatArray
    possible: FloatArray
    now: FloatArray
    lately: FloatArray

    @staticmethod
    def of(kind: str, flight: Flight) -> "Course":
        """A flight's."""
        certain = flight.certain
        now = _now(certain)
        lately = np.concatenate([certain[certain[:, AT_S] < 0.0], now])
        late_s = flight.begins_late_s
        return Course(kind, _later(certain, late_s), _later(flight.possible, late_s), now, lately)

    @staticmethod
    def around(kind: str, volume: FloatArray) -> "Course":
        """A hidden vehicle's."""
        return Course(kind, volume, volume, volume, volume)


@dataclass(frozen=True, slots=True)
class Margin:
    """By how much an order keeps apart from one other, at their worst pair of instants, by the two
    readings of `sampled_flights`."""

    kind: str
    certain_m: float
    possible_m: float

    @property
    def is_broken(self) -> bool:
        """Whether a vehicle that flies as commanded certainly comes too near."""
        return self.certain_m < -BETWEEN_SAMPLES_M

    @property
    def is_kept(self) -> bool:
        """Whether nothing that may be counted comes too near, for sure."""
        return self.possible_m > BETWEEN_SAMPLES_M


def margin(own: Course, other: Course, need: Need) -> Margin:
    """Return the margins of an order's course to another course."""
    near_m, doubt = _near_now_m(own, other, need)
    certain_m = _worst_m(own.certain, other.certain, need, near_m, ESCAPE_S + PIECE_S)
    possible_m = _worst_m(own.possible, other.possible, need, near_m, ESCAPE_S)
    if doubt:  # whether only nearer counts is not known
        strictest_m = _worst_m(own.possible, other.possible, need, np.inf, 0.0)
        return Margin(other.kind, max(certain_m, 0.0), min(possible_m, strictest_m))
    return Margin(other.kind, certain_m, possible_m)


def _near_now_m(own: Course, other: Course, need: Need) -> tuple[float, bool]:
    """How far apart two are that are too near now, else infinite; and whether that is in doubt."""
    apart_m = float(_apart_m(own.lately, other.now).min())
    gap_m = apart_m - float(other.now[0, RADIUS])
    vertical_m = float(_vertical_m(own.now, other.now).min())
    room_m = max(gap_m - need.horizontal_m, vertical_m - need.vertical_m)
    known_m = BETWEEN_SAMPLES_M + float(own.now[0, CARRIED_M])
    return apart_m if room_m < 0.0 else np.inf, abs(room_m) < known_m


def _worst_m(
    own: FloatArray,
    other: FloatArray,
    need: Need,
    near_now_m: float,
    leaving_s: float,
) -> float:
    own, other = _near(own, other, need), _near(other, own, need)
    if not len(own) or not len(other):
        return FAR_M
    together = own[:, np.newaxis, EARLY_S] <= other[:, LATE_S]
    together &= other[:, EARLY_S] <= own[:, np.newaxis, LATE_S]
    mine, theirs = np.nonzero(together)
    if not len(mine):
        return FAR_M
    own, other = own[mine], other[theirs]
    apart_m = np.hypot(own[:, EAST] - other[:, EAST], own[:, NORTH] - other[:, NORTH])
    beside_m = apart_m - own[:, RADIUS] - other[:, RADIUS] - need.horizontal_m
    above_m = np.maximum(own[:, LOW] - other[:, HIGH], other[:, LOW] - own[:, HIGH])
    room_m = np.maximum(beside_m, above_m - need.vertical_m)
    if np.isfinite(near_now_m):
        farther_m = apart_m + own[:, CARRIED_M] - (near_now_m - CLOSER_M)
        leaving = own[:, AT_S] < leaving_s
        room_m = np.where(leaving, np.maximum(room_m, farther_m), room_m)
    return min(FAR_M, float(room_m.min()))


def _now(samples: FloatArray) -> FloatArray:
    """The sample (1, 9) that a vehicle is in now, between two where it lies between."""
    in_order = samples[np.argsort(samples[:, AT_S], kind="stable")]
    after = int(np.searchsorted(in_order[:, AT_S], 0.0, side="right"))
    before = max(0, after - 1)
    stays = in_order[before, LATE_S] > STEP_S
    if stays or after == len(in_order):
        return in_order[before : before + 1]
    spans_s = max(in_order[after, AT_S] - in_order[before, AT_S], 1e-9)
    share = np.clip(-in_order[before, AT_S] / spans_s, 0.0, 1.0)
    between: FloatArray = in_order[before] + share * (in_order[after] - in_order[before])
    return between[np.newaxis]


def _later(samples: FloatArray, seconds: float) -> FloatArray:
    """The samples as they are when all may also be flown so much later."""
    samples[:, LATE_S] += seconds
    return samples


def _near(samples: FloatArray, others: FloatArray, need: Need) -> FloatArray:
    """Those samples that are near the box round the others; the rest is far enough away."""
    wide_m = need.horizontal_m + FAR_M + samples[:, RADIUS]
    near = np.ones(len(samples), dtype=bool)
    for axis in (EAST, NORTH):
        near &= samples[:, axis] + wide_m > (others[:, axis] - others[:, RADIUS]).min(initial=1e9)
        near &= samples[:, axis] - wide_m < (others[:, axis] + others[:, RADIUS]).max(initial=-1e9)
    near &= samples[:, HIGH] + need.vertical_m + FAR_M > others[:, LOW].min(initial=1e9)
    near &= samples[:, LOW] - need.vertical_m - FAR_M < others[:, HIGH].max(initial=-1e9)
    return samples[near]


def _apart_m(samples: FloatArray, others: FloatArray) -> FloatArray:
    offset_m = samples[:, np.newaxis, [EAST, NORTH]] - others[:, [EAST, NORTH]]
    apart_m: FloatArray = np.hypot(offset_m[..., 0], offset_m[..., 1])
    return apart_m


def _vertical_m(samples: FloatArray, others: FloatArray) -> FloatArray:
    below_m = others[:, LOW] - samples[:, np.newaxis, HIGH]
    above_m = samples[:, np.newaxis, LOW] - others[:, HIGH]
    return np.maximum(below_m, above_m)
