"""A path of waypoints for the steering law: one goal after the other. Pure.

The law settles on a goal; on a path it need not: a corner counts as reached within `corner_m`, at
walking pace, and the vehicle turns. On the way between two waypoints the height follows the
straight line between them, since that is what was judged, and the progress is what height takes.
"""

from dataclasses import dataclass, replace
from math import atan2, degrees, hypot, inf

from recon.geo.distance import offset_north_east_m
from recon.guidance.steering import Goal, KinematicState, SteeringSettings
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint

CORNER_M = 2.0
"""What the law has left of its speed there is 1 m/s: no aircraft is carried past a corner by it."""

UPRIGHT_M = 1.0
"""A leg that is shorter over ground is a climb or descent on the spot."""


@dataclass(frozen=True, slots=True)
class SteeredPath:
    """A path being flown: towards the waypoint at `index`, from the place where that leg began."""

    mission: Mission
    index: int
    start: LatLon
    start_height_above_takeoff_m: float
    start_yaw_deg: float

    @property
    def waypoint(self) -> Waypoint:
        """The waypoint that it flies to."""
        return self.mission.waypoints[self.index]

    @property
    def is_on_last_leg(self) -> bool:
        """Whether no waypoint comes after the one that it flies to."""
        return self.index + 1 == len(self.mission.waypoints)


def path_from(mission: Mission, seen: KinematicState) -> SteeredPath:
    """Return the path from where a vehicle is to the mission's first waypoint and on."""
    return SteeredPath(mission, 0, seen.position, seen.height_above_takeoff_m, seen.yaw_deg)


def advanced(path: SteeredPath, seen: KinematicState, settings: SteeringSettings) -> SteeredPath:
    """Return the path on its next leg where the vehicle has reached the corner, else as it is."""
    if path.is_on_last_leg or not _is_at(path.waypoint, seen, settings):
        return path
    here = path.waypoint
    return replace(
        path,
        index=path.index + 1,
        start=_place(here),
        start_height_above_takeoff_m=here.height_above_takeoff_m,
        start_yaw_deg=leg_yaw_deg(path),
    )


def leg_yaw_deg(path: SteeredPath) -> float:
    """Return the heading along the present leg; on one that is upright, the heading before it."""
    north_m, east_m = offset_north_east_m(path.start, _place(path.waypoint))
    is_upright = hypot(north_m, east_m) < UPRIGHT_M
    return path.start_yaw_deg if is_upright else degrees(atan2(east_m, north_m))


def goal_on(path: SteeredPath, seen: KinematicState, settings: SteeringSettings) -> Goal:
    """Return the goal now: the leg's end, at the height of the leg where the vehicle is."""
    waypoint = path.waypoint
    speed_mps = path.mission.waypoints[max(0, path.index - 1)].speed_mps
    progress_mps = inf
    along = offset_north_east_m(path.start, _place(waypoint))
    far_m = hypot(*along)
    rise_m = waypoint.height_above_takeoff_m - path.start_height_above_takeoff_m
    height_m = waypoint.height_above_takeoff_m
    if far_m >= UPRIGHT_M:
        flown = offset_north_east_m(path.start, seen.position)
        share = (flown[0] * along[0] + flown[1] * along[1]) / far_m**2
        ahead = seen.speed_mps * (seen.age_s + settings.latency_s) / far_m
        height_m -= (1.0 - min(1.0, max(0.0, share + ahead))) * rise_m
        rate_mps = settings.climb_mps if rise_m > 0.0 else settings.sink_mps
        progress_mps = rate_mps * far_m / max(abs(rise_m), 1e-9)
    return Goal(_place(waypoint), height_m, speed_mps, leg_yaw_deg(path), progress_mps)


def _is_at(waypoint: Waypoint, seen: KinematicState, settings: SteeringSettings) -> bool:
    lead_s = min(seen.age_s + settings.latency_s, settings.longest_lead_s)
    north_m, east_m = offset_north_east_m(seen.position, _place(waypoint))
    left_m = hypot(
        north_m - seen.velocity_north_mps * lead_s, east_m - seen.velocity_east_mps * lead_s
    )
    height_m = abs(waypoint.height_above_takeoff_m - seen.height_above_takeoff_m)
    return left_m <= CORNER_M and height_m <= settings.arrived_height_m


def _place(waypoint: Waypoint) -> LatLon:
    return LatLon(waypoint.latitude_deg, waypoint.longitude_deg)
