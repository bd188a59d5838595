"""The course that an order under judgement would send its vehicle on."""

from math import hypot

from recon.model.command import Body
from recon.model.mission import Mission
from recon.safety.path.order_path import StickFlight, StraightFlight, TakeoffClimb, order_path
from recon.safety.prediction.course import Part
from recon.safety.prediction.intents import Follower
from recon.safety.prediction.legs import LEAST_S, STANDING_MPS, stop


def write_order(follower: Follower, body: Body) -> None:
    """Write what an order to move makes its vehicle do, until it is judged anew."""
    flyer, writer, settings = follower.flyer, follower.writer, follower.settings
    path = order_path(body, flyer.state)
    match path:
        case Mission():
            if flyer.speed_mps >= STANDING_MPS:
                stop(writer, flyer.velocity_mps, settings, reaction_s=settings.reaction_s)
            follower.fly_mission(path, 0)
            return
        case StickFlight():
            _stick(follower, path)
            return
        case StraightFlight(target, height_m, speed_mps):
            follower.go_to(target, height_m, speed_mps)
        case TakeoffClimb():
            _climbs(follower, (writer.low_m, writer.high_m + settings.takeoff_height_m))
        case _:
            stop(writer, flyer.velocity_mps, settings, reaction_s=settings.reaction_s)
    writer.waits(settings.stands_s, Part.HOVERING)


def _stick(follower: Follower, path: StickFlight) -> None:
    """The velocity is taken up, kept for the stick's time and the reaction, and braked.

    A body-frame stick that turns the vehicle reaches anywhere in a disc: at its own speed or the
    vehicle's present one, whichever is faster.
    """
    writer, settings = follower.writer, follower.settings
    _climbs(follower, follower.flyer.up_m(path.height_above_takeoff_m))
    if path.turn_deg is None or abs(path.turn_deg) > settings.stick_line_deg:
        fastest_mps = max(path.speed_mps, follower.flyer.speed_mps)
        reach_m = path.reach_m(settings.stick, speed_mps=fastest_mps)
        writer.grows(reach_m, path.timeout_s + settings.stick.reaction_s, Part.STEERED)
        return
    velocity = path.east_north_mps()
    _take_up(follower, velocity)
    writer.moves(
        writer.east_m + velocity[0] * path.timeout_s,
        writer.north_m + velocity[1] * path.timeout_s,
        path.timeout_s,
        Part.STEERED,
    )
    reaction_s = settings.stick.reaction_s
    stop(writer, (*velocity, 0.0), settings, reaction_s=reaction_s, part=Part.STEERED)


def _climbs(follower: Follower, band_m: tuple[float, float]) -> None:
    """From now on at any height up or down to these; until now at its own, at its own velocity.

    So the climb itself is no way out for two that are too near already.
    """
    writer, (east_mps, north_mps, _up_mps) = follower.writer, follower.flyer.velocity_mps
    until_now_s = max(0.0, -writer.time_s) + LEAST_S
    writer.moves(
        writer.east_m + east_mps * until_now_s,
        writer.north_m + north_mps * until_now_s,
        until_now_s,
        Part.STEERED,
    )
    writer.widens(*band_m)


def _take_up(follower: Follower, velocity: tuple[float, float]) -> None:
    """From the present velocity to the stick's: a parabola, within its bow of the chord."""
    writer, settings = follower.writer, follower.settings
    east_mps, north_mps, _up_mps = follower.flyer.velocity_mps
    change_mps = hypot(velocity[0] - east_mps, velocity[1] - north_mps)
    takes_s = change_mps / settings.braking_mps2
    if takes_s < 0.05:
        return
    bow_m = change_mps * takes_s / 8.0
    writer.radius_m = bow_m
    writer.moves(
        writer.east_m + 0.5 * (east_mps + velocity[0]) * takes_s,
        writer.north_m + 0.5 * (north_mps + velocity[1]) * takes_s,
        takes_s,
        Part.STEERED,
    )
    writer.radius_m = 0.0
