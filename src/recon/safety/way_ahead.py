"""Where an order leads, for counting energy: from where the vehicle is to the order's end."""

from collections.abc import Sequence
from math import atan2, cos, hypot, sin

from recon.geo.distance import offset_north_east_m
from recon.model.command import Body, FlyMission, GoTo, Nudge, StickFrame, VirtualStick
from recon.model.vehicle import VehicleState
from recon.safety.datum import home
from recon.safety.energy import (
    Consumption,
    Need,
    Point,
    mission_need,
    mission_points,
    path_need,
    place_of,
)
from recon.safety.return_missions import leads_home
from recon.safety.situation import Situation

Way = tuple[Sequence[Point], float]
"""The points of a way from home, the first where the vehicle is, and the speed in m/s."""


def need_of(uses: Consumption, vehicle: VehicleState, body: Body) -> Need | None:
    """Return what an order to move needs, the way home included; None while that is unknown."""
    if isinstance(body, FlyMission):
        points = mission_points(vehicle, body.mission)
        return None if points is None else mission_need(uses, points, body.mission)
    way = way_of(body, vehicle)
    return None if way is None else path_need(uses, *way)


def leads_away(body: Body, vehicle: VehicleState, situation: Situation) -> bool:
    """Return whether an order to move leads away from home; what is not known does.

    A mission leads away unless it only brings the vehicle down (`leads_home`); anything else when
    it ends farther from home than the vehicle is now.
    """
    if isinstance(body, FlyMission):
        return not leads_home(body.mission, vehicle, situation.airspace)
    way = way_of(body, vehicle)
    if way is None:
        return True
    points, _ = way
    start_m, end_m = (hypot(point[0], point[1]) for point in (points[0], points[-1]))
    return end_m > start_m + situation.settings.energy.nearer_m


def way_of(body: Body, vehicle: VehicleState) -> Way | None:
    """Return where a steered order or a stick leads; None when place or home is unknown."""
    here, base = place_of(vehicle), home(vehicle)
    if here is None or base is None:
        return None
    match body:
        case GoTo():
            north_m, east_m = offset_north_east_m(base, body.target)
            return [here, (north_m, east_m, body.height_above_takeoff_m)], body.speed_mps
        case Nudge():
            moved = here[0] + body.north_m, here[1] + body.east_m, here[2] + body.up_m
            return [here, moved], body.speed_mps
        case VirtualStick():
            return _stick_way(here, body)
        case _:
            return [here], 0.0


def _stick_way(here: Point, stick: VirtualStick) -> Way:
    """As far as an app flies on by itself.

    Which way a body's velocity will lead is not sure while it turns: it counts as away from home.
    """
    speed_mps = hypot(stick.velocity_x_mps, stick.velocity_y_mps)
    north_m, east_m = stick.velocity_x_mps * stick.timeout_s, stick.velocity_y_mps * stick.timeout_s
    if stick.frame is StickFrame.BODY:
        away_rad, reach_m = atan2(here[1], here[0]), speed_mps * stick.timeout_s
        north_m, east_m = reach_m * cos(away_rad), reach_m * sin(away_rad)
    end = here[0] + north_m, here[1] + east_m, stick.height_above_takeoff_m
    return [here, end], speed_mps
