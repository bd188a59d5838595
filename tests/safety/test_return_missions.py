"""Missions that only bring a vehicle down, and those that only look like it."""

from dataclasses import replace

import pytest
from tests.safety.cases import TAKEOFF, mission, vehicle, waypoint

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import Airspace, LandingPad
from recon.model.geo import GeoPoint, LatLon
from recon.model.mission import Mission
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE, PreparedAirspace, return_missions
from recon.safety.datum import home
from recon.safety.return_missions import leads_home


def north(metres: float) -> LatLon:
    at = waypoint(metres)
    return LatLon(at.latitude_deg, at.longitude_deg)


def pad(metres: float, serial: str | None) -> PreparedAirspace:
    place = GeoPoint(north(metres).latitude_deg, -93.6, 275.0)
    return PreparedAirspace(Airspace(landing_pads=(LandingPad("pad", serial, place),)))


def landing(*norths_m: float) -> Mission:
    return replace(mission(*(waypoint(m) for m in norths_m)).mission, land_at_end=True)


def out_at(metres: float, **changes: object) -> VehicleState:
    """In the air this far north of where it took off."""
    return vehicle(position=north(metres), **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("path", "only_lands"),
    [
        (landing(300.0, 0.0), True),
        (landing(300.0, 9.9), True),
        (landing(300.0, 10.1), False),
        (landing(300.0, 300.0), False),
        (mission(waypoint(300.0), waypoint(0.0)).mission, False),
        (landing(474.0, 0.0), True),
        (landing(476.0, 0.0), False),
        (landing(478.0, -3.0), False),
        (landing(0.0, 200.0, 0.0), False),
    ],
)
def test_it_lands_at_home_and_makes_no_long_detour(path: Mission, only_lands: bool) -> None:
    """From 300 m away the whole path may be 650 m long."""
    assert only_lands is leads_home(path, out_at(300.0), OPEN_AIRSPACE)


def test_an_end_exactly_as_far_from_home_as_it_may_be_leads_home(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flown = out_at(300.0)
    took_off = home(flown)
    assert took_off is not None
    monkeypatch.setattr(return_missions, "NEAR_PAD_M", horizontal_distance_m(north(8.0), took_off))
    assert leads_home(landing(300.0, 8.0), flown, OPEN_AIRSPACE)


def test_a_way_of_exactly_the_longest_length_leads_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Out and back to where it is: the whole path is the detour."""
    path, here = landing(20.0, 0.0), out_at(0.0)
    out_m = horizontal_distance_m(north(0.0), north(20.0))
    monkeypatch.setattr(
        return_missions, "DETOUR_M", out_m + horizontal_distance_m(north(20.0), north(0.0))
    )
    assert leads_home(path, here, OPEN_AIRSPACE)


def test_a_pause_on_the_way_is_another_purpose() -> None:
    path = landing(300.0, 0.0)
    paused = replace(path, waypoints=(replace(path.waypoints[0], loiter_s=0.0), path.waypoints[1]))
    assert not leads_home(paused, out_at(300.0), OPEN_AIRSPACE)


@pytest.mark.parametrize("flying", [False, None])
def test_only_what_is_in_the_air_comes_home(flying: bool | None) -> None:
    assert not leads_home(landing(300.0, 0.0), out_at(300.0, flying=flying), OPEN_AIRSPACE)


def test_from_an_unknown_place_nothing_does() -> None:
    state = vehicle(position=Stamped())
    assert not leads_home(landing(300.0, 0.0), state, OPEN_AIRSPACE)


@pytest.mark.parametrize(("serial", "only_lands"), [(None, True), ("A", True), ("B", False)])
def test_a_pad_is_a_place_of_its_own_or_of_all(serial: str | None, only_lands: bool) -> None:
    state = out_at(300.0)
    assert leads_home(landing(300.0, 100.0), state, pad(100.0, serial)) is only_lands


def test_the_profiles_pad_is_its_own_too() -> None:
    profile = replace(TAKEOFF, pad=GeoPoint(north(100.0).latitude_deg, -93.6, 275.0))
    assert leads_home(landing(300.0, 100.0), out_at(300.0, profile=profile), OPEN_AIRSPACE)
    homeless = replace(out_at(300.0), takeoff_point=None, profile=None)
    assert not leads_home(landing(300.0, 100.0), homeless, OPEN_AIRSPACE)
