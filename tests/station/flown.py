"""Reports of a vehicle that flies north in a straight line."""

from dataclasses import replace

from tests.fleet.reports import PLACE, core, extended
from tests.safety.cases import mission, waypoint
from tests.station.commanded import CommandedStation

from recon.geo.distance import offset_north_east_m
from recon.model.command import Body, FlyMission
from recon.model.geo import LatLon
from recon.model.report import Report
from recon.model.vehicle import FlightMode

METRES_PER_DEG = 111_070.7
WAYPOINT, GPS = FlightMode.GPS_WAYPOINT, FlightMode.GPS_ATTI
STANDING, NORTHWARD = (0.0, 0.0, 0.0), (5.0, 0.0, 0.0)


def at(
    north_m: float,
    mode: FlightMode | None,
    *,
    flying: bool | None = True,
    velocity: tuple[float, float, float] = STANDING,
    height_m: float = 40.0,
    gnss_level: int | None = 4,
) -> tuple[Report, ...]:
    """Reports of its app when it is this far north of the first waypoint."""
    place = LatLon(PLACE.latitude_deg + north_m / METRES_PER_DEG, PLACE.longitude_deg)
    reports = core(flying=flying, position=place, velocity=velocity, height_m=height_m)
    return reports, extended(mode=mode, gnss_level=gnss_level)


def hovering() -> CommandedStation:
    """A vehicle that hovers at the first waypoint."""
    reports = at(0.0, GPS)
    return CommandedStation().opens(1, *reports).keeps_receiving(1, *reports).passes(0.5)


def ordered(body: Body) -> tuple[CommandedStation, int]:
    """A vehicle that hovers, and an order to it that its app acknowledged."""
    scene = hovering()
    order = scene.order(body)
    scene.answered(order, True)
    return scene, order


def to_land(flown: FlyMission) -> FlyMission:
    """The same mission, but it lands at its end."""
    return FlyMission(replace(flown.mission, land_at_end=True))


def flies(scene: CommandedStation, *norths_m: float) -> CommandedStation:
    """The vehicle flies its mission past these places, a second at each."""
    for north_m in norths_m:
        # Half the way first: 15 m at once would be a jump.
        between_m = 0.5 * (north_m + _north_m(scene))
        scene.keeps_receiving(1, *at(between_m, WAYPOINT, velocity=NORTHWARD)).passes(0.1)
        scene.keeps_receiving(1, *at(north_m, WAYPOINT, velocity=NORTHWARD)).passes(0.9)
    return scene


def _north_m(scene: CommandedStation) -> float:
    """How far north of the first waypoint the vehicle reports now."""
    position = scene.station.fleet.vehicles["A"].position.value
    return 0.0 if position is None else offset_north_east_m(PLACE, position)[0]


def under_way(body: FlyMission | None = None) -> tuple[CommandedStation, int]:
    """A vehicle half way along a mission of 50 m northwards."""
    scene, order = ordered(body or mission())
    return flies(scene, 0.0, 10.0, 25.0), order


def at_the_end(body: FlyMission | None = None) -> tuple[CommandedStation, int]:
    """A vehicle that has come to the end of that mission, and is still in it."""
    scene, order = under_way(body)
    return flies(scene, 35.0, 45.0, 50.0), order


def row(count: int, spacing_m: float = 10.0) -> FlyMission:
    """A mission of many waypoints in a row northwards."""
    return mission(*(waypoint(spacing_m * number) for number in range(count)))
