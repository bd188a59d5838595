"""Sites, vehicles and orders in metres round a home, for the rules about places and heights."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from tests.safety.cases import NOW, PLACE, TAKEOFF, command, situation, vehicle

from recon.geo import geo_from_enu
from recon.model.airspace import (
    Airspace,
    ElevationModel,
    FlightLimits,
    HeightDatum,
    LandingPad,
    Region,
    Zone,
    ZoneKind,
)
from recon.model.command import Body, FlyMission, GoTo, Refusal, StickFrame, VirtualStick
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety import PreparedAirspace, Situation
from recon.safety.rules import Rule

ORIGIN = GeoPoint(PLACE.latitude_deg, PLACE.longitude_deg, 270.0)
FRAME = LocalFrame(ORIGIN)
WIDE = FlightLimits(max_height_above_ground_m=500.0, max_distance_from_home_m=8_000.0)

Point = tuple[float, float]
Point3 = tuple[float, float, float]


def place(east_m: float, north_m: float) -> LatLon:
    """The place on the globe this far from home."""
    latitude, longitude, _ = geo_from_enu(FRAME, (east_m, north_m, 0.0))
    return LatLon(float(latitude[0]), float(longitude[0]))


def region(*outline_m: Point, holes: Sequence[Sequence[Point]] = ()) -> Region:
    return Region(np.array(outline_m), tuple(np.array(hole) for hole in holes))


def square(west_m: float, south_m: float, east_m: float, north_m: float) -> Region:
    return region((west_m, south_m), (east_m, south_m), (east_m, north_m), (west_m, north_m))


def keep_out_zone(where: Region, **heights: Any) -> Zone:
    return zone(ZoneKind.KEEP_OUT, where, **heights)


def height_zone(where: Region, **heights: Any) -> Zone:
    return zone(ZoneKind.HEIGHT, where, **heights)


def zone(kind: ZoneKind, where: Region, **heights: Any) -> Zone:
    datum = HeightDatum.GROUND if heights else None
    return Zone("yard", kind, where, **{"datum": datum, **heights})


def airspace(
    *zones: Zone,
    boundary: Region | None = None,
    limits: FlightLimits = WIDE,
    elevation: ElevationModel | None = None,
    pads: Sequence[LandingPad] = (),
    frame: LocalFrame | None = FRAME,
) -> PreparedAirspace:
    return PreparedAirspace(Airspace(limits, frame, boundary, zones, tuple(pads), elevation))


def hills(heights_m: Any, *, cell_m: float = 100.0) -> ElevationModel:
    """Ground this high over the origin at the middles of cells; the grid is centred on home."""
    heights = np.asarray(heights_m, dtype=np.float64)
    rows, cols = heights.shape
    grid = GroundGrid(FRAME, -cols * cell_m / 2.0, rows * cell_m / 2.0, cell_m, rows, cols)
    return ElevationModel(grid, heights + ORIGIN.ellipsoid_height_m)


def flier(
    east_m: float = 0.0,
    north_m: float = 0.0,
    height_m: float = 40.0,
    *,
    go_home_m: float | None = 60.0,
    failsafe: Failsafe | None = Failsafe.GO_HOME,
    **changes: Any,
) -> VehicleState:
    """A vehicle that flies there, with its home at the origin."""
    profile = replace(TAKEOFF, go_home_height_m=go_home_m, failsafe=failsafe)
    known = {
        "position": Stamped(place(east_m, north_m), NOW),
        "height_above_takeoff_m": Stamped(height_m, NOW),
    }
    return vehicle(profile, **{**known, **changes})


def mission(
    *points: Point3, curved: bool = False, radius_m: float = 0.2, land: bool = False
) -> FlyMission:
    """East, north and height above takeoff of each waypoint; inner corners have the radius."""
    last = len(points) - 1
    waypoints = tuple(
        Waypoint(
            latitude_deg=place(east_m, north_m).latitude_deg,
            longitude_deg=place(east_m, north_m).longitude_deg,
            height_above_takeoff_m=height_m,
            speed_mps=5.0,
            corner_radius_m=radius_m if 0 < number < last else 0.2,
        )
        for number, (east_m, north_m, height_m) in enumerate(points)
    )
    return FlyMission(Mission(waypoints, land_at_end=land, curved=curved))


def goto(east_m: float, north_m: float, height_m: float = 40.0, speed_mps: float = 5.0) -> GoTo:
    return GoTo(place(east_m, north_m), height_m, speed_mps)


def stick(
    north_mps: float,
    east_mps: float,
    height_m: float = 40.0,
    timeout_s: float = 1.0,
    **changes: Any,
) -> VirtualStick:
    made = VirtualStick(StickFrame.GROUND, 0.0, north_mps, east_mps, height_m, timeout_s)
    return replace(made, **changes)


def here(air: PreparedAirspace, state: VehicleState | None = None) -> Situation:
    return replace(situation(state or flier()), airspace=air)


def asked(
    rule: Rule, body: Body, air: PreparedAirspace, state: VehicleState | None = None
) -> Refusal | None:
    """One rule's refusal of an order."""
    refusal = rule(command(body), here(air, state))
    assert refusal is None or refusal.rule == rule.__name__
    return refusal


def reason(refusal: Refusal | None) -> str:
    assert refusal is not None
    return refusal.reason
