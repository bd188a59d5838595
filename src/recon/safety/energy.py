"""How much of its battery a vehicle needs: the station's energy model.

It counts time under load. A full battery hovers for the profile's `endurance_s`; each second of
level flight, climb or descent costs its load times that of a second of hovering, all of it times
the load of the wind, which the aircraft warns of in three levels. So a fraction of a battery is
loaded seconds over endurance.

- A leg costs its level part at the leg's speed and, after that, its vertical part: climbing while
  flying is no cheaper than one after the other. Unless the mission is curved, each leg begins and
  ends at rest.
- A waypoint costs its loiter and the turn of its gimbal.
- The route home from a point costs the climb to the go-home height, the straight path at that
  height, and the landing. While that height is unknown, the highest the site allows is assumed.

The route home is dearest at the end of a leg: along it, both the path flown and the straight route
home are convex. So it is enough to ask at the legs' ends. Points are (north_m, east_m, height_m):
from home, height above takeoff. `docs/energy-model.md` explains it for pilots.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import atan2, cos, hypot, sin

from recon.geo.distance import offset_north_east_m
from recon.model.airspace import FlightLimits
from recon.model.command import Body, StickFrame, mission_of_body
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import home
from recon.safety.path.order_path import StickFlight, StraightFlight, order_path
from recon.safety.return_missions import leads_home
from recon.safety.settings import EnergySettings

Point = tuple[float, float, float]
"""North and east of home, and above takeoff, in metres."""

FlownPath = tuple[Sequence[Point], float]
"""The points of a path from home, the first where the vehicle is, and the speed in m/s."""


@dataclass(frozen=True, slots=True)
class Consumption:
    """What one vehicle uses, in the air as it is now."""

    endurance_s: float
    wind_load: float
    go_home_height_m: float
    settings: EnergySettings

    def fraction(self, loaded_s: float) -> float:
        """Return the share of a full battery for seconds under load, in the present wind."""
        return loaded_s * self.wind_load / self.endurance_s

    def leg(self, start: Point, end: Point, speed_mps: float, *, stops: bool = True) -> float:
        """Return the fraction for one leg; with `stops` it begins and ends at rest."""
        s = self.settings
        level_m, up_m = _distance_m(start, end), end[2] - start[2]
        level_s = level_m / max(speed_mps, s.slowest_mps)
        if stops and level_m > 0.0:
            level_s += speed_mps / s.brake_mps2
        vertical = _vertical(up_m, s)
        return self.fraction(level_s * s.level_load + vertical)

    def home(self, point: Point) -> float:
        """Return the fraction for the route home from a point, landing included."""
        s = self.settings
        height_m = max(point[2], self.go_home_height_m)
        above: Point = (0.0, 0.0, height_m)
        turned: Point = (point[0], point[1], height_m)
        climb = self.fraction(_vertical(height_m - point[2], s))
        return climb + self.leg(turned, above, s.home_mps) + self.landing(height_m)

    def landing(self, height_m: float) -> float:
        """Return the fraction for landing from a height."""
        return self.fraction(self.settings.landing_s(height_m) * self.settings.sink_load)

    def level_flight_s(self, has: float, height_m: float, reserve: float) -> float:
        """Return how long a charge lasts for level flight from a height, above its pad.

        It leaves the climb to the go-home height, the landing and the reserve; all are fractions.
        """
        s = self.settings
        climb_m = max(0.0, self.go_home_height_m - height_m)
        ends = self.fraction(_vertical(climb_m, s)) + self.landing(
            max(height_m, self.go_home_height_m)
        )
        return max(0.0, has - reserve - ends) / self.fraction(s.level_load)


@dataclass(frozen=True, slots=True)
class Need:
    """What a path asks of the battery: the most, at any of its points, to fly there and then home.

    `flown` is the share used until there, `back` the route home from there, `at` the number of that
    point in the path; 0 is where it starts.
    """

    flown: float
    back: float
    at: int

    @property
    def whole(self) -> float:
        """Both together."""
        return self.flown + self.back


def consumption(
    vehicle: VehicleState, airspace: PreparedAirspace, settings: EnergySettings
) -> Consumption | None:
    """Return what a vehicle uses, or None while its profile has no endurance."""
    if vehicle.profile is None:
        return None
    limits, wind_load = airspace.airspace.limits, _wind_load(vehicle, settings)
    return profile_consumption(vehicle.profile, limits, wind_load, settings)


def profile_consumption(
    profile: VehicleProfile, limits: FlightLimits, wind_load: float, settings: EnergySettings
) -> Consumption | None:
    """Return what a vehicle of this profile uses in a wind, or None without an endurance."""
    if profile.endurance_s is None:
        return None
    height_m = profile.go_home_height_m
    if height_m is None:
        height_m = limits.max_height_above_ground_m
    return Consumption(profile.endurance_s, wind_load, height_m, settings)


def place_of(vehicle: VehicleState) -> Point | None:
    """Return a vehicle's last known position relative to its home; None when either is unknown."""
    at, base = vehicle.position.value, home(vehicle)
    height_m = vehicle.height_above_takeoff_m.value
    if at is None or base is None or height_m is None:
        return None
    return (*offset_north_east_m(base, at), height_m)


def fraction_to_get_home(
    vehicle: VehicleState, airspace: PreparedAirspace, settings: EnergySettings
) -> float | None:
    """Return the share of a full battery that the route home takes from where a vehicle is now.

    From straight above its takeoff point it is the landing's. None when its endurance, its place
    or its home is unknown.
    """
    uses, here = consumption(vehicle, airspace, settings), place_of(vehicle)
    return None if uses is None or here is None else uses.home(here)


def need_of(uses: Consumption, vehicle: VehicleState, body: Body) -> Need | None:
    """Return what an order to move needs, the route home included; None while that is unknown."""
    mission = mission_of_body(body)
    if mission is not None:
        points = mission_points(vehicle, mission)
        return None if points is None else mission_need(uses, points, mission)
    path = path_of(body, vehicle, uses.settings)
    return None if path is None else path_need(uses, *path)


def leads_away(
    body: Body, vehicle: VehicleState, airspace: PreparedAirspace, settings: EnergySettings
) -> bool:
    """Return whether an order to move leads away from home; what is unknown does.

    A mission leads away unless it only brings the vehicle down (`leads_home`); anything else when
    it ends farther from home than the vehicle is now.
    """
    mission = mission_of_body(body)
    if mission is not None:
        return not leads_home(mission, vehicle, airspace)
    path = path_of(body, vehicle, settings)
    if path is None:
        return True
    points, _ = path
    start_m, end_m = (hypot(point[0], point[1]) for point in (points[0], points[-1]))
    return end_m > start_m + settings.nearer_m


def path_of(body: Body, vehicle: VehicleState, settings: EnergySettings) -> FlownPath | None:
    """Return where a steered order or a stick leads; None when place or home is unknown."""
    here, base = place_of(vehicle), home(vehicle)
    if here is None or base is None:
        return None
    path = order_path(body, vehicle)
    match path:
        case StraightFlight(target, height_m, speed_mps):
            north_m, east_m = offset_north_east_m(base, target)
            # A vehicle with a place has a height.
            assert height_m is not None
            return [here, (north_m, east_m, height_m)], speed_mps
        case StickFlight():
            return [here, _stick_end(here, path, settings)], path.speed_mps
        case _:
            return [here], 0.0


def _stick_end(here: Point, path: StickFlight, settings: EnergySettings) -> Point:
    """The direction of a body's velocity while it turns is uncertain: it leads away from home."""
    reach_m = path.reach_m(settings.stick)
    angle_rad = atan2(path.east_mps, path.north_mps)
    if path.frame is StickFrame.BODY:
        angle_rad = atan2(here[1], here[0])
    north_m, east_m = reach_m * cos(angle_rad), reach_m * sin(angle_rad)
    return here[0] + north_m, here[1] + east_m, path.height_above_takeoff_m


def path_need(uses: Consumption, points: Sequence[Point], speed_mps: float) -> Need:
    """Return what straight legs at one speed need, from the first point, the route home
    included."""
    legs = [uses.leg(start, end, speed_mps) for start, end in pairwise(points)]
    return _dearest(uses, points, legs)


def mission_points(vehicle: VehicleState, mission: Mission) -> list[Point] | None:
    """Return where a mission leads, its waypoints after where the vehicle is; None if unknown."""
    here, base = place_of(vehicle), home(vehicle)
    if here is None or base is None:
        return None
    waypoints: list[Point] = [
        (
            *offset_north_east_m(base, LatLon(waypoint.latitude_deg, waypoint.longitude_deg)),
            waypoint.height_above_takeoff_m,
        )
        for waypoint in mission.waypoints
    ]
    return [here, *waypoints]


def mission_need(uses: Consumption, points: Sequence[Point], mission: Mission) -> Need:
    """Return what a mission needs, from where the vehicle is on, the route home included.

    The path to the first waypoint is flown at that waypoint's speed; each waypoint's actions cost
    before its leg. One that lands at its end still must be able to come home from there.
    """
    stops = not mission.curved
    speeds = [mission.waypoints[0].speed_mps, *(w.speed_mps for w in mission.waypoints[:-1])]
    legs = [
        uses.leg(start, end, speed_mps, stops=stops)
        + uses.fraction(_pause_s(mission, number, uses))
        for number, ((start, end), speed_mps) in enumerate(
            zip(pairwise(points), speeds, strict=True)
        )
    ]
    return _dearest(uses, points, legs)


def _pause_s(mission: Mission, number: int, uses: Consumption) -> float:
    """How long the mission stops at one waypoint for its actions."""
    waypoint = mission.waypoints[number]
    turns_s = 0.0 if waypoint.gimbal_pitch_deg is None else uses.settings.gimbal_s
    return (waypoint.loiter_s or 0.0) + turns_s


def _dearest(uses: Consumption, points: Sequence[Point], legs: Sequence[float]) -> Need:
    """The point from which flown path and route home together take most; the first of equals."""
    needs = (
        Need(flown, uses.home(points[at]), at)
        for at, flown in enumerate(accumulate(legs, initial=0.0))
    )
    return max(needs, key=lambda each: each.whole)


def _vertical(up_m: float, settings: EnergySettings) -> float:
    """Return the loaded seconds of a climb, or of a descent."""
    if up_m > 0.0:
        return up_m / settings.climb_mps * settings.climb_load
    return -up_m / settings.sink_mps * settings.sink_load


def _wind_load(vehicle: VehicleState, settings: EnergySettings) -> float:
    level = vehicle.wind_level.value
    if level is None:
        return settings.unknown_wind_load
    return settings.wind_loads[min(level, len(settings.wind_loads) - 1)]


def _distance_m(start: Point, end: Point) -> float:
    return hypot(end[0] - start[0], end[1] - start[1])
