"""Streams that own steered orders: a silent or closed one ends them."""

import asyncio
from dataclasses import replace

import pytest
import websockets
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.serving import PATIENCE_S, streaming
from tests.patient_loop import run_patiently

from recon.api import streams
from recon.api.security import LOCAL_PERSON, Access
from recon.client import Station as RemoteStation
from recon.model.person import Role

NAME = "a-name-of-a-owner-01"


def url_of(address: str, name: str = NAME) -> str:
    return f"{address}/api/stream?owner={name}"


def held(station: FakeStation) -> frozenset[str]:
    return station.driver.station.owners


async def until_held(station: FakeStation, names: set[str]) -> None:
    async with asyncio.timeout(PATIENCE_S):
        while held(station) != names:
            await asyncio.sleep(0.01)


async def read_on(reader: websockets.ClientConnection) -> None:
    while True:
        await reader.recv()


def test_a_stream_holds_while_it_is_open() -> None:
    async def main() -> None:
        station = FakeStation()
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            async with websockets.connect(url_of(address)) as reader:
                await reader.recv()
                await until_held(station, {NAME})
            await until_held(station, set())
            async with websockets.connect(f"{address}/api/stream") as reader:
                await reader.recv()
                assert held(station) == frozenset()

    run_patiently(main())


def test_the_open_page_of_an_observer_is_no_owner() -> None:
    async def main() -> None:
        station = FakeStation()
        for role in Role:
            access = Access(local=replace(LOCAL_PERSON, role=role))
            async with (
                asyncio.timeout(PATIENCE_S),
                streaming(station, access) as address,
                websockets.connect(url_of(address)) as reader,
            ):
                for _ in range(3):
                    await reader.recv()
                assert held(station) == ({NAME} if role.includes(Role.PILOT) else set())
            await until_held(station, set())

    run_patiently(main())


def test_a_silent_stream_is_closed_and_owns_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(streams, "SILENT_S", 0.2)

    async def main() -> None:
        station = FakeStation()
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            async with websockets.connect(url_of(address)) as reader:
                with pytest.raises(websockets.ConnectionClosed, match=r"no message for 0\.2 s"):
                    await read_on(reader)
            assert held(station) == frozenset()

    run_patiently(main())


def test_an_owner_that_sends_keepalives_stays_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten states a second: thirteen keepalives take three times the limit."""
    monkeypatch.setattr(streams, "SILENT_S", 0.4)

    async def main() -> None:
        station = FakeStation()
        async with (
            asyncio.timeout(PATIENCE_S),
            streaming(station) as address,
            websockets.connect(url_of(address)) as reader,
        ):
            await until_held(station, {NAME})
            for _ in range(13):
                await reader.recv()
                await reader.send("")
                assert held(station) == {NAME}

    run_patiently(main())


@pytest.mark.parametrize("name", ["short", "x" * 65, "a-name-with-a-space%20in-it", "ümlaut" * 4])
def test_names_that_are_none_are_refused(name: str) -> None:
    async def main() -> None:
        station = FakeStation()
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            with pytest.raises((websockets.InvalidStatus, websockets.ConnectionClosed)):
                async with websockets.connect(url_of(address, name)) as reader:
                    await reader.recv()
            assert held(station) == frozenset()

    run_patiently(main())


def test_a_name_is_one_streams_at_a_time() -> None:
    async def main() -> None:
        station = FakeStation()
        async with (
            asyncio.timeout(PATIENCE_S),
            streaming(station) as address,
            websockets.connect(url_of(address)) as first,
        ):
            await until_held(station, {NAME})
            with pytest.raises((websockets.InvalidStatus, websockets.ConnectionClosed)):
                async with websockets.connect(url_of(address)) as second:
                    await second.recv()
            await first.recv()
            assert held(station) == {NAME}

    run_patiently(main())


class TestOrders:
    @pytest.mark.parametrize(
        "order",
        [
            {
                "kind": "goto",
                "latitude_deg": 41.9,
                "longitude_deg": -93.6,
                "height_above_takeoff_m": 40.0,
            },
            {"kind": "nudge", "north_m": 1.0},
            {"kind": "hold_position"},
        ],
        ids=lambda order: str(order["kind"]),
    )
    def test_a_steered_order_needs_an_owner(self, order: dict[str, object]) -> None:
        station = FakeStation()
        client = Client(application(station))
        asked = {"serials": ["A"], "order": order}
        answer = client.post("/api/orders", json=asked)
        assert answer.status_code == 422
        assert "needs an owner" in answer.json()["error"]
        without_stream = client.post("/api/orders", json={**asked, "owner": NAME})
        assert without_stream.status_code == 200
        (result,) = without_stream.json()["results"]
        assert not result["accepted"]
        assert len(station.asked) == 1

    def test_other_orders_need_none(self) -> None:
        client = Client(application(FakeStation()))
        asked = {"serials": ["A"], "order": {"kind": "hover"}}
        assert client.post("/api/orders", json=asked).status_code == 200


def test_a_client_is_an_operator_only_while_it_says_so() -> None:
    """A gateway that nobody sits at must not keep *operator gone* from acting."""

    async def main() -> None:
        station = FakeStation()
        async with (
            asyncio.timeout(PATIENCE_S),
            streaming(station) as address,
            RemoteStation(address.replace("ws", "http", 1), is_operator=False) as client,
        ):
            assert held(station) == frozenset()
            await client.act_as_operator(True)
            while not client.takes_steered_orders or not held(station):
                await asyncio.sleep(0.01)
            await client.act_as_operator(False)
            await until_held(station, set())
            assert not client.takes_steered_orders

    run_patiently(main())
