"""Which zones are worth asking."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import FRAME

from recon.geo import Box, Footprints
from recon.model.airspace import Airspace, ElevationModel, Region, Zone, ZoneKind
from recon.model.geo import GroundGrid
from recon.safety import PreparedAirspace
from recon.safety.airspace import OPEN_AIRSPACE, Cylinder


def square(name: str, east_m: float) -> Zone:
    corners = [(east_m - 5.0, -5.0), (east_m + 5.0, -5.0), (east_m + 5.0, 5.0), (east_m - 5.0, 5.0)]
    return Zone(name, ZoneKind.KEEP_OUT, Region(np.array(corners)))


AIR = PreparedAirspace(Airspace(frame=FRAME, zones=(square("west", -50.0), square("east", 50.0))))


def near(*places_m: tuple[float, float], gap_m: float = 0.0) -> list[str]:
    """The zones near places, by name."""
    footprints = Footprints(np.array([[place] * 3 for place in places_m]))
    return [zone.zone.name for zone in AIR.zones_near(ZoneKind.KEEP_OUT, footprints, gap_m)]


def test_a_zone_is_near_that_is_near_to_any_of_them() -> None:
    assert near((-50.0, 0.0)) == ["west"]
    assert near((-50.0, 0.0), (50.0, 0.0)) == ["west", "east"]
    assert near((-58.0, 0.0), (42.0, 0.0)) == []
    assert near((-58.0, 0.0), (42.0, 0.0), gap_m=4.0) == ["west", "east"]
    assert AIR.zones_near(ZoneKind.HEIGHT, Footprints(np.zeros((1, 3, 2))), 0.0) == []


def test_a_zone_that_is_just_as_far_as_the_gap_is_near() -> None:
    assert near((-55.0, -5.0)) == near((-45.0, 5.0)) == ["west"]
    assert near((-59.0, -9.0), gap_m=4.0) == near((-41.0, 9.0), gap_m=4.0) == ["west"]
    assert near((-59.1, 0.0), gap_m=4.0) == near((0.0, 9.1), (-50.0, 9.1), gap_m=4.0) == []


def test_one_that_is_between_all_and_near_to_none_is_not() -> None:
    assert near((-90.0, 40.0), (90.0, -40.0)) == []


def test_what_is_not_finite_may_be_near_to_every_zone() -> None:
    assert near((np.nan, 0.0)) == ["west", "east"]


KEEP_OUT = (ZoneKind.KEEP_OUT,)


def test_a_circle_may_touch_a_zone_that_its_box_meets() -> None:
    assert AIR.may_touch_zone(KEEP_OUT, Cylinder(-60.0, 0.0, 6.0, 10.0, 20.0))
    assert not AIR.may_touch_zone(KEEP_OUT, Cylinder(-60.0, 0.0, 4.0, 10.0, 20.0))
    assert not AIR.may_touch_zone((ZoneKind.HEIGHT,), Cylinder(-50.0, 0.0, 4.0, 10.0, 20.0))
    for nowhere in ((np.nan, 0.0, 4.0), (-90.0, np.nan, 4.0), (-90.0, 0.0, np.nan)):
        assert AIR.may_touch_zone(KEEP_OUT, Cylinder(*nowhere, 10.0, 20.0))


GRID = GroundGrid(FRAME, west_m=-100.0, north_m=100.0, cell_m=20.0, rows=10, cols=10)
SLOPE = PreparedAirspace(
    Airspace(
        frame=FRAME,
        elevation=ElevationModel(
            GRID, FRAME.origin.ellipsoid_height_m + np.linspace(0.0, 30.0, 100).reshape(10, 10)
        ),
    )
)
"""Ground from 0 m in the north-west up to 30 m in the south-east; 5 to 120 m above it are allowed.
"""


def test_heights_are_sure_only_over_known_ground() -> None:
    def is_sure(east_m: float, radius_m: float, low_m: float, high_m: float) -> bool:
        return SLOPE.is_surely_between_heights(Cylinder(east_m, 0.0, radius_m, low_m, high_m))

    assert is_sure(0.0, 50.0, 36.0, 119.0)
    assert not is_sure(0.0, 50.0, 34.0, 119.0)
    assert not is_sure(0.0, 50.0, 36.0, 121.0)
    assert is_sure(0.0, 50.0, 35.0, 120.0)
    assert not is_sure(60.0, 50.0, 36.0, 119.0)


@pytest.mark.parametrize(
    ("low_m", "high_m", "is_sure"),
    [(5.0, 120.0, True), (4.9, 120.0, False), (5.0, 120.1, False)],
)
def test_without_elevation_model_heights_are_sure_over_flat_ground(
    low_m: float, high_m: float, is_sure: bool
) -> None:
    cylinder = Cylinder(5_000.0, 0.0, 50.0, low_m, high_m)
    assert OPEN_AIRSPACE.is_surely_between_heights(cylinder) is is_sure


@settings(max_examples=examples(200))
@given(
    st.tuples(st.floats(-120.0, 120.0), st.floats(-120.0, 120.0)),
    st.floats(0.0, 60.0),
    st.floats(0.0, 150.0),
    st.floats(0.0, 50.0),
)
def test_sure_heights_keep_the_limits_over_all_ground_below(
    middle_m: tuple[float, float], radius_m: float, low_m: float, thick_m: float
) -> None:
    east_m, north_m = middle_m
    cylinder = Cylinder(east_m, north_m, radius_m, low_m, low_m + thick_m)
    if SLOPE.is_surely_between_heights(cylinder):
        limits = SLOPE.airspace.limits
        offsets_m = radius_m * np.array([(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)])
        lowest_m, highest_m = SLOPE.ground_within_up_m((offsets_m + middle_m)[np.newaxis])
        assert low_m - highest_m[0] >= limits.min_height_above_ground_m
        assert low_m + thick_m - lowest_m[0] <= limits.max_height_above_ground_m


@settings(max_examples=examples(200))
@given(
    st.tuples(st.floats(-120.0, 120.0), st.floats(-120.0, 120.0)),
    st.floats(0.0, 60.0),
    st.floats(-20.0, 150.0),
    st.floats(-50.0, 120.0),
)
def test_what_is_surely_above_or_below_is_so_over_all_ground_below(
    corner_m: tuple[float, float], wide_m: float, up_m: float, height_m: float
) -> None:
    west_m, south_m = corner_m
    box = Box(west_m, south_m, west_m + wide_m, south_m + wide_m)
    triangle_m = np.array([[(west_m, south_m), (box.east_m, south_m), (west_m, box.north_m)]])
    lowest_m, highest_m = SLOPE.ground_within_up_m(triangle_m)
    if SLOPE.is_surely_above(box, up_m, height_m):
        assert up_m - height_m >= highest_m[0]
    if SLOPE.is_surely_below(box, up_m, height_m):
        assert up_m - height_m <= lowest_m[0]


def test_heights_over_a_box_are_sure_only_over_known_ground() -> None:
    inside, outside = Box(-20.0, -20.0, 20.0, 20.0), Box(-20.0, -20.0, 2_000.0, 20.0)
    assert SLOPE.is_surely_above(inside, 35.0, 5.0)
    assert not SLOPE.is_surely_above(inside, 34.9, 5.0)
    assert not SLOPE.is_surely_above(outside, 36.0, 5.0)
    assert SLOPE.is_surely_below(inside, 120.0, 120.0)
    assert not SLOPE.is_surely_below(inside, 120.1, 120.0)
    assert not SLOPE.is_surely_below(outside, 119.0, 120.0)
    assert OPEN_AIRSPACE.is_surely_above(outside, 5.0, 5.0)
    assert not OPEN_AIRSPACE.is_surely_above(outside, 4.0, 5.0)
    assert OPEN_AIRSPACE.is_surely_below(outside, 120.0, 120.0)
    assert not OPEN_AIRSPACE.is_surely_below(outside, 121.0, 120.0)
