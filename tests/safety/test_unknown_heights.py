"""Heights over takeoff points whose ground is not known separate no vehicles."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.traffic import AIR, FRAME, ORIGIN, aircraft, at, judged, route
from tests.safety.watchdogs.looks import in_context, looks

from recon.model.airspace import Airspace, ElevationModel, LandingPad
from recon.model.geo import GeoPoint, GroundGrid
from recon.model.vehicle import VehicleState
from recon.safety import PreparedAirspace
from recon.safety.datum import is_takeoff_height_known
from recon.safety.watchdogs.separation import separation

SOUTH, NORTH = (-40.0, 0.0), (40.0, 0.0)


def pad(north_m: float) -> GeoPoint:
    return GeoPoint(ORIGIN.latitude_deg + north_m / 111_070.7, ORIGIN.longitude_deg, 275.0)


def pair(first_m: float, second_m: float, **more: object) -> tuple[VehicleState, VehicleState]:
    """Two at one place, at these heights above takeoff points 80 m from each other."""
    a = aircraft("A", (0.0, 0.0), first_m, home=SOUTH, **more)  # type: ignore[arg-type]
    b = aircraft("B", (0.0, 12.0), second_m, home=NORTH, **more)  # type: ignore[arg-type]
    return a, b


def with_pads(a: VehicleState, b: VehicleState) -> tuple[VehicleState, VehicleState]:
    assert a.profile is not None
    assert b.profile is not None
    return (
        replace(a, profile=replace(a.profile, pad=pad(-40.0))),
        replace(b, profile=replace(b.profile, pad=pad(40.0))),
    )


def test_the_gate_counts_no_height_between_them() -> None:
    a, b = pair(70.0, 40.0)
    over = route((0.0, 0.0, 70.0), (0.0, 60.0, 70.0))
    refusal = judged(over, a, b)
    assert refusal is not None
    assert "0 m in height" in refusal.reason
    assert judged(over, *with_pads(a, b)) is None


def test_the_watchdog_counts_none_either() -> None:
    for gap_m in (0.0, 30.0, 100.0):
        a, b = pair(40.0 + gap_m, 40.0)
        found = looks(separation, in_context(a), in_context(b))
        assert [finding.rule for finding in found] == ["separation"]
    assert looks(separation, *map(in_context, with_pads(*pair(70.0, 40.0)))) == []
    (level,) = looks(separation, *map(in_context, with_pads(*pair(43.0, 40.0))))
    assert "3 m in height" in level.text


def test_the_watchdog_counts_none_to_a_hazard_area_either() -> None:
    """Flat ground is assumed under both: the lost one may be as high as the other."""
    a, b = pair(100.0, 40.0)
    lost = aircraft("B", (0.0, 12.0), 40.0, home=NORTH, age_s=10.0)
    for shown in (lost, replace(lost, position=b.position)):
        found = looks(separation, in_context(a), in_context(shown))
        assert [finding.rule for finding in found] == ["separation"]
    assert looks(separation, *map(in_context, with_pads(a, lost))) == []


def test_takeoffs_at_one_place_have_one_height() -> None:
    a, b = pair(70.0, 40.0)
    near = replace(b, takeoff_point=aircraft("B", home=(-35.0, 0.0)).takeoff_point)
    assert looks(separation, in_context(a), in_context(near)) == []


def test_an_unknown_takeoff_point_has_none() -> None:
    a, b = with_pads(*pair(70.0, 40.0))
    unknown = replace(b, takeoff_point=None, profile=replace(b.profile, pad=None))  # type: ignore[type-var]
    assert [f.rule for f in looks(separation, in_context(a), in_context(unknown))] == ["separation"]


@pytest.mark.parametrize(("north_m", "is_known"), [(-40.0, True), (-28.0, False)])
def test_a_pad_within_10_m_makes_it_known(north_m: float, is_known: bool) -> None:
    pads = (LandingPad("pad", None, pad(-40.0)),)
    airspace = PreparedAirspace(Airspace(frame=FRAME, landing_pads=pads))
    vehicle = aircraft("A", home=(north_m, 0.0))
    assert is_takeoff_height_known(airspace, vehicle, vehicle.takeoff_point) is is_known
    assert not is_takeoff_height_known(AIR, vehicle, vehicle.takeoff_point)
    assert not is_takeoff_height_known(airspace, vehicle, None)


def test_so_does_an_elevation_model_where_it_has_ground() -> None:
    grid = GroundGrid(FRAME, west_m=-50.0, north_m=50.0, cell_m=50.0, rows=2, cols=2)
    elevation = ElevationModel(grid, np.full((2, 2), 275.0))
    airspace = PreparedAirspace(Airspace(frame=FRAME, elevation=elevation))
    vehicle = aircraft("A")
    assert is_takeoff_height_known(airspace, vehicle, at(20.0, 0.0))
    assert not is_takeoff_height_known(airspace, vehicle, at(60.0, 0.0))


def test_without_a_profile_it_is_not_known_over_flat_ground() -> None:
    vehicle = replace(aircraft("A"), profile=None)
    assert not is_takeoff_height_known(AIR, vehicle, vehicle.takeoff_point)
