"""The proposed place upwind: what it is refused for, what stays allowed, and that it is flown."""

from dataclasses import replace
from math import hypot, radians

import numpy as np
import pytest
from tests.station.imager_world import GRID, IMAGER, ImagerWorld, imager_world

from recon.forecast import ForecastState
from recon.geo import enu_from_point
from recon.guidance.upwind_proposal import SPEED_MPS, UpwindProposal
from recon.model.airspace import Airspace, Region, Zone, ZoneKind
from recon.model.command import GoTo
from recon.model.event import OperatorOrder
from recon.model.geo import GeoPoint, LatLon
from recon.model.imagery import Outlook
from recon.model.shade import ShadeMap, SunForecast
from recon.safety import PreparedAirspace
from recon.station.imaging.upwind import proposed

EASTWARD = (5.0, 0.0)
SQUARE = Region(190.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]))
LEVEL, TILTED = Outlook(radians(65.0)), Outlook(radians(65.0), radians(20.0), 30.0)


NO_VALUE = np.full((GRID.rows, GRID.cols), np.nan, np.float32)
NOTHING = ShadeMap(
    GRID, 0, (), NO_VALUE, np.zeros(NO_VALUE.shape, np.bool_), np.zeros_like(NO_VALUE), NO_VALUE
)


def forecast(at_ns: int, velocity: tuple[float, float] | None) -> SunForecast:
    cells = (GRID.rows, GRID.cols)
    return SunForecast(
        GRID,
        at_ns,
        np.array([0.0]),
        np.zeros((1, *cells), np.uint8),
        np.zeros(cells, np.float32),
        0.5,
        "advection",
        velocity,
    )


def knowing(
    outlook: Outlook = LEVEL, velocity: tuple[float, float] | None = EASTWARD, age_s: float = 0.0
) -> ImagerWorld:
    """An imaging drone above the middle of the region, and a forecast with this motion."""
    world = imager_world(place_m=(0.0, 0.0), height_m=118.0)
    station, now_ns = world.station, world.surveyed.driver.now_ns
    imager = replace(station.imaging.imagers[IMAGER], outlook=outlook)
    sun = forecast(now_ns - round(age_s * 1e9), velocity)
    world.station = replace(
        station,
        imaging=replace(station.imaging, imagers={IMAGER: imager}),
        shade=replace(station.shade, sun=sun, forecast=ForecastState(followed=NOTHING)),
    )
    return world


def proposal(world: ImagerWorld, serial: str | None = None) -> UpwindProposal | str:
    return proposed(world.station, [SQUARE], serial, world.surveyed.driver.now_ns)


def found(world: ImagerWorld) -> UpwindProposal:
    answer = proposal(world)
    assert isinstance(answer, UpwindProposal), answer
    return answer


def place_m(place: LatLon) -> tuple[float, float]:
    ground = GeoPoint(place.latitude_deg, place.longitude_deg, GRID.frame.origin.ellipsoid_height_m)
    east_m, north_m, _up_m = enu_from_point(GRID.frame, ground).tolist()
    return east_m, north_m


def test_it_lies_where_the_shade_comes_from_and_sees_more() -> None:
    answer = found(knowing())
    east_m, north_m = place_m(answer.place)
    assert east_m < -40.0
    assert abs(north_m) <= 80.0
    assert answer.there.predicted_at(30.0) > answer.here.predicted_at(30.0)
    assert answer.distance_m == pytest.approx(hypot(east_m, north_m), abs=3.0)
    assert answer.takes_s == pytest.approx(answer.distance_m / SPEED_MPS)
    assert answer.height_above_takeoff_m == pytest.approx(118.0, abs=1.0)


def test_a_level_camera_keeps_its_heading_and_a_tilted_one_looks_upwind() -> None:
    level, tilted = knowing(), knowing(TILTED)
    heading = level.station.fleet.vehicles[IMAGER].attitude.value
    assert heading is not None
    assert found(level).yaw_deg == pytest.approx(heading.yaw_deg, abs=1.0)
    # Its camera looks 30 degrees to the right of the front, so the front points to the left of it.
    assert found(tilted).yaw_deg % 360.0 == pytest.approx(240.0)


def test_flown_as_a_goto_the_drone_then_hovers_at_the_best_place() -> None:
    world = knowing()
    answer = found(world)
    body = GoTo(answer.place, answer.height_above_takeoff_m, SPEED_MPS, answer.yaw_deg)
    world.surveyed.driver.handle(OperatorOrder(7, body, "ann", serial=IMAGER, person="ann"))
    world.surveyed.runs(answer.takes_s + 20.0)
    now_ns = world.surveyed.driver.now_ns
    world.station = replace(
        world.station, shade=replace(world.station.shade, sun=forecast(now_ns, EASTWARD))
    )
    assert hypot(*world.off_m()) == pytest.approx(answer.distance_m, abs=5.0)
    again = found(world)
    assert again.there is again.here
    assert again.distance_m == 0.0


@pytest.mark.parametrize("kind", ["boundary", "keep-out"])
def test_it_stays_inside_the_boundary_and_outside_keep_out_zones(kind: str) -> None:
    world = knowing()
    west_m = -70.0
    shut = np.array([[-900.0, -900.0], [west_m, -900.0], [west_m, 900.0], [-900.0, 900.0]])
    if kind == "boundary":
        inside = np.array([[west_m, -900.0], [900.0, -900.0], [900.0, 900.0], [west_m, 900.0]])
        airspace = Airspace(frame=GRID.frame, boundary=Region(inside))
    else:
        zone = Zone("farmyard", ZoneKind.KEEP_OUT, Region(shut))
        airspace = Airspace(frame=GRID.frame, zones=(zone,))
    free_m = place_m(found(world).place)[0]
    world.station = replace(world.station, airspace=PreparedAirspace(airspace))
    bound_m = place_m(found(world).place)[0]
    assert free_m < west_m
    assert bound_m >= west_m + 30.0


@pytest.mark.parametrize(
    ("world", "sentence"),
    [
        (lambda: knowing(velocity=None), "the shadows' motion is not known yet"),
        (lambda: knowing(age_s=90.0), "more than a minute old"),
    ],
)
def test_without_a_recent_motion_there_is_no_place(world: object, sentence: str) -> None:
    assert callable(world)
    answer = proposal(world())
    assert isinstance(answer, str)
    assert sentence in answer


def test_another_drone_no_region_and_one_on_the_ground_are_said() -> None:
    world = knowing()
    now_ns = world.surveyed.driver.now_ns
    assert proposal(world, "OTHER") == "expected an imaging drone of the site, got OTHER"
    none = proposed(world.station, [], None, now_ns)
    assert isinstance(none, str)
    assert none.startswith("expected a survey region")
    vehicle = world.station.fleet.vehicles[IMAGER]
    landed = replace(vehicle, is_flying=replace(vehicle.is_flying, value=False))
    fleet = replace(world.station.fleet, vehicles={**world.station.fleet.vehicles, IMAGER: landed})
    world.station = world.station.with_fleet(fleet)
    answer = proposal(world)
    assert isinstance(answer, str)
    assert "not in the air" in answer


@pytest.mark.parametrize("height_m", [-3.0, 2.0])
def test_a_drone_that_is_too_low_has_no_place(height_m: float) -> None:
    """Below the takeoff point on a slope: a sentence, no mathematical error."""
    world = knowing()
    vehicle = world.station.fleet.vehicles[IMAGER]
    low = replace(
        vehicle, height_above_takeoff_m=replace(vehicle.height_above_takeoff_m, value=height_m)
    )
    fleet = replace(world.station.fleet, vehicles={**world.station.fleet.vehicles, IMAGER: low})
    world.station = world.station.with_fleet(fleet)
    answer = proposal(world)
    assert isinstance(answer, str)
    assert "lower than 10 m above takeoff" in answer


def test_old_telemetry_is_no_place_to_fly_from() -> None:
    world = knowing()
    later_ns = world.surveyed.driver.now_ns + 20_000_000_000
    answer = proposed(world.station, [SQUARE], None, later_ns)
    assert isinstance(answer, str)
    assert "needs position, velocity, height and heading" in answer
