"""The height at which the aircraft goes home."""

from dataclasses import replace

import numpy as np
import pytest
from tests.ready import ready_airspace
from tests.safety.cases import AIRSPACE, FACTS, TAKEOFF, vehicle, waypoint
from tests.safety.checks.checked import ATTENTION, FAILS, OK, UNKNOWN, checked

from recon.model.airspace import FlightLimits, HeightDatum, Region, Zone, ZoneKind
from recon.model.geo import GeoPoint
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.check import Check, CheckState
from recon.safety.checks.site_facts import go_home_height

ORIGIN = GeoPoint(42.0, -93.6, 270.0)
WIDE = PreparedAirspace(replace(AIRSPACE.airspace, limits=FlightLimits(500.0)))


def at(height_m: float | None, **now: object) -> Check:
    return checked(go_home_height, vehicle(replace(TAKEOFF, go_home_height_m=height_m)), **now)


def other(height_m: float | None, altitude_m: float = 270.0, serial: str = "B") -> VehicleState:
    """Another vehicle, in the air above a pad of this altitude."""
    place = waypoint(100.0)
    pad = GeoPoint(place.latitude_deg, -93.6, altitude_m)
    profile = replace(TAKEOFF, serial=serial, go_home_height_m=height_m, pad=pad)
    return replace(vehicle(profile, takeoff_point=None), serial=serial)


def zone(ceiling_m: float | None, datum: HeightDatum = HeightDatum.GROUND, **changes: object):  # type: ignore[no-untyped-def]
    outline = np.array([(10.0, 10.0), (20.0, 10.0), (20.0, 20.0)])
    wood = Zone("wood", ZoneKind.KEEP_OUT, Region(outline), None, ceiling_m, datum)
    return PreparedAirspace(ready_airspace(ORIGIN, zones=(replace(wood, **changes),)))  # type: ignore[arg-type]


def test_it_is_set_or_not() -> None:
    assert at(60.0).text == "60 m above takeoff"
    assert at(None).state is UNKNOWN
    assert "go_home_height_m = METRES" in at(None).to_do
    assert checked(go_home_height, replace(vehicle(), profile=None)).state is UNKNOWN


@pytest.mark.parametrize(
    ("height_m", "state"), [(19.9, FAILS), (20.0, OK), (500.0, OK), (500.1, FAILS)]
)
def test_it_is_one_that_an_aircraft_takes(height_m: float, state: CheckState) -> None:
    assert at(height_m, airspace=WIDE).state is state


@pytest.mark.parametrize(("height_m", "state"), [(120.0, OK), (120.1, FAILS)])
def test_it_is_under_the_sites_ceiling(height_m: float, state: CheckState) -> None:
    assert at(height_m).state is state


class TestNeighbours:
    @pytest.mark.parametrize(
        ("height_m", "state"), [(60.0, FAILS), (67.4, FAILS), (67.5, OK), (52.5, OK), (52.6, FAILS)]
    )
    def test_no_other_vehicle_goes_home_in_its_layer(
        self, height_m: float, state: CheckState
    ) -> None:
        facts = replace(FACTS, others=(other(height_m),))
        assert at(60.0, facts=facts).state is state

    def test_heights_are_compared_in_one_frame(self) -> None:
        """Its pad lies 40 m lower: 100 m above it are 60 m above here."""
        low = replace(FACTS, others=(other(100.0, altitude_m=230.0),))
        assert at(60.0, facts=low).state is FAILS
        assert at(100.0, facts=low).state is OK

    @pytest.mark.parametrize("airspace", [AIRSPACE, OPEN_AIRSPACE])
    def test_an_unknown_home_counts_from_the_origins_height(
        self, airspace: PreparedAirspace
    ) -> None:
        for height_m, state in ((67.4, FAILS), (67.5, OK)):
            profile = replace(TAKEOFF, serial="B", go_home_height_m=height_m)
            facts = replace(FACTS, others=(replace(other(60.0), profile=profile),))
            assert at(60.0, facts=facts, airspace=airspace).state is state

    def test_others_without_a_height_are_not_compared(self) -> None:
        unsaid = (other(None), replace(other(60.0), profile=None))
        assert at(60.0, facts=replace(FACTS, others=unsaid)).state is OK


class TestZones:
    @pytest.mark.parametrize(("ceiling_m", "state"), [(55.0, OK), (55.1, ATTENTION)])
    def test_one_that_it_does_not_clear_is_named(self, ceiling_m: float, state: CheckState) -> None:
        assert at(60.0, airspace=zone(ceiling_m)).state is state
        assert at(60.0, airspace=zone(80.0)).text == "60 m does not clear 'wood'"

    @pytest.mark.parametrize(("ceiling_m", "state"), [(325.0, OK), (325.1, ATTENTION)])
    def test_a_ceiling_above_the_ellipsoid(self, ceiling_m: float, state: CheckState) -> None:
        assert at(60.0, airspace=zone(ceiling_m, HeightDatum.WGS84)).state is state

    def test_one_without_a_ceiling_is_never_cleared_and_not_named(self) -> None:
        assert at(60.0, airspace=zone(None)).state is OK

    def test_a_height_zone_is_no_obstacle(self) -> None:
        assert at(60.0, airspace=zone(80.0, kind=ZoneKind.HEIGHT)).state is OK

    def test_without_a_known_home_nothing_is_compared(self) -> None:
        state = vehicle(takeoff_point=None)
        assert checked(go_home_height, state, airspace=zone(80.0)).state is OK
