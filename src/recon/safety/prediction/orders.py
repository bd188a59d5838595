"""The course that an order under judgement would send its vehicle on."""

from math import cos, hypot, radians, sin

from recon.geo.distance import moved_m
from recon.model.command import Body, FlyMission, GoTo, Hover, Nudge, StickFrame, VirtualStick
from recon.model.geo import LatLon
from recon.model.units import wrap_degrees
from recon.safety.prediction.course import Part
from recon.safety.prediction.flyer import Flyer
from recon.safety.prediction.intents import Follower
from recon.safety.prediction.legs import LEAST_S, STANDING_MPS, stop, stopping_distance_m
from recon.safety.settings import PredictionSettings

SWEEPING_DEG = 15.0
"""A body-frame stick that turns the vehicle by more than this sweeps a sector, not a line."""


def write_order(follower: Follower, body: Body) -> None:
    """Write what an order to move makes its vehicle do, until it is judged anew."""
    flyer, writer, settings = follower.flyer, follower.writer, follower.settings
    match body:
        case FlyMission(mission):
            if flyer.speed_mps >= STANDING_MPS:
                stop(writer, flyer.velocity_mps, settings, reaction_s=settings.reaction_s)
            follower.fly_mission(mission, 0)
        case GoTo():
            follower.go_to(body.target, body.height_above_takeoff_m, body.speed_mps)
            writer.waits(settings.stands_s, Part.HOVERING)
        case Nudge():
            _nudge(follower, body)
            writer.waits(settings.stands_s, Part.HOVERING)
        case VirtualStick():
            _stick(follower, body)
        case Hover():  # judged only as a takeoff: straight up, and it stays there
            _climbs(follower, (writer.low_m, writer.high_m + settings.takeoff_height_m))
            writer.waits(settings.stands_s, Part.HOVERING)
        case _:
            stop(writer, flyer.velocity_mps, settings, reaction_s=settings.reaction_s)
            writer.waits(settings.stands_s, Part.HOVERING)


def _nudge(follower: Follower, body: Nudge) -> None:
    position = follower.flyer.state.position.value
    height_m = follower.flyer.state.height_above_takeoff_m.value
    if position is None:
        return
    target: LatLon = moved_m(position, body.north_m, body.east_m)
    up_m = None if height_m is None else height_m + body.up_m
    follower.go_to(target, up_m, body.speed_mps)


def _stick(follower: Follower, body: VirtualStick) -> None:
    """The velocity is taken up, kept for the stick's time and the reaction, and braked."""
    writer, settings = follower.writer, follower.settings
    _climbs(follower, follower.flyer.up_m(body.height_above_takeoff_m))
    velocity = _east_north_mps(follower.flyer, body)
    if velocity is None:
        _sweep(follower, hypot(body.velocity_x_mps, body.velocity_y_mps), body.timeout_s)
        return
    _take_up(follower, velocity)
    lasts_s = body.timeout_s
    writer.moves(
        writer.east_m + velocity[0] * lasts_s,
        writer.north_m + velocity[1] * lasts_s,
        lasts_s,
        Part.STEERED,
    )
    stop(
        writer,
        (*velocity, 0.0),
        settings,
        reaction_s=settings.reaction_s,
        part=Part.STEERED,
    )


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


def _sweep(follower: Follower, speed_mps: float, lasts_s: float) -> None:
    settings: PredictionSettings = follower.settings
    fastest_mps = max(speed_mps, follower.flyer.speed_mps)
    reach_m = fastest_mps * lasts_s + stopping_distance_m(fastest_mps, settings)
    follower.writer.grows(reach_m, lasts_s + settings.reaction_s, Part.STEERED)


def _east_north_mps(flyer: Flyer, body: VirtualStick) -> tuple[float, float] | None:
    """The stick's velocity east and north; None when its direction sweeps or nobody knows it."""
    if body.frame is StickFrame.GROUND:
        return body.velocity_y_mps, body.velocity_x_mps
    attitude = flyer.state.attitude.value
    if attitude is None or abs(wrap_degrees(body.yaw_deg - attitude.yaw_deg)) > SWEEPING_DEG:
        return None
    yaw = radians(body.yaw_deg)
    east_mps = body.velocity_x_mps * sin(yaw) + body.velocity_y_mps * cos(yaw)
    north_mps = body.velocity_x_mps * cos(yaw) - body.velocity_y_mps * sin(yaw)
    return east_mps, north_mps
