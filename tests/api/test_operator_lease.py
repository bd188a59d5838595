"""Two persons at one station, over HTTP: One operates, the other may stop and take over."""

import asyncio
from typing import Any

import pytest
import websockets
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.serving import PATIENCE_S, streaming
from tests.link.approved import core, extended
from tests.patient_loop import run_patiently

from recon import wire
from recon.api.security import Access
from recon.model.event import LinkOpened, PacketReceived
from recon.model.person import Person, Role
from recon.vehicles.reports import to_report

HERE = "this computer"


@pytest.fixture
def station() -> FakeStation:
    station = FakeStation()
    station.driver.handle(LinkOpened(1, "10.0.0.1:5"))
    for packet in (extended(b"A"), core()):
        station.driver.handle(PacketReceived(1, to_report(wire.decode(packet))))
    return station


def client_of(station: FakeStation, name: str, role: Role = Role.OPERATOR) -> Client:
    """The API as this person reaches it."""
    return Client(application(station, access=Access(local=Person(name, role, HERE))))


def take(client: Client, **more: Any) -> dict[str, Any]:
    asked = {"holder": "operator", **more}
    answer: dict[str, Any] = client.post("/api/vehicle/authority?serial=A", json=asked).json()
    return answer


def lease(client: Client) -> dict[str, Any] | None:
    found: dict[str, Any] | None = client.get("/api/vehicle?serial=A").json()["lease"]
    return found


def test_one_leads_and_the_other_takes_over_explicitly(station: FakeStation) -> None:
    anna, bob = client_of(station, "anna"), client_of(station, "bob")
    assert lease(anna) is None
    assert take(anna)["accepted"]
    assert lease(bob) == {"person": "anna", "age_s": 0.0, "absent_s": 0.0}
    refused = take(bob)
    assert (refused["accepted"], refused["rule"]) == (False, "operator_lease")
    assert "operated by anna" in refused["reason"]
    assert take(bob, take_over=True)["accepted"]
    found = lease(anna)
    assert found is not None
    assert found["person"] == "bob"
    (record,) = station.driver.station.alarms.alarms.values()
    assert record.condition.text == "A: taken over by bob from anna"


def test_an_order_to_move_is_refused_and_a_stop_is_not(station: FakeStation) -> None:
    anna, bob = client_of(station, "anna"), client_of(station, "bob")
    take(anna)
    stick = {
        "kind": "stick",
        "yaw_deg": 0.0,
        "velocity_x_mps": 1.0,
        "velocity_y_mps": 0.0,
        "height_above_takeoff_m": 30.0,
    }
    asked: dict[str, Any] = {"serials": ["A"], "order": stick}
    (result,) = bob.post("/api/orders", json=asked).json()["results"]
    assert result["rule"] == "operator_lease"
    (result,) = bob.post("/api/fleet-return", json={"serials": ["A"]}).json()["results"]
    assert not result["accepted"]
    for kind in ("hover", "land", "return_home"):
        asked = {"serials": ["A"], "order": {"kind": kind}}
        (result,) = bob.post("/api/orders", json=asked).json()["results"]
        assert result["rule"] != "operator_lease"
    (result,) = bob.post("/api/all-stop").json()["results"]
    assert result["rule"] != "operator_lease"


def test_a_pilot_hands_it_to_the_pilot_but_takes_nothing_over(station: FakeStation) -> None:
    anna, pete = client_of(station, "anna"), client_of(station, "pete", Role.PILOT)
    take(anna)
    asked = {"holder": "operator", "take_over": True}
    assert pete.post("/api/vehicle/authority?serial=A", json=asked).status_code == 403
    given = pete.post("/api/vehicle/authority?serial=A", json={"holder": "pilot"})
    assert given.json()["accepted"]
    assert lease(anna) is None


def test_an_open_stream_of_states_is_presence() -> None:
    async def main() -> None:
        station = FakeStation()
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            async with websockets.connect(f"{address}/api/stream") as reader:
                await reader.recv()
                (present,) = station.driver.station.persons.values()
                assert (present.streams, present.left_at_ns) == (1, None)
            while present.streams:
                await asyncio.sleep(0)
                (present,) = station.driver.station.persons.values()
            assert present.left_at_ns is not None

    run_patiently(main())
