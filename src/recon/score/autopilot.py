"""What a flight controller makes of an order, worked out ahead: every hop until its end.

The same manoeuvres as in `sim.manoeuvres` and `sim.mission`, in closed form; `studies.gears` holds
the times of both against each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, log, sqrt

from recon.score.curve import curved
from recon.score.flight import Hop, Motion, Spot, Steady
from recon.score.legs import Pace, leg
from recon.sim.flight.air import COMES_BACK_WITHIN_S, LEARNS_WITHIN_S
from recon.sim.flight.battery import flying_load
from recon.sim.flight.flight_modes import (
    CONFIRM_HEIGHT_M,
    LANDING_FAST_MPS,
    LANDING_SLOW_BELOW_M,
    LANDING_SLOW_MPS,
    SHORTEST_GO_HOME_S,
    SPIN_UP_S,
    TAKEOFF_HEIGHT_M,
)
from recon.sim.flight.kinematics import DRAG_PER_S, Limits
from recon.sim.flight.kinematics import AircraftMotion as AirMotion
from recon.sim.flight.mission import ARRIVED_BELOW_MPS, ARRIVED_WITHIN_M
from recon.sim.flight.path import Corner
from recon.sim.world import Wind

LIFTED_M = TAKEOFF_HEIGHT_M - 0.1
"""From this height on a takeoff is done."""
RISEN_M = 1.0
"""Below its height a rise counts as done, a climb to the go-home height too."""
RISE_BRAKING = 0.4
"""Of the vertical acceleration, where a height is to be held."""
STOP_S = 0.1
"""At each waypoint, beside its loiter time: two steps of the flight controller."""
HOME_MPS = 10.0
CONFIRMED_AFTER_S = 1.0
HELD_DOWN_S = 0.15
"""Steps between the parts of a landing."""
GUSTY_STOP_S = 0.65
"""At each waypoint, until a gust lets it stand still: what the simulator's squalls cost."""
LEAST_MPS = 0.5
"""Where the wind is too strong to get ahead, a leg takes for ever in truth."""


@dataclass(frozen=True, slots=True)
class Point:
    """A waypoint; its speed holds from here to the next."""

    at_m: Spot
    speed_mps: float
    loiter_s: float = 0.0
    corner_radius_m: float = 0.2


class Autopilot:
    """Flies on from a place and a time; `hops` is what it flies."""

    def __init__(
        self,
        start_s: float,
        at_m: Spot,
        wind: Wind | None = None,
        gusty_s: Sequence[tuple[float, float]] = (),
    ) -> None:
        """Begin somewhere; `gusty_s` are spans of time with squalls."""
        self.now_s, self.at_m = start_s, at_m
        self.hops: list[Hop] = []
        self._wind, self._gusty_s, self._limits = wind, gusty_s, Limits()
        self._up_mps = 0.0
        """The climb that goes on into the next hop."""

    def wait(self, seconds: float, waypoint: int | None = None) -> None:
        """Stay where it is."""
        if seconds > 0.0:
            self._add(self.at_m, None, seconds, 0.0, waypoint=waypoint)

    def drift(self, seconds: float) -> None:
        """Be carried along by the mean wind."""
        if seconds <= 0.0:
            return
        east_mps, north_mps = self._air(self.at_m[2])
        east_m, north_m, up_m = self.at_m
        to_m = (east_m + seconds * east_mps, north_m + seconds * north_mps, up_m)
        way_m = seconds * hypot(east_mps, north_mps)
        self._add(to_m, Steady(way_m, seconds), seconds, 0.0)

    def take_off(self) -> None:
        """Start the motors and lift off, to where missions begin."""
        self.wait(SPIN_UP_S)
        self._rise(TAKEOFF_HEIGHT_M, TAKEOFF_HEIGHT_M - LIFTED_M)

    def fly(self, points: Sequence[Point], rows_from: int | None = None) -> None:
        """Fly a mission that stops at every waypoint; from the `rows_from`th on there are rows."""
        self._rise(points[0].at_m[2], RISEN_M)
        for index, point in enumerate(points):
            speed_mps = points[max(0, index - 1)].speed_mps
            is_row = rows_from is not None and index > rows_from
            self._go_to(point.at_m, speed_mps, is_row)
            is_gusty = any(from_s <= self.now_s < until_s for from_s, until_s in self._gusty_s)
            stop_s = STOP_S + GUSTY_STOP_S * is_gusty
            self.wait(stop_s + point.loiter_s, waypoint=index)

    def fly_curved(self, points: Sequence[Point]) -> None:
        """Fly to the first waypoint, and past the others without a stop, round their corners."""
        self._rise(points[0].at_m[2], RISEN_M)
        self._go_to(points[0].at_m, points[0].speed_mps, is_row=False)
        self.wait(STOP_S)
        corners = [
            Corner(p.at_m[1], p.at_m[0], p.at_m[2], p.corner_radius_m, p.speed_mps) for p in points
        ]
        for to_m, motion in curved(corners, self._limits):
            climb_mps = (to_m[2] - self.at_m[2]) / max(motion.duration_s, 1e-9)
            self._add(to_m, motion, motion.duration_s, climb_mps)
        self.wait(STOP_S, waypoint=len(points) - 1)

    def land(self) -> None:
        """Come down here, wait for the confirmation, touch down."""
        height_m = self.at_m[2]
        slow_m = min(height_m, LANDING_SLOW_BELOW_M)
        if height_m > slow_m:
            self._descend(height_m - slow_m, _fast_s(height_m - slow_m, self._limits))
        self._descend(self.at_m[2], _slow_s(self.at_m[2], height_m > slow_m, self._limits))

    def go_home(self, home_m: tuple[float, float], go_home_height_m: float) -> None:
        """Climb to the go-home height unless already higher, fly home, land there."""
        start_s, height_m = self.now_s, max(go_home_height_m, self.at_m[2])
        self._rise(height_m, RISEN_M)
        # The last metre of the climb is flown on the way.
        self._go_to((*home_m, height_m), HOME_MPS, is_row=False)
        self.wait(start_s + SHORTEST_GO_HOME_S - self.now_s)
        self.land()

    def _rise(self, height_m: float, left_m: float) -> None:
        """Climb, gently towards the end, until so much is left to a height."""
        climb_m = height_m - self.at_m[2]
        if climb_m <= left_m:
            return
        limits = self._limits
        up_mps2 = limits.vertical_acceleration_mps2
        pace = Pace(limits.climb_mps, up_mps2, left_m, RISE_BRAKING * up_mps2, self._up_mps)
        motion = leg(climb_m, pace)
        to_m = self._drifted(height_m - left_m)
        self._add(to_m, motion, motion.duration_s, motion.top_mps)
        self._up_mps = motion.end_mps

    def _drifted(self, height_m: float) -> Spot:
        """Where it comes out at a height: nothing holds its place in a rise, and the wind, which
        grows with height, pushes while it is not known yet (`sim.air`)."""
        before, after = self._air(self.at_m[2]), self._air(height_m)
        east_m, north_m = (
            at_m + DRAG_PER_S * LEARNS_WITHIN_S * COMES_BACK_WITHIN_S * (b - a)
            for at_m, a, b in zip(self.at_m[:2], before, after, strict=True)
        )
        return east_m, north_m, height_m

    def _air(self, height_m: float) -> tuple[float, float]:
        """The mean wind east and north, where the air goes, in m/s."""
        return (0.0, 0.0) if self._wind is None else self._wind.mean_mps(height_m)[:2]

    def _go_to(self, to_m: Spot, speed_mps: float, is_row: bool) -> None:
        """Fly straight at a place, and stop a little before it, where it counts as reached."""
        ways_m = [b - a for a, b in zip(self.at_m, to_m, strict=True)]
        level_m = hypot(ways_m[0], ways_m[1])
        length_m = hypot(level_m, ways_m[2])
        level, up = (level_m / length_m, ways_m[2] / length_m) if length_m > 0.0 else (1.0, 0.0)
        pace = self._pace(ways_m, level, up, speed_mps)
        motion = leg(length_m, pace)
        short = pace.left_m / length_m if motion.way_m > 0.0 else 0.0
        reached = tuple(b - short * way for b, way in zip(to_m, ways_m, strict=True))
        end_m = (reached[0], reached[1], reached[2]) if motion.way_m > 0.0 else self.at_m
        climb_mps = up * motion.top_mps
        self._add(end_m, motion, motion.duration_s, climb_mps, is_row=is_row)
        self._up_mps = 0.0

    def _pace(self, ways_m: list[float], level: float, up: float, speed_mps: float) -> Pace:
        """How a leg of that slope (its level and upward parts) is flown."""
        limits = self._limits
        steepest_mps = limits.climb_mps if up > 0.0 else limits.descent_mps
        fastest_mps = min(
            speed_mps,
            steepest_mps / abs(up) if up else inf,
            self._over_ground_mps(ways_m[0], ways_m[1]) / level if level else inf,
        )
        acceleration_mps2 = min(
            limits.acceleration_mps2 / level if level else inf,
            limits.vertical_acceleration_mps2 / abs(up) if up else inf,
        )
        left_m = min(ARRIVED_WITHIN_M, ARRIVED_BELOW_MPS / level if level else inf)
        start_mps = max(self._up_mps * up, 0.0) if level < 0.5 else 0.0
        return Pace(fastest_mps, acceleration_mps2, left_m, start_mps=start_mps)

    def _over_ground_mps(self, east_m: float, north_m: float) -> float:
        """How fast it gets ahead on a course: through the air it is only so fast."""
        way_m, limits = hypot(east_m, north_m), self._limits
        if way_m <= 0.0:
            return limits.speed_mps
        air_east_mps, air_north_mps = self._air(self.at_m[2])
        along = (air_east_mps * east_m + air_north_mps * north_m) / way_m
        across_squared = air_east_mps**2 + air_north_mps**2 - along**2
        ahead_mps = along + sqrt(max(limits.airspeed_mps**2 - across_squared, 0.0))
        return max(min(limits.speed_mps, ahead_mps), LEAST_MPS)

    def _descend(self, by_m: float, seconds: float) -> None:
        east_m, north_m, height_m = self.at_m
        is_down = by_m >= height_m
        to_m = (east_m, north_m, 0.0 if is_down else height_m - by_m)
        self._add(to_m, Steady(by_m, seconds), seconds, -by_m / seconds, lands=is_down)

    def _add(
        self,
        to_m: Spot,
        motion: Motion | None,
        seconds: float,
        up_mps: float,
        waypoint: int | None = None,
        is_row: bool = False,
        lands: bool = False,
    ) -> None:
        end_s = self.now_s + seconds
        load = self._load(to_m, seconds, up_mps)
        self.hops.append(
            Hop(self.now_s, end_s, self.at_m, to_m, motion, load, waypoint, is_row, lands)
        )
        self.now_s, self.at_m = end_s, to_m

    def _load(self, to_m: Spot, seconds: float, up_mps: float) -> float:
        """Of the battery, at the mean speed of a hop in the mean wind."""
        east_mps, north_mps = (
            (b - a) / seconds if seconds > 0.0 else 0.0
            for a, b in zip(self.at_m[:2], to_m[:2], strict=True)
        )
        moving = AirMotion(
            velocity_east_mps=east_mps, velocity_north_mps=north_mps, velocity_up_mps=up_mps
        )
        air_east_mps, air_north_mps = self._air(to_m[2])
        return flying_load(moving, (air_north_mps, air_east_mps))


def _fast_s(down_m: float, limits: Limits) -> float:
    """How long the first part of a landing takes, from standstill."""
    speeding_m = LANDING_FAST_MPS**2 / (2.0 * limits.vertical_acceleration_mps2)
    if down_m < speeding_m:
        return sqrt(2.0 * down_m / limits.vertical_acceleration_mps2)
    return (down_m + speeding_m) / LANDING_FAST_MPS


def _slow_s(height_m: float, comes_fast: bool, limits: Limits) -> float:
    """How long the last metres take, with the stop above the ground."""
    stop_m = CONFIRM_HEIGHT_M + 0.05
    # A crawl of 0.1 m/s is added to a speed that falls with the height above the stop.
    crawl_m = LANDING_SLOW_MPS - 0.1
    above_m = height_m - CONFIRM_HEIGHT_M
    crawled_m = min(above_m, crawl_m)
    even_m = above_m - crawled_m
    gained_m, braked_s = 0.0, 0.0
    if comes_fast:
        down = limits.vertical_acceleration_mps2
        braked_s = (LANDING_FAST_MPS - LANDING_SLOW_MPS) / down
        gained_m = min(0.5 * (LANDING_FAST_MPS + LANDING_SLOW_MPS) * braked_s, even_m)
    crawl_s = log((crawled_m + 0.1) / (stop_m - CONFIRM_HEIGHT_M + 0.1)) if above_m > 0.05 else 0.0
    even_s = braked_s + (even_m - gained_m) / LANDING_SLOW_MPS
    touch_s = stop_m / LANDING_SLOW_MPS + LANDING_SLOW_MPS / 4.0
    return even_s + crawl_s + CONFIRMED_AFTER_S + touch_s + HELD_DOWN_S
