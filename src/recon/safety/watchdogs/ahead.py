"""The next seconds of every vehicle in the air: as it flies now, and as it would brake from now."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from recon.model.intent import Commanded, Intent
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode
from recon.safety.prediction import Flyer, Follower, PredictionSettings
from recon.safety.prediction.course import FloatArray, Part, Row
from recon.safety.prediction.legs import VERTICAL_BRAKING_MPS2
from recon.safety.prediction.sampling import Samples, sample
from recon.safety.watch_settings import WatchSettings

FASTEST_TOLD_MPS = 15.0
"""Of a vehicle told to hold, when nobody has noted how fast it was: no order flies faster."""

AGAINST_COSINE = -0.2
"""A vehicle that flies faster than `AGAINST_MPS` at more than 100 degrees from where it was told
to go, does something else: a pilot's stick reverses a mission without changing its mode."""
AGAINST_MPS = 2.0

_MODES = {
    Commanded.MISSION: frozenset({FlightMode.GPS_WAYPOINT}),
    Commanded.STICK: frozenset({FlightMode.JOYSTICK}),
    Commanded.RETURN: frozenset(
        {FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING}
    ),
}
"""The modes of vehicles that do what they were told; while the mode is unknown they may."""


@dataclass(frozen=True, slots=True)
class Braking:
    """A vehicle was told to stop so long ago, when it was so fast."""

    since_s: float
    speed_mps: float


@dataclass(frozen=True, slots=True, eq=False)
class Ahead:
    """V vehicles at K moments: `times_s` (K,), and where they are at each of them."""

    times_s: FloatArray
    as_it_flies: Samples
    if_held: Samples


def look_ahead(
    rows: Sequence[Sequence[Row]], settings: WatchSettings, prediction: PredictionSettings
) -> Ahead:
    """Return the next seconds of courses; of none, arrays without vehicles."""
    count = round(settings.horizon_s / settings.sample_s) + 1
    times_s = np.linspace(0.0, settings.horizon_s, count)
    if not rows:
        none = Samples(*(np.zeros((0, count)) for _ in range(5)))
        return Ahead(times_s, none, none)
    as_it_flies = sample(rows, times_s)
    return Ahead(times_s, as_it_flies, _held(as_it_flies, times_s, prediction))


def next_rows(
    flyer: Flyer,
    intent: Intent,
    braking: Braking | None,
    horizon_s: float,
    now_ns: int,
    prediction: PredictionSettings,
) -> list[Row]:
    """Return a vehicle's course for the next seconds.

    One that does as it was told is followed along its way, around corners and into stops. Any other
    flies on as it does now: the longer one looks, the less it will, but nobody knows better.
    """
    follower = Follower(flyer, prediction, until_s=horizon_s, exactly=True)
    if not _flies_as_told(flyer, intent, braking, now_ns, prediction):
        follower.go_straight_on(horizon_s + flyer.age_s, Part.FREE)
    elif intent.commanded is Commanded.HOLD:
        since_s = (now_ns - intent.since_ns) / NS_PER_S
        follower.hold(max(0.0, prediction.reaction_s - since_s))
    else:
        follower.follow(intent)
    return follower.writer.rows


def _flies_as_told(
    flyer: Flyer,
    intent: Intent,
    braking: Braking | None,
    now_ns: int,
    prediction: PredictionSettings,
) -> bool:
    told = intent.commanded
    if told is Commanded.NOTHING:
        return False
    if told in (Commanded.HOLD, Commanded.LAND):
        since_s = (now_ns - intent.since_ns) / NS_PER_S
        return _brakes(flyer, braking or Braking(since_s, FASTEST_TOLD_MPS), prediction)
    mode = flyer.state.flight_mode.value
    if mode is not None and mode not in _MODES[told]:
        return False
    return not _flies_against(flyer, intent)


def _brakes(flyer: Flyer, braking: Braking, prediction: PredictionSettings) -> bool:
    """Whether it is no faster than one that brakes as it should, with twice the reaction's time."""
    braked_s = max(0.0, braking.since_s - 2.0 * prediction.reaction_s)
    expected_mps = max(0.0, braking.speed_mps - prediction.braking_mps2 * braked_s)
    return flyer.speed_mps <= expected_mps + AGAINST_MPS


def _flies_against(flyer: Flyer, intent: Intent) -> bool:
    if flyer.speed_mps < AGAINST_MPS:
        return False
    place = intent.target
    if intent.mission is not None and intent.passed < len(intent.mission.waypoints):
        place_m = flyer.plane.east_north_m(intent.mission.waypoints[intent.passed])
    elif place is not None:
        place_m = flyer.plane.east_north_m(place)
    elif intent.commanded is Commanded.RETURN and flyer.home_m is not None:
        place_m = flyer.home_m
    else:
        return False
    ahead_m = place_m[0] - flyer.east_m, place_m[1] - flyer.north_m
    far_m = hypot(*ahead_m)
    if far_m < 1.0:
        return False
    along_mps = (ahead_m[0] * flyer.velocity_mps[0] + ahead_m[1] * flyer.velocity_mps[1]) / far_m
    return along_mps < AGAINST_COSINE * flyer.speed_mps


def _held(flies: Samples, times_s: FloatArray, prediction: PredictionSettings) -> Samples:
    """The same vehicles, told now to hold: they fly on for the reaction's time and brake."""
    last = int(np.searchsorted(times_s, prediction.reaction_s))
    step_s = float(times_s[1] - times_s[0])
    braked_s = np.maximum(times_s - times_s[last], 0.0)

    def brakes(values: FloatArray, mps2: FloatArray | float) -> FloatArray:
        """Each value goes on at its speed at `last`, which falls to nothing."""
        speed = (values[:, last] - values[:, last - 1])[:, np.newaxis] / step_s
        lasts_s = np.minimum(braked_s, np.abs(speed) / np.maximum(mps2, 1e-9))
        gone = speed * lasts_s - 0.5 * np.sign(speed) * mps2 * lasts_s**2
        return np.where(times_s <= times_s[last], values, values[:, last : last + 1] + gone)

    east_mps = flies.east_m[:, last] - flies.east_m[:, last - 1]
    north_mps = flies.north_m[:, last] - flies.north_m[:, last - 1]
    both = np.maximum(np.hypot(east_mps, north_mps), 1e-9)
    brakes_mps2 = prediction.braking_mps2
    return Samples(
        east_m=brakes(flies.east_m, (brakes_mps2 * np.abs(east_mps) / both)[:, np.newaxis]),
        north_m=brakes(flies.north_m, (brakes_mps2 * np.abs(north_mps) / both)[:, np.newaxis]),
        low_m=brakes(flies.low_m, VERTICAL_BRAKING_MPS2),
        high_m=brakes(flies.high_m, VERTICAL_BRAKING_MPS2),
        radius_m=flies.radius_m,
    )
