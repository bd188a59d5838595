"""Fence, ground, home, pad and clock."""

from dataclasses import replace

import numpy as np
import pytest
from tests.ready import ready_airspace
from tests.safety.cases import AIRSPACE, FACTS, PLACE, TAKEOFF, S, vehicle, waypoint
from tests.safety.checks.checked import ATTENTION, FAILS, OK, checked

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import ElevationModel, LandingPad
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.vehicle import VehicleProfile
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.check import CheckState
from recon.safety.checks import place
from recon.safety.checks.place import clock, home_place, pad_altitude
from recon.safety.situation import ClockReading

ORIGIN = GeoPoint(42.0, -93.6, 270.0)
SET_S = 1_780_000_000


def hilly(height_m: float = 272.0) -> PreparedAirspace:
    """Ground of one height for 200 m around; unknown in the far north-west."""
    heights = np.full((20, 20), height_m)
    heights[:4, :4] = np.nan
    grid = GroundGrid(LocalFrame(ORIGIN), -100.0, 100.0, 10.0, 20, 20)
    return PreparedAirspace(ready_airspace(ORIGIN, elevation=ElevationModel(grid, heights)))


def pad_at(north_m: float = 0.0, east_m: float = 0.0, altitude_m: float = 270.0) -> VehicleProfile:
    at = waypoint(north_m)
    longitude_deg = -93.6 + east_m / 82_700.0
    return replace(TAKEOFF, pad=GeoPoint(at.latitude_deg, longitude_deg, altitude_m))


class TestHome:
    @pytest.mark.parametrize("flying", [True, False])
    def test_it_is_where_it_takes_off(self, flying: bool) -> None:
        assert checked(home_place, vehicle(flying=flying)).state is OK

    def test_its_pad_is_a_good_guess_in_the_air(self) -> None:
        found = checked(home_place, vehicle(pad_at(), takeoff_point=None))
        assert (found.state, found.text) == (
            ATTENTION,
            "assumed at its pad: takeoff not observed",
        )
        assert checked(home_place, vehicle(pad_at(), takeoff_point=None, flying=False)).state is OK

    @pytest.mark.parametrize(("north_m", "state"), [(9.9, OK), (10.1, ATTENTION)])
    def test_it_stands_on_its_pad(self, north_m: float, state: CheckState) -> None:
        assert checked(home_place, vehicle(pad_at(north_m), flying=False)).state is state

    def test_at_the_limit_it_stands_on_its_pad(self, monkeypatch: pytest.MonkeyPatch) -> None:
        pad = waypoint(20.0)
        far_m = horizontal_distance_m(PLACE, LatLon(pad.latitude_deg, pad.longitude_deg))
        monkeypatch.setattr(place, "NEAR_PAD_M", far_m)
        assert checked(home_place, vehicle(pad_at(20.0))).state is OK

    def test_a_pad_of_the_layer_counts_when_it_is_the_vehicles(self) -> None:
        north = GeoPoint(waypoint(50.0).latitude_deg, -93.6, 270.0)
        for serial, state in (("A", ATTENTION), ("B", OK), (None, OK)):
            pads = (LandingPad("north", serial, north),)
            layered = PreparedAirspace(replace(AIRSPACE.airspace, landing_pads=pads))
            assert checked(home_place, vehicle(), airspace=layered).state is state


class TestPad:
    @pytest.mark.parametrize(
        ("altitude_m", "state"),
        [(272.0, OK), (277.0, OK), (267.0, OK), (277.1, FAILS), (266.9, FAILS)],
    )
    def test_its_altitude_is_the_grounds(self, altitude_m: float, state: CheckState) -> None:
        profile = pad_at(altitude_m=altitude_m)
        assert checked(pad_altitude, vehicle(profile), airspace=hilly()).state is state

    @pytest.mark.parametrize("airspace", [AIRSPACE, OPEN_AIRSPACE])
    def test_without_a_model_it_is_not_compared(self, airspace: PreparedAirspace) -> None:
        found = checked(pad_altitude, vehicle(pad_at(altitude_m=9.0)), airspace=airspace)
        assert (found.state, found.text[:12]) == (ATTENTION, "not compared")

    def test_without_a_pad_there_is_nothing_to_compare(self) -> None:
        assert checked(pad_altitude, vehicle(), airspace=hilly()).state is OK
        assert checked(pad_altitude, replace(vehicle(), profile=None)).state is OK


class TestClock:
    @pytest.mark.parametrize(
        ("wall_s", "state"),
        [(SET_S, OK), (0, FAILS), (1_735_689_599.9, FAILS), (1_735_689_600, OK)],
    )
    def test_it_was_set_after_this_program_was_written(
        self, wall_s: float, state: CheckState
    ) -> None:
        facts = replace(FACTS, clock=ClockReading(round(wall_s * S)))
        assert checked(clock, vehicle(), facts=facts).state is state

    @pytest.mark.parametrize(
        ("set_s", "state"), [(2.0, OK), (-2.0, OK), (2.1, ATTENTION), (-3600.0, ATTENTION)]
    )
    def test_it_was_not_set_since(self, set_s: float, state: CheckState) -> None:
        facts = replace(FACTS, clock=ClockReading(SET_S * S, round(set_s * S)))
        assert checked(clock, vehicle(), facts=facts).state is state
