"""Nothing is flown faster than the site allows."""

from collections.abc import Iterator
from math import hypot

from recon.model.command import Body, Command, FlyMission, GoTo, Nudge, Refusal, VirtualStick
from recon.safety.path.order_path import as_sent
from recon.safety.situation import Situation

RULE = "speed"


def speed(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a waypoint's, a goto's or a nudge's speed, or a stick's horizontal one, that is more
    than `max_speed_mps`, as the 32-bit floats of the wire have it."""
    limit_mps = situation.airspace.airspace.limits.max_speed_mps
    most_mps = limit_mps + situation.settings.fences.speed_rounding_mps
    for what, speed_mps in _speeds_mps(command.body):
        if not speed_mps <= most_mps:
            return Refusal(
                RULE,
                f"{what} must be at most {limit_mps:g} m/s; got {speed_mps:.2f} m/s",
                parameters={"speed_mps": speed_mps, "max_mps": limit_mps},
            )
    return None


def _speeds_mps(body: Body) -> Iterator[tuple[str, float]]:
    match body:
        case FlyMission(mission):
            for number, waypoint in enumerate(mission.waypoints, start=1):
                yield f"Speed at waypoint {number}", as_sent(waypoint.speed_mps)
        case GoTo() | Nudge():
            yield "Speed", as_sent(body.speed_mps)
        case VirtualStick():
            north_mps, east_mps = as_sent(body.velocity_x_mps), as_sent(body.velocity_y_mps)
            yield "Horizontal stick speed", hypot(north_mps, east_mps)
