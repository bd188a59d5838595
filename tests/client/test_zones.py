"""Temporary zones from Python, with a real station."""

import pytest
from tests.client.running_station import HOME, running_station
from tests.patient_loop import run_patiently

from recon.client import Refusal, Station, TemporaryZoneStatus
from recon.model.geo import LatLon
from recon.model.temporary_zone import Circle, TemporaryZoneKind

PERSON = TemporaryZoneKind.PERSON
AWAY = LatLon(HOME.latitude_deg + 0.002, HOME.longitude_deg)


def test_zones_are_drawn_listed_and_ended() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            zones = station.zones
            zone = await zones.draw(PERSON, Circle(AWAY, 20.0), "sprinkler", lasts_s=600.0)
            assert isinstance(zone, TemporaryZoneStatus)
            assert (zone.kind, zone.radius_m, zone.ceiling_m) == (PERSON, 20.0, 30.0)
            corners = [AWAY, LatLon(AWAY.latitude_deg, AWAY.longitude_deg + 0.001)]
            outline = [*corners, LatLon(AWAY.latitude_deg + 0.001, AWAY.longitude_deg)]
            tractor = await zones.draw(TemporaryZoneKind.TRACTOR, outline, "sprays")
            assert isinstance(tractor, TemporaryZoneStatus)
            assert [each.id for each in await zones.in_force()] == [1, 2]
            assert await zones.end(1) is None
            again = await zones.end(1)
            assert isinstance(again, Refusal)
            assert "no temporary zone 1 is in force" in again.reason

    run_patiently(main())


@pytest.mark.parametrize(
    ("radius_m", "rule"), [(float("nan"), "zone_form"), (5_000.0, "temporary_zone")]
)
def test_what_cannot_be_drawn_is_a_refusal(radius_m: float, rule: str) -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            answer = await station.zones.draw(PERSON, Circle(AWAY, radius_m), "sprinkler")
            assert isinstance(answer, Refusal)
            assert answer.rule == rule
            long = await station.zones.draw(PERSON, Circle(AWAY, 20.0), "x" * 3_000)
            assert isinstance(long, Refusal)
            assert long.rule == "zone_form"

    run_patiently(main())
