"""The steering law: from delayed telemetry to the next velocity setpoint towards a place. Pure.

Theory of operation. At each setpoint:

1. Predict the position at which the setpoint takes effect: the last reported position plus the
   demanded velocity over the telemetry's age and `latency_s`, at most `longest_lead_s`.
2. Speed from the remaining distance d: sqrt(2 a d) far out (constant deceleration
   `braking_mps2`), proportional to d close in (`approach_gain_per_s`), so that the vehicle settles
   without oscillation (ArduPilot's `sqrt_controller` has the same shape). With gain times loop
   delay under 1/e the linear part does not oscillate.
3. Slew: the demand changes by at most `acceleration_mps2`.
4. Wind: the part of the velocity that the aircraft's own control leaves as an error is learnt
   slowly while the demand is steady, and subtracted. It is bounded by `longest_push_mps`: more is
   an aircraft that does not follow its setpoints.
5. Height is demanded as height above takeoff and moves at `climb_mps` or `sink_mps`, at most
   `longest_height_lead_m` ahead of the aircraft; the heading turns at `turn_dps`.

`halted` demands zero velocity at once. Streams, their ends and timeouts are the station's.
"""

from dataclasses import dataclass, replace
from math import hypot, inf, sqrt

from recon.geo.distance import moved_m, offset_north_east_m
from recon.model.geo import LatLon
from recon.model.units import ns_to_seconds, seconds_to_ns, wrap_degrees


@dataclass(frozen=True, slots=True)
class SteeringSettings:
    """How gently vehicles are steered."""

    acceleration_mps2: float = 2.0
    """The demand changes by this at most: under the 2.5 m/s2 that aircraft brake with."""

    braking_mps2: float = 1.5
    """The deceleration an approach is planned with; the rest up to 2.5 m/s2 is for what delays and
    wind add."""

    approach_gain_per_s: float = 0.5
    """Close in, metres become metres per second by this: with up to 0.7 s of delay round the loop
    the product stays under 0.37 (1/e), from where on a loop swings."""

    latency_s: float = 0.3
    """Delay from the aircraft's sensors to the station and from the stick to its effect, beyond the
    age that the station sees."""

    longest_lead_s: float = 1.3
    """Longest prediction of telemetry: a second of age, and the latency."""

    climb_mps: float = 2.0
    sink_mps: float = 1.5
    """Sink rate that aircraft of all sizes exceed; sinking faster meets their own downwash."""

    longest_height_lead_m: float = 3.0
    """The demanded height runs ahead of the aircraft by this at most, if it climbs slower."""

    turn_dps: float = 45.0

    steady_s: float = 1.2
    steady_mps: float = 0.4
    """Change limit: while the demand stays within this for so long, a vehicle has had the time to
    follow it, and the rest of its velocity's error is due to the wind."""

    push_learning_s: float = 2.0
    push_learning_mps2: float = 0.25
    """Slow enough that learning itself leaves the demand steady."""

    longest_push_mps: float = 2.0
    """Longest correction for wind: beyond it the aircraft does not obey."""

    resting_mps: float = 0.5
    """Speed below which a vehicle counts as hovering: above GNSS velocity noise and gusts."""

    arrived_m: float = 1.0
    """GNSS tells a place no better than this."""

    arrived_height_m: float = 1.0
    arrived_turn_deg: float = 10.0

    longest_step_s: float = 0.3
    """The demand never changes by more than this much time allows, however late a step comes."""


@dataclass(frozen=True, slots=True)
class Goal:
    """Where a vehicle is to go, at which horizontal speed, and how it points.

    `speed_mps` bounds the demand, correction for wind included; `progress_mps` only how fast it
    comes nearer, where a climb takes longer than the way: it must not bind the correction.
    """

    target: LatLon
    height_above_takeoff_m: float
    speed_mps: float
    yaw_deg: float
    progress_mps: float = inf


@dataclass(frozen=True, slots=True)
class KinematicState:
    """The newest telemetry that steering needs, and its age."""

    position: LatLon
    velocity_north_mps: float
    velocity_east_mps: float
    height_above_takeoff_m: float
    yaw_deg: float
    age_s: float

    @property
    def speed_mps(self) -> float:
        """Horizontal speed."""
        return hypot(self.velocity_north_mps, self.velocity_east_mps)


@dataclass(frozen=True, slots=True)
class Steered:
    """One demand, and what the next one starts from.

    `push_*` is the wind's push as learnt so far; `recent` are the velocities lately demanded
    (north, east), with their times.
    """

    at_ns: int
    velocity_north_mps: float
    velocity_east_mps: float
    height_above_takeoff_m: float
    yaw_deg: float
    push_north_mps: float = 0.0
    push_east_mps: float = 0.0
    recent: tuple[tuple[int, float, float], ...] = ()


def begin(seen: KinematicState, now_ns: int) -> Steered:
    """Return the demand that keeps the present motion, to be changed from there."""
    return Steered(
        now_ns,
        seen.velocity_north_mps,
        seen.velocity_east_mps,
        seen.height_above_takeoff_m,
        seen.yaw_deg,
    )


def steer(
    before: Steered, goal: Goal, seen: KinematicState, now_ns: int, settings: SteeringSettings
) -> Steered:
    """Return the demand now: velocity, height and heading that lead to the goal."""
    step_s = min(ns_to_seconds(now_ns - before.at_ns), settings.longest_step_s)
    push = _push(before, seen, step_s, settings)
    wanted = _wanted_velocity(goal, seen, push, settings)
    largest = settings.acceleration_mps2 * step_s
    change = _clipped(
        wanted[0] - before.velocity_north_mps, wanted[1] - before.velocity_east_mps, largest
    )
    north = before.velocity_north_mps + change[0]
    east = before.velocity_east_mps + change[1]
    return Steered(
        now_ns,
        north,
        east,
        _height_m(before, goal, seen, step_s, settings),
        _yaw_deg(before, goal, step_s, settings),
        *push,
        (*_recent(before, now_ns, settings), (now_ns, north, east)),
    )


def halted(before: Steered, height_above_takeoff_m: float | None, now_ns: int) -> Steered:
    """Return the demand to stop at once: heading kept, at the height last reported or, without one,
    last demanded."""
    kept_m = before.height_above_takeoff_m
    return replace(
        before,
        at_ns=now_ns,
        velocity_north_mps=0.0,
        velocity_east_mps=0.0,
        height_above_takeoff_m=kept_m if height_above_takeoff_m is None else height_above_takeoff_m,
        recent=(),
    )


def has_arrived(goal: Goal, seen: KinematicState, settings: SteeringSettings) -> bool:
    """Return whether telemetry shows the vehicle at its goal, at rest."""
    turn_deg = abs(wrap_degrees(goal.yaw_deg - seen.yaw_deg))
    height_m = abs(goal.height_above_takeoff_m - seen.height_above_takeoff_m)
    return (
        hypot(*offset_north_east_m(seen.position, goal.target)) <= settings.arrived_m
        and height_m <= settings.arrived_height_m
        and turn_deg <= settings.arrived_turn_deg
        and seen.speed_mps < settings.resting_mps
    )


def stopping_place(seen: KinematicState, settings: SteeringSettings) -> LatLon:
    """Return where the vehicle comes to rest when it brakes from now on."""
    lead_s = _lead_s(seen, settings) + 0.5 * seen.speed_mps / settings.braking_mps2
    return moved_m(seen.position, seen.velocity_north_mps * lead_s, seen.velocity_east_mps * lead_s)


def approach_speed_mps(distance_m: float, settings: SteeringSettings) -> float:
    """Return the speed to have with this distance left."""
    braking, gain = settings.braking_mps2, settings.approach_gain_per_s
    settling_m = braking / gain**2
    if distance_m < settling_m:
        return gain * distance_m
    return sqrt(2.0 * braking * (distance_m - 0.5 * settling_m))


def _wanted_velocity(
    goal: Goal, seen: KinematicState, push_mps: tuple[float, float], settings: SteeringSettings
) -> tuple[float, float]:
    lead_s = _lead_s(seen, settings)
    north_m, east_m = offset_north_east_m(seen.position, goal.target)
    north_m -= seen.velocity_north_mps * lead_s
    east_m -= seen.velocity_east_mps * lead_s
    distance_m = hypot(north_m, east_m)
    share = 0.0
    if distance_m > 0.0:
        nearer_mps = min(goal.speed_mps, goal.progress_mps)
        share = min(nearer_mps, approach_speed_mps(distance_m, settings)) / distance_m
    # Within the ordered speed, whatever the wind: what was judged is never exceeded.
    return _clipped(north_m * share - push_mps[0], east_m * share - push_mps[1], goal.speed_mps)


def _lead_s(seen: KinematicState, settings: SteeringSettings) -> float:
    return min(seen.age_s + settings.latency_s, settings.longest_lead_s)


def _push(
    before: Steered, seen: KinematicState, step_s: float, settings: SteeringSettings
) -> tuple[float, float]:
    """What the velocity differs by from the demand, learnt slowly while the demand is steady."""
    push = before.push_north_mps, before.push_east_mps
    if not _is_steady(before, settings):
        return push
    share, largest = step_s / settings.push_learning_s, settings.push_learning_mps2 * step_s
    change = _clipped(
        share * (seen.velocity_north_mps - before.velocity_north_mps - push[0]),
        share * (seen.velocity_east_mps - before.velocity_east_mps - push[1]),
        largest,
    )
    return _clipped(push[0] + change[0], push[1] + change[1], settings.longest_push_mps)


def _is_steady(before: Steered, settings: SteeringSettings) -> bool:
    if not before.recent:
        return False
    lasts_s = ns_to_seconds(before.at_ns - before.recent[0][0])
    return lasts_s >= 0.8 * settings.steady_s and all(
        hypot(north - before.velocity_north_mps, east - before.velocity_east_mps)
        <= settings.steady_mps
        for _, north, east in before.recent
    )


def _recent(
    before: Steered, now_ns: int, settings: SteeringSettings
) -> tuple[tuple[int, float, float], ...]:
    since_ns = now_ns - seconds_to_ns(settings.steady_s)
    return tuple(demand for demand in before.recent if demand[0] >= since_ns)


def _height_m(
    before: Steered, goal: Goal, seen: KinematicState, step_s: float, settings: SteeringSettings
) -> float:
    last_m, lead_m = before.height_above_takeoff_m, settings.longest_height_lead_m
    change_m = goal.height_above_takeoff_m - last_m
    moved = max(-settings.sink_mps * step_s, min(settings.climb_mps * step_s, change_m))
    seen_m = seen.height_above_takeoff_m
    return max(seen_m - lead_m, min(seen_m + lead_m, last_m + moved))


def _yaw_deg(before: Steered, goal: Goal, step_s: float, settings: SteeringSettings) -> float:
    largest = settings.turn_dps * step_s
    turn = wrap_degrees(goal.yaw_deg - before.yaw_deg)
    return wrap_degrees(before.yaw_deg + max(-largest, min(largest, turn)))


def _clipped(north: float, east: float, longest: float) -> tuple[float, float]:
    length = hypot(north, east)
    if length <= longest:
        return north, east
    return north * longest / length, east * longest / length
