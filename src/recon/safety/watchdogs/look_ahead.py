"""The next seconds of every vehicle in the air: as it flies now, and as it would brake from now."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from math import hypot

import numpy as np

from recon.model.arrays import FloatArray
from recon.model.control import Commanded, Intent
from recon.model.mission import DJI
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode
from recon.safety.go_home import is_off_track
from recon.safety.prediction import PredictionSettings, Predictor, VehicleMotion
from recon.safety.prediction.legs import VERTICAL_BRAKING_MPS2, Point
from recon.safety.prediction.trajectory import FlightPart, Row, Samples, sample
from recon.safety.settings import WatchdogSettings

ASIDE_COSINE = 0.64
"""A vehicle that flies faster than `ASIDE_MPS` at more than 50 degrees from every commanded
direction, does something else: a pilot's stick turns a mission without changing its mode, and the
wind carries off what cannot fly against it. A rounded right angle is never farther from both its
legs than 45 degrees."""
ASIDE_MPS = 2.0
LEAST_DIRECTION_M = 1.0
"""A nearer place has no direction worth comparing."""

_MODES = {
    Commanded.MISSION: frozenset({FlightMode.GPS_WAYPOINT}),
    Commanded.STICK: frozenset({FlightMode.JOYSTICK}),
    Commanded.RETURN: frozenset(
        {FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING}
    ),
}
"""The flight modes that fit each commanded motion; an unknown mode may fit."""


@dataclass(frozen=True, slots=True)
class Braking:
    """A hold was commanded this long ago, at this speed."""

    since_s: float
    speed_mps: float


@dataclass(frozen=True, eq=False)
class LookAhead:
    """V vehicles at K moments: `times_s` (K,), and where they are at each of them."""

    times_s: FloatArray
    as_it_flies: Samples
    prediction: PredictionSettings

    @cached_property
    def if_held(self) -> Samples:
        """Where they are when they are held now; asked only once something comes too near."""
        return _held(self.as_it_flies, self.times_s, self.prediction)


def look_ahead(
    rows: Sequence[Sequence[Row]], settings: WatchdogSettings, prediction: PredictionSettings
) -> LookAhead:
    """Return the next seconds of trajectories, of which there must be one."""
    times_s = _moments_s(settings)
    return LookAhead(times_s, sample(rows, times_s), prediction)


@lru_cache(maxsize=1)
def _moments_s(settings: WatchdogSettings) -> FloatArray:
    count = round(settings.horizon_s / settings.sample_s) + 1
    moments_s = np.linspace(0.0, settings.horizon_s, count)
    moments_s.setflags(write=False)
    return moments_s


def next_rows(
    motion: VehicleMotion,
    intent: Intent,
    braking: Braking | None,
    horizon_s: float,
    now_ns: int,
    prediction: PredictionSettings,
) -> list[Row]:
    """Return a vehicle's trajectory for the next seconds.

    One that follows its intent is predicted along its path, around corners and into stops. Any
    other is predicted straight on at its present velocity.
    """
    predictor = Predictor(motion, prediction, until_s=horizon_s, exactly=True)
    if not _flies_as_commanded(motion, intent, braking, now_ns, prediction):
        predictor.go_straight_on(horizon_s + motion.age_s, FlightPart.FREE)
    elif intent.commanded is Commanded.HOLD:
        since_s = (now_ns - intent.since_ns) / NS_PER_S
        predictor.hold(max(0.0, prediction.reaction_s - since_s))
    else:
        predictor.follow(intent)
    return predictor.writer.rows


def _flies_as_commanded(
    motion: VehicleMotion,
    intent: Intent,
    braking: Braking | None,
    now_ns: int,
    prediction: PredictionSettings,
) -> bool:
    commanded = intent.commanded
    if commanded is Commanded.NOTHING:
        return False
    if commanded in (Commanded.HOLD, Commanded.LAND):
        since_s = (now_ns - intent.since_ns) / NS_PER_S
        return _brakes(motion, braking or Braking(since_s, DJI.max_speed_mps), prediction)
    mode = motion.state.flight_mode.value
    if mode is not None and mode not in _MODES[commanded]:
        return False
    return not (_flies_aside(motion, intent) or is_off_track(motion.state))


def _brakes(motion: VehicleMotion, braking: Braking, prediction: PredictionSettings) -> bool:
    """Whether it is no faster than one that brakes as it should, with twice the reaction's time."""
    braked_s = max(0.0, braking.since_s - 2.0 * prediction.reaction_s)
    expected_mps = max(0.0, braking.speed_mps - prediction.braking_mps2 * braked_s)
    return motion.speed_mps <= expected_mps + ASIDE_MPS


def _flies_aside(motion: VehicleMotion, intent: Intent) -> bool:
    if motion.speed_mps < ASIDE_MPS:
        return False
    directions = [
        each for each in _commanded_directions(motion, intent) if hypot(*each) >= LEAST_DIRECTION_M
    ]
    least_mps = ASIDE_COSINE * motion.speed_mps
    return bool(directions) and all(_along_mps(motion, each) < least_mps for each in directions)


def _along_mps(motion: VehicleMotion, path_m: Point) -> float:
    east_mps, north_mps, _up_mps = motion.velocity_mps
    return (path_m[0] * east_mps + path_m[1] * north_mps) / hypot(*path_m)


def _commanded_directions(motion: VehicleMotion, intent: Intent) -> Iterator[Point]:
    """The directions that it may be flying in: to its target, and at a mission's waypoint
    along the legs before and after, whichever it has come to."""
    here_m = motion.east_m, motion.north_m
    if intent.mission is not None:
        first = max(0, intent.passed - 2)
        waypoints = intent.mission.waypoints[first : intent.passed + 2]
        stops_m = [motion.plane.east_north_m(waypoint) for waypoint in waypoints]
        yield from (_direction(here_m, stop_m) for stop_m in stops_m[intent.passed - first :][:1])
        yield from (_direction(a_m, b_m) for a_m, b_m in pairwise(stops_m))
    elif intent.target is not None:
        yield _direction(here_m, motion.plane.east_north_m(intent.target))
    elif intent.commanded is Commanded.RETURN and motion.home_m is not None:
        yield _direction(here_m, motion.home_m)


def _direction(from_m: Point, to_m: Point) -> Point:
    return to_m[0] - from_m[0], to_m[1] - from_m[1]


def _held(flies: Samples, times_s: FloatArray, prediction: PredictionSettings) -> Samples:
    """The same vehicles if held now: they fly on for the reaction time and brake."""
    last = int(np.searchsorted(times_s, prediction.reaction_s))
    step_s = float(times_s[1])
    flown = np.minimum(np.arange(len(times_s)), last)
    braked_s = times_s - times_s[flown]

    def speed_mps(values: FloatArray) -> FloatArray:
        return (values[:, last] - values[:, last - 1])[:, np.newaxis] / step_s

    def brakes(values: FloatArray, mps2: FloatArray | float) -> FloatArray:
        """Extrapolate each value at its speed at `last`, which falls to zero."""
        mps = speed_mps(values)
        lasts_s = np.minimum(braked_s, np.abs(mps) / np.maximum(mps2, 1e-9))
        gone: FloatArray = mps * lasts_s - 0.5 * np.sign(mps) * mps2 * lasts_s**2
        return values[:, flown] + gone

    east_mps, north_mps = speed_mps(flies.east_m), speed_mps(flies.north_m)
    both_mps = np.maximum(np.hypot(east_mps, north_mps), 1e-9)
    brakes_mps2 = prediction.braking_mps2
    return Samples(
        east_m=brakes(flies.east_m, brakes_mps2 * np.abs(east_mps) / both_mps),
        north_m=brakes(flies.north_m, brakes_mps2 * np.abs(north_mps) / both_mps),
        low_m=brakes(flies.low_m, VERTICAL_BRAKING_MPS2),
        high_m=brakes(flies.high_m, VERTICAL_BRAKING_MPS2),
        radius_m=flies.radius_m,
    )
