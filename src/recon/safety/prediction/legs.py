"""Straight paths flown with limited acceleration, and stopping: rows for a trajectory."""

from math import atan2, cos, hypot, sin, sqrt
from typing import NamedTuple

from recon.safety.prediction.trajectory import FOREVER_S, FlightPart, TrajectoryWriter
from recon.safety.prediction_settings import PredictionSettings

LEAST_M = 1e-3
LEAST_S = 1e-3
LEAST_SPEED_MPS = 0.1
"""A leg commanded at zero speed still ends."""

STANDING_MPS = 0.5
"""Speed below which a vehicle counts as hovering: above GNSS velocity noise and gusts."""

VERTICAL_BRAKING_MPS2 = 2.0
EASING_MPS2 = 0.8
"""An aircraft eases into a new height more gently than it brakes; only there does it fly on."""
LONGEST_RISE_S = 600.0
"""A leg to an unknown height still ends."""

Point = tuple[float, float]
Phase = tuple[float, float, float, float]
"""How long, from and to which speed, and in which time."""


class Leg(NamedTuple):
    """A straight path to a place: the heights at its end, the speeds at its start, in it and at its
    end, and which part of the flight it is."""

    east_m: float
    north_m: float
    band_m: tuple[float, float]
    start_mps: float
    speed_mps: float
    end_mps: float
    part: int


def fly(
    writer: TrajectoryWriter,
    leg: Leg,
    settings: PredictionSettings,
    *,
    exactly: bool,
    until_s: float = FOREVER_S,
    least_s: float = 0.0,
) -> None:
    """Write a leg: as its phases of gaining, keeping and losing speed, or as one even row as long.

    No phase that begins after `until_s` is written. It takes `least_s` at least: the climb of a leg
    that may be at every height between from its beginning on.
    """
    long_m = hypot(leg.east_m - writer.east_m, leg.north_m - writer.north_m)
    fastest_s = rise_s(writer, leg.band_m, settings.climb_mps, settings.sink_mps)
    least_s = max(least_s, fastest_s, LEAST_S)
    phases = _phases(long_m, leg, settings.braking_mps2)
    flown_s = sum(seconds for *_, seconds in phases)
    if exactly and long_m > LEAST_M and flown_s >= least_s:
        _write_phases(writer, leg, long_m, phases, until_s)
    else:
        seconds = max(flown_s, least_s)
        writer.moves(leg.east_m, leg.north_m, seconds, leg.part, band_m=leg.band_m)


def rise_s(
    writer: TrajectoryWriter, band_m: tuple[float, float], climb_mps: float, sink_mps: float
) -> float:
    """Return how long a change of height takes; 0 into a band that holds the present."""
    climb_s = (band_m[1] - writer.high_m) / climb_mps
    sink_s = (writer.low_m - band_m[0]) / sink_mps
    return min(max(0.0, climb_s, sink_s), LONGEST_RISE_S)


def eased_rise_s(rise_m: float, speed_mps: float) -> float:
    """Return how long a change of height takes at a speed, easing into the new height."""
    eased_mps = min(speed_mps, sqrt(2.0 * EASING_MPS2 * rise_m))
    return rise_m / eased_mps + 0.5 * eased_mps / EASING_MPS2


def stop(
    writer: TrajectoryWriter,
    velocity_mps: tuple[float, float, float],
    settings: PredictionSettings,
    *,
    reaction_s: float,
    part: int = FlightPart.STOPPING,
) -> None:
    """Go on for the reaction's time and brake in a straight line; velocity is east, north, up."""
    east_mps, north_mps, up_mps = velocity_mps
    speed_mps = hypot(east_mps, north_mps)
    rise_m = up_mps * reaction_s + up_mps * abs(up_mps) / (2.0 * VERTICAL_BRAKING_MPS2)
    band_m = (writer.low_m + rise_m, writer.high_m + rise_m)
    if speed_mps < LEAST_SPEED_MPS:
        writer.moves(writer.east_m, writer.north_m, max(reaction_s, LEAST_S), part, band_m=band_m)
        return
    if reaction_s > 0.0:
        writer.moves(
            writer.east_m + east_mps * reaction_s,
            writer.north_m + north_mps * reaction_s,
            reaction_s,
            part,
            band_m=band_m,
        )
    braking_s = speed_mps / settings.braking_mps2
    writer.moves(
        writer.east_m + 0.5 * east_mps * braking_s,
        writer.north_m + 0.5 * north_mps * braking_s,
        braking_s,
        part,
        curve=-1.0 / braking_s**2,
        band_m=band_m,
    )


def stopping_distance_m(speed_mps: float, settings: PredictionSettings) -> float:
    """Return how far a vehicle flies on from an order to stop."""
    return speed_mps * settings.reaction_s + speed_mps**2 / (2.0 * settings.braking_mps2)


def corner_bulge_m(before_m: Point, corner_m: Point, after_m: Point, radius_m: float) -> float:
    """Return how far from both its legs a rounded corner's path may run.

    An app takes the radius for where the curve leaves the leg, or for the radius of an arc; neither
    reaches farther than the legs are long. Any curve between its two ends and the corner stays
    within half the reach times the sine of the corner's angle.
    """
    back = before_m[0] - corner_m[0], before_m[1] - corner_m[1]
    on = after_m[0] - corner_m[0], after_m[1] - corner_m[1]
    across, along = back[0] * on[1] - back[1] * on[0], back[0] * on[0] + back[1] * on[1]
    angle_rad = atan2(abs(across), along)
    sine = sin(angle_rad)
    arc_reach = 1.0 + cos(angle_rad)  # sine / tan(half the corner's angle)
    return 0.5 * min(radius_m * max(sine, arc_reach), hypot(*back) * sine, hypot(*on) * sine)


def _phases(long_m: float, leg: Leg, braking_mps2: float) -> tuple[Phase, Phase, Phase]:
    """Return a leg's gaining, keeping and losing of speed; what it has none of has no length."""
    change = 2.0 * braking_mps2 * long_m  # how much the square of a speed may change on the leg
    start_mps = leg.start_mps
    slowest_mps = sqrt(max(0.0, start_mps**2 - change))  # too fast to stop: it arrives all the same
    end_mps = min(max(leg.end_mps, slowest_mps), sqrt(start_mps**2 + change))
    peak_mps = sqrt(0.5 * (start_mps**2 + end_mps**2 + change))
    speed_mps = min(max(leg.speed_mps, end_mps, LEAST_SPEED_MPS), peak_mps)
    gaining_m = abs(speed_mps**2 - start_mps**2) / (2.0 * braking_mps2)
    losing_m = (speed_mps**2 - end_mps**2) / (2.0 * braking_mps2)
    return (
        _phase(gaining_m, start_mps, speed_mps),
        _phase(long_m - gaining_m - losing_m, speed_mps, speed_mps),
        _phase(losing_m, speed_mps, end_mps),
    )


def _phase(long_m: float, from_mps: float, to_mps: float) -> Phase:
    return long_m, from_mps, to_mps, 2.0 * long_m / max(from_mps + to_mps, LEAST_SPEED_MPS)


def _write_phases(
    writer: TrajectoryWriter,
    leg: Leg,
    long_m: float,
    phases: tuple[Phase, Phase, Phase],
    until_s: float,
) -> None:
    east_m, north_m, low_m, high_m = writer.east_m, writer.north_m, writer.low_m, writer.high_m
    gone_m = 0.0
    for distance_m, from_mps, to_mps, seconds in phases:
        if distance_m < LEAST_M or writer.time_s > until_s:
            continue
        gone_m += distance_m
        share = gone_m / long_m
        writer.moves(
            east_m + share * (leg.east_m - east_m),
            north_m + share * (leg.north_m - north_m),
            seconds,
            leg.part,
            curve=(to_mps - from_mps) / (2.0 * distance_m * seconds),
            band_m=(
                low_m + share * (leg.band_m[0] - low_m),
                high_m + share * (leg.band_m[1] - high_m),
            ),
        )
