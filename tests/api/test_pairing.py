"""Apps that wait to be admitted, over the API."""

from dataclasses import replace
from typing import Any

import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.link.approved import core, extended

from recon import wire
from recon.fleet.admission import Admission, AllowedApp
from recon.model.event import LinkOpened, PacketReceived
from recon.vehicles.reports import to_report


@pytest.fixture
def station() -> FakeStation:
    """A list with serial A; link 1 reports B."""
    station = FakeStation()
    fleet = replace(station.driver.station.fleet, admission=Admission((AllowedApp("A"),)))
    station.driver.station = replace(station.driver.station, fleet=fleet)
    station.driver.handle(LinkOpened(1, "10.0.0.1:5"))
    for packet in (extended(b"B"), core()):
        station.driver.handle(PacketReceived(1, to_report(wire.decode(packet))))
    return station


@pytest.fixture
def client(station: FakeStation) -> Client:
    return Client(application(station))


def link(client: Client) -> dict[str, Any]:
    found: dict[str, Any] = client.get("/api/state").json()["links"][0]
    return found


def test_the_state_shows_who_waits_and_why(client: Client) -> None:
    shown = link(client)
    assert shown["status"] == "waiting"
    assert shown["waiting"] == {
        "serial": "B",
        "age_s": 0.0,
        "reason": "its serial is not on the list",
        "is_flying": True,
    }
    assert client.get("/api/state").json()["station"]["apps_listed"] == 1


def test_without_a_list_nothing_waits() -> None:
    state = Client(application(FakeStation())).get("/api/state").json()
    assert state["station"]["apps_listed"] is None


def test_admitted_it_is_identified(client: Client, station: FakeStation) -> None:
    answer = client.post("/api/apps/admit", json={"link_id": 1, "serial": "B"})
    assert answer.json() == {"accepted": True, "rule": None, "reason": None}
    assert link(client)["status"] == "identified"
    assert link(client)["waiting"] is None
    assert len(station.driver.station.fleet.admission.listed or ()) == 2


def test_admitted_for_the_session_the_list_stays(client: Client, station: FakeStation) -> None:
    asked = {"link_id": 1, "serial": "B", "lasting": "session", "any_address": True}
    assert client.post("/api/apps/admit", json=asked).json()["accepted"]
    assert station.driver.station.fleet.admission.listed == (AllowedApp("A"),)
    assert station.driver.station.fleet.admission.session == (AllowedApp("B"),)


def test_another_serial_than_it_reports_is_refused(client: Client) -> None:
    answer = client.post("/api/apps/admit", json={"link_id": 1, "serial": "A"}).json()
    assert (answer["accepted"], answer["rule"]) == (False, "pairing")
    assert "now reports serial B" in answer["reason"]


def test_refusing(client: Client, station: FakeStation) -> None:
    assert client.post("/api/apps/refuse", json={"link_id": 1}).json()["accepted"]
    assert ("10.0.0.1", "B") in station.driver.station.fleet.admission.refused_until_ns
    assert not client.post("/api/apps/refuse", json={"link_id": 9}).json()["accepted"]


@pytest.mark.parametrize(
    "asked", [{"link_id": 1}, {"link_id": "1", "serial": "B"}, {"link_id": 1, "serial": ""}]
)
def test_incomplete_requests_are_invalid(client: Client, asked: dict[str, Any]) -> None:
    assert client.post("/api/apps/admit", json=asked).status_code == 422
