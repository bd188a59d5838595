"""A temporary zone that is drawn between a vehicle and its home is an alarm."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.fenced import FRAME, ORIGIN, airspace, flier, hills, place
from tests.safety.watchdogs.looks import looks

from recon.model.airspace import HeightDatum
from recon.model.severity import Severity
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZone, TemporaryZoneKind
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety import PreparedAirspace
from recon.safety.airspace import prepared_zone
from recon.safety.temporary_zones import prepared_temporary_zone
from recon.safety.watchdogs import Finding
from recon.safety.watchdogs.route_home_zones import route_home_zones

HELICOPTER = TemporaryZoneKind.CREWED_AIRCRAFT


def between(ceiling_m: float | None = None, east_m: float = 100.0) -> PreparedAirspace:
    """A zone of 20 m round a place on the route home from the east."""
    drawn = DrawnZone(HELICOPTER, Circle(place(east_m, 0.0), 20.0), "rescue", ceiling_m=ceiling_m)
    zone = prepared_temporary_zone(TemporaryZone(1, drawn, "Ann", 0), FRAME)
    return airspace().with_temporary_zones([zone])


def found(state: VehicleState, air: PreparedAirspace | None = None) -> list[Finding]:
    return looks(route_home_zones, state, airspace=air or between())


def test_a_vehicle_beyond_the_zone_is_warned_about() -> None:
    (finding,) = found(flier(200.0, 0.0))
    assert finding.severity is Severity.WARNING
    assert finding.holds is None
    assert finding.text == (
        "A: its route home leads through the keep-out zone 'crewed aircraft 1 (temporary)': "
        "without its link it would fly through it; lead it to the other side, or land it"
    )


@pytest.mark.parametrize(
    "state", [flier(60.0, 0.0), flier(200.0, 200.0), flier(100.0, 120.0), flier(-200.0, 0.0)]
)
def test_one_whose_route_home_is_beside_it_is_not(state: VehicleState) -> None:
    assert found(state) == []


def test_nor_is_one_that_goes_home_above_it() -> None:
    beyond = flier(200.0, 0.0, 25.0, go_home_m=60.0)
    assert found(beyond, between(ceiling_m=30.0)) == []
    assert found(replace(beyond, profile=None), between(ceiling_m=30.0))
    assert found(flier(200.0, 0.0, 25.0, go_home_m=28.0), between(ceiling_m=30.0))
    assert found(flier(200.0, 0.0, 40.0, go_home_m=28.0), between(ceiling_m=30.0)) == []


@pytest.mark.parametrize(("go_home_m", "count"), [(60.0, 0), (28.0, 1)])
def test_its_ceiling_may_be_over_the_ellipsoid_and_over_higher_ground(
    go_home_m: float, count: int
) -> None:
    """At 30 m over home: over the ellipsoid, or over a hill of 10 m between."""
    beyond = flier(200.0, 0.0, 25.0, go_home_m=go_home_m)
    (drawn,) = between(ceiling_m=30.0).temporary_zones
    over_m = ORIGIN.ellipsoid_height_m + 30.0
    zone = replace(drawn.zone, ceiling_m=over_m, datum=HeightDatum.WGS84)
    assert len(found(beyond, airspace().with_temporary_zones([prepared_zone(zone)]))) == count
    hill = hills([[0.0] * 6 + [10.0] + [0.0] * 2] * 3, cell_m=50.0)
    zone = replace(drawn.zone, ceiling_m=20.0)
    over_hill = airspace(elevation=hill).with_temporary_zones([prepared_zone(zone)])
    assert len(found(beyond, over_hill)) == count


def test_a_home_outside_the_elevation_model_is_at_no_known_height() -> None:
    beyond = flier(200.0, 0.0, 25.0, takeoff_point=place(-900.0, 0.0))
    drawn = between(ceiling_m=30.0).temporary_zones
    over_known_ground = airspace(elevation=hills(np.zeros((8, 8)))).with_temporary_zones(drawn)
    assert len(found(beyond, over_known_ground)) == 1


def test_a_home_in_the_zone_is_never_above_it() -> None:
    assert found(flier(200.0, 0.0, go_home_m=60.0), between(ceiling_m=30.0, east_m=0.0))


def test_an_unknown_height_is_not_above_it() -> None:
    low = flier(200.0, 0.0, 25.0, go_home_m=60.0)
    blind = replace(low, height_above_takeoff_m=Stamped())
    assert found(low, between(ceiling_m=30.0)) == []
    assert len(found(blind, between(ceiling_m=30.0))) == 1
    assert len(found(blind)) == 1


def test_without_a_position_or_a_home_there_is_no_way() -> None:
    assert found(replace(flier(200.0, 0.0), takeoff_point=None)) == []
    assert found(replace(flier(200.0, 0.0), position=Stamped())) == []


def test_without_a_temporary_zone_nothing_is_asked() -> None:
    assert found(flier(200.0, 0.0), airspace()) == []
    assert found(flier(200.0, 0.0), airspace(frame=None)) == []
