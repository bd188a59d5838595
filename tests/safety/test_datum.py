"""Heights and places of vehicles, pads and ground in one frame, and what is not known."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.safety.cases import PLACE, TAKEOFF, vehicle
from tests.safety.fenced import ORIGIN, airspace, flier, hills, keep_out_zone, place, square

from recon.model.airspace import Airspace, LandingPad
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.units import Stamped
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.datum import (
    FEW_PLACES,
    frame_for,
    home,
    home_enu_m,
    is_ground_assumed_flat,
    places_m,
    takeoff_up_m,
    vehicle_enu_m,
)

FLAT = airspace()


def geo_point(at: LatLon, height_m: float) -> GeoPoint:
    return GeoPoint(at.latitude_deg, at.longitude_deg, height_m)


def pad(east_m: float, north_m: float, up_m: float, serial: str | None = None) -> LandingPad:
    at = geo_point(place(east_m, north_m), ORIGIN.ellipsoid_height_m + up_m)
    return LandingPad(f"pad {east_m:g} {north_m:g}", serial, at)


class TestPlacesInThePlane:
    @pytest.mark.parametrize("count", [FEW_PLACES, FEW_PLACES + 1])
    def test_many_at_once_are_where_each_is_alone(self, count: int) -> None:
        wanted = [(37.0 * n - 400.0, 250.0 - 21.0 * n) for n in range(count)]
        found = places_m(LocalFrame(ORIGIN), [place(*each) for each in wanted])
        assert found == pytest.approx(np.array(wanted), abs=0.01)

    def test_of_none_there_are_none(self) -> None:
        assert places_m(LocalFrame(ORIGIN), []).shape == (0, 2)


class TestHome:
    def test_in_the_air_it_is_where_the_vehicle_took_off(self) -> None:
        assert home(flier(300.0, 0.0)) == PLACE

    def test_or_else_its_pad(self) -> None:
        own = replace(TAKEOFF, pad=geo_point(place(70.0, 0.0), 270.0))
        assert home(vehicle(own, takeoff_point=None)) == place(70.0, 0.0)

    def test_on_the_ground_it_is_where_it_stands_not_where_it_once_took_off(self) -> None:
        stands = flier(50.0, 20.0, 0.0, is_flying=False)
        assert home(stands) == place(50.0, 20.0)
        assert home(replace(stands, position=Stamped())) == PLACE

    def test_otherwise_it_is_unknown(self) -> None:
        assert home(flier(takeoff_point=None)) is None
        assert home(vehicle(None, takeoff_point=None)) is None


class TestTakeoffHeight:
    def test_flat_ground_is_at_the_origins_height(self) -> None:
        assert takeoff_up_m(FLAT, flier()) == 0.0
        assert is_ground_assumed_flat(FLAT)

    def test_a_pad_within_ten_metres_tells_it(self) -> None:
        assert takeoff_up_m(airspace(pads=[pad(9.9, 0.0, 3.0)]), flier()) == pytest.approx(3.0)
        assert takeoff_up_m(airspace(pads=[pad(10.1, 0.0, 3.0)]), flier()) == 0.0

    def test_its_own_pad_comes_before_a_nearer_one(self) -> None:
        air = airspace(pads=[pad(1.0, 0.0, 3.0, "B"), pad(6.0, 0.0, 4.0, "A"), pad(0.0, 8.0, 5.0)])
        assert takeoff_up_m(air, flier()) == pytest.approx(4.0)
        assert takeoff_up_m(air, flier(serial="C")) == pytest.approx(3.0)
        assert takeoff_up_m(air, flier(serial=None)) == pytest.approx(3.0)

    def test_of_two_as_near_the_first_counts(self) -> None:
        air = airspace(pads=[pad(6.0, 0.0, 3.0), pad(6.0, 0.0, 4.0)])
        assert takeoff_up_m(air, flier()) == pytest.approx(3.0)

    def test_the_profiles_pad_counts_as_its_own(self) -> None:
        profile = replace(TAKEOFF, pad=geo_point(place(0.0, 7.0), 276.0))
        air = airspace(pads=[pad(1.0, 0.0, 3.0)])
        assert takeoff_up_m(air, vehicle(profile)) == pytest.approx(6.0)

    def test_else_the_elevation_model_does(self) -> None:
        air = airspace(elevation=hills([[0.0, 10.0], [0.0, 10.0]]))
        assert takeoff_up_m(air, flier()) == pytest.approx(5.0)
        assert not is_ground_assumed_flat(air)
        far = flier(takeoff_point=place(900.0, 0.0))
        assert takeoff_up_m(air, far) is None

    def test_without_a_takeoff_point_it_is_unknown(self) -> None:
        assert takeoff_up_m(FLAT, flier(takeoff_point=None)) is None

    def test_without_a_site_it_is_flat_everywhere(self) -> None:
        assert takeoff_up_m(OPEN_AIRSPACE, flier(takeoff_point=None)) == 0.0


class TestPlaces:
    def test_a_vehicle_is_at_its_takeoff_points_height_and_its_own(self) -> None:
        air = airspace(pads=[pad(0.0, 0.0, 3.0)])
        assert vehicle_enu_m(air, flier(30.0, -20.0, 40.0)) == pytest.approx(
            [30.0, -20.0, 43.0], abs=1e-3
        )

    def test_home_too(self) -> None:
        air = airspace(pads=[pad(0.0, 0.0, 3.0)])
        assert home_enu_m(air, flier(30.0)) == pytest.approx([0.0, 0.0, 3.0], abs=1e-6)

    def test_the_earths_curve_changes_no_height(self) -> None:
        """3 km away the globe is 0.7 m below the frame's plane: heights do not care."""
        there = vehicle_enu_m(FLAT, flier(3_000.0, 0.0, 40.0))
        assert there is not None
        assert there[2] == 40.0

    def test_without_a_site_the_frame_is_at_the_vehicle(self) -> None:
        state = flier(30.0, 0.0)
        assert frame_for(OPEN_AIRSPACE, state) == LocalFrame(geo_point(place(30.0, 0.0), 0.0))
        assert vehicle_enu_m(OPEN_AIRSPACE, state) == pytest.approx([0.0, 0.0, 40.0], abs=1e-6)
        assert home_enu_m(OPEN_AIRSPACE, state) == pytest.approx([-30.0, 0.0, 0.0], abs=0.01)

    def test_or_where_several_are_compared(self) -> None:
        state = flier(30.0, 0.0)
        there = vehicle_enu_m(OPEN_AIRSPACE, state, LocalFrame(geo_point(PLACE, 0.0)))
        assert there == pytest.approx([30.0, 0.0, 40.0], abs=0.01)

    @pytest.mark.parametrize(
        "unknown", [{"position": Stamped()}, {"height_above_takeoff_m": Stamped()}]
    )
    def test_a_vehicle_that_does_not_tell_is_nowhere(self, unknown: dict[str, object]) -> None:
        for air in (FLAT, OPEN_AIRSPACE):
            assert vehicle_enu_m(air, flier(**unknown)) is None

    def test_nothing_is_anywhere_without_a_takeoff_point(self) -> None:
        state = flier(takeoff_point=None)
        assert vehicle_enu_m(FLAT, state) is None
        assert home_enu_m(FLAT, state) is None
        assert home_enu_m(OPEN_AIRSPACE, state) is None

    def test_without_a_site_and_a_position_there_is_no_frame(self) -> None:
        state = flier(position=Stamped())
        assert frame_for(OPEN_AIRSPACE, state) is None
        assert home_enu_m(OPEN_AIRSPACE, state) is None


@pytest.mark.parametrize(
    "placed",
    [
        {"boundary": square(0.0, 0.0, 1.0, 1.0)},
        {"zones": (keep_out_zone(square(0.0, 0.0, 1.0, 1.0)),)},
        {"elevation": hills(np.zeros((2, 2)))},
    ],
    ids=lambda placed: next(iter(placed)),
)
def test_what_is_placed_in_metres_needs_a_frame(placed: dict[str, Any]) -> None:
    expected = r"^expected a frame for boundary, zones and elevation, got none$"
    with pytest.raises(ValueError, match=expected):
        PreparedAirspace(Airspace(**placed))


def test_the_ground_of_a_site() -> None:
    air = airspace(elevation=hills([[0.0, 10.0], [0.0, 10.0]]))
    leg = np.array([[[-40.0, 0.0], [30.0, 0.0], [30.0, 0.0]]])
    triangle = np.array([[[-50.0, 0.0], [50.0, 0.0], [0.0, 40.0]]])
    points_m = np.array([[0.0, 0.0], [25.0, 10.0], [51.0, 0.0]])
    assert air.ground_up_m(points_m) == pytest.approx([5.0, 7.5, np.nan], nan_ok=True)
    assert np.concatenate(air.ground_within_up_m(leg)) == pytest.approx([1.0, 8.0])
    assert np.concatenate(air.ground_within_up_m(triangle)) == pytest.approx([0.0, 10.0])
    assert air.is_ground_below(leg, np.array([8.01])).all()
    assert not air.is_ground_below(leg, np.array([7.99])).any()
    assert air.is_ground_above(leg, np.array([0.99])).all()
    assert not air.is_ground_above(leg, np.array([1.01])).any()
    assert FLAT.ground_up_m(leg[0]).tolist() == [0.0, 0.0, 0.0]
    assert np.concatenate(FLAT.ground_within_up_m(leg)).tolist() == [0.0, 0.0]
    assert FLAT.is_ground_below(leg, np.array([0.0])).all()
    assert not FLAT.is_ground_below(leg, np.array([-0.01])).any()
    assert FLAT.is_ground_above(leg, np.array([0.0])).all()
    assert not FLAT.is_ground_above(leg, np.array([0.01])).any()
