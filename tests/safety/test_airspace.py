"""Which zones are worth asking."""

import numpy as np
from tests.safety.traffic import FRAME

from recon.geo import Footprints
from recon.model.airspace import Airspace, Region, Zone, ZoneKind
from recon.safety import PreparedAirspace


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


def test_one_that_is_between_all_and_near_to_none_is_not() -> None:
    assert near((-90.0, 40.0), (90.0, -40.0)) == []


def test_what_is_not_finite_may_be_near_to_every_zone() -> None:
    assert near((np.nan, 0.0)) == ["west", "east"]
