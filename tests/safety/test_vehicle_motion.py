"""Vehicles in the plane: across the antimeridian, at unknown heights, over unknown ground."""

from dataclasses import replace

import pytest
from tests.safety.traffic import AIR, NOW, SETTINGS, aircraft, seen

from recon.model.geo import LatLon
from recon.model.units import Stamped
from recon.safety.prediction import Plane, unknown_heights, vehicle_motion
from recon.safety.prediction.trajectory import ALL_HEIGHTS_M

ANYWHERE = -ALL_HEIGHTS_M, ALL_HEIGHTS_M


@pytest.mark.parametrize(
    ("origin_deg", "place_deg"),
    [(10.0, 10.001), (179.9995, -179.9995), (-0.0005, 0.0005), (-180.0, -179.999)],
)
def test_east_is_the_shorter_way_round_the_globe(origin_deg: float, place_deg: float) -> None:
    """A thousandth of a degree at the equator."""
    origin, place = LatLon(0.0, origin_deg), LatLon(0.0, place_deg)
    assert Plane(origin).east_north_m(place) == pytest.approx((111.32, 0.0), abs=0.01)
    assert Plane(place).east_north_m(origin) == pytest.approx((-111.32, 0.0), abs=0.01)


def test_a_height_that_is_not_reported_may_be_any() -> None:
    unknown = seen(aircraft(height_m=None))
    assert (unknown.low_m, unknown.high_m) == ANYWHERE
    assert unknown.up_m(30.0) == (30.0, 30.0)


def test_at_any_height_nothing_of_its_heights_is_known() -> None:
    known = seen(aircraft())
    anywhere = known.at_any_height()
    assert (anywhere.low_m, anywhere.high_m) == anywhere.up_m(30.0) == ANYWHERE
    assert anywhere.go_home_up_m is None
    same = {"low_m": 40.0, "high_m": 40.0, "takeoff_up_m": 0.0, "go_home_up_m": 60.0}
    assert anywhere._replace(**same) == known


@pytest.mark.parametrize(
    ("known", "home_m", "is_unknown"),
    [
        ((True, True), (80.0, 0.0), False),
        ((True, False), (80.0, 0.0), True),
        ((False, True), (80.0, 0.0), True),
        ((False, False), (80.0, 0.0), True),
        ((True, False), (10.0, 0.0), False),
        ((False, False), (6.0, 8.0), False),
        ((False, False), (6.1, 8.0), True),
        ((False, False), (6.0, 8.1), True),
        ((False, False), None, True),
        ((True, False), None, True),
    ],
)
@pytest.mark.parametrize("from_m", [(0.0, 0.0), (300.0, -200.0)])
def test_heights_over_unknown_ground_are_compared_within_10_m_only(
    known: tuple[bool, bool],
    home_m: tuple[float, float] | None,
    is_unknown: bool,
    from_m: tuple[float, float],
) -> None:
    there_m = None if home_m is None else (from_m[0] + home_m[0], from_m[1] + home_m[1])
    one = seen(aircraft("A"))._replace(is_ground_known=known[0], home_m=from_m)
    other = one._replace(is_ground_known=known[1], home_m=there_m)
    found = unknown_heights((one, other))
    if all(known):
        assert found is None
    else:
        assert found is not None
        assert found[0, 1] == found[1, 0] == is_unknown


def test_a_position_is_as_old_as_its_last_report() -> None:
    state = aircraft()
    late = replace(state, position=Stamped(state.position.value, NOW - 2_500_000_000))
    found = vehicle_motion(late, AIR, Plane(LatLon(42.0, -93.6)), NOW, SETTINGS)
    assert found is not None
    assert found.age_s == 2.5
