"""The audit over the API: bounded pages, and every entry once on the stream."""

import asyncio
from pathlib import Path

import pytest
import websockets
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.serving import PATIENCE_S, streaming
from tests.link.approved import core, extended
from tests.persons import user

from recon import wire
from recon.api.login import Login
from recon.api.schema import AuditPage, TimelineView
from recon.api.security import Access
from recon.model.event import LinkOpened, PacketReceived
from recon.record.audit.audit import AuditEntry
from recon.record.audit.audit_log import KEPT_ENTRIES, AuditLog
from recon.station.audit.flight_entries import POSITION_KIND
from recon.vehicles.reports import to_report

HOVER = {"serials": ["A", "Z"], "order": {"kind": "hover"}}


@pytest.fixture
def station(tmp_path: Path) -> FakeStation:
    made = FakeStation()
    made.audit_log = AuditLog(tmp_path)
    return made


def put(station: FakeStation, count: int) -> None:
    log = station.audit_log
    assert log is not None
    for number in range(count):
        log.put(AuditEntry("test", f"entry {number}", details={"x": float("nan")}), number)


def page(client: Client, query: str) -> AuditPage:
    return AuditPage.model_validate_json(client.get(f"/api/audit{query}").text)


def test_pages_follow_each_other(station: FakeStation) -> None:
    put(station, 250)
    client = Client(application(station))
    first = page(client, "")
    assert [entry.n for entry in first.entries] == list(range(1, 101))
    assert (first.first_n, first.last_n) == (1, 250)
    last = page(client, "?after=245&at_most=100")
    assert [entry.text for entry in last.entries] == [f"entry {n}" for n in range(245, 250)]
    assert last.entries[0].details == {"x": "nan"}
    assert page(client, "?after=250").entries == []
    assert page(client, "?after=99999999999").entries == []


def test_what_is_no_longer_in_memory_is_seen_by_the_first_number(station: FakeStation) -> None:
    put(station, KEPT_ENTRIES + 10)
    assert page(Client(application(station)), "").first_n == 11


@pytest.mark.parametrize("query", ["?after=-1", "?at_most=0", "?at_most=101", "?after=x"])
def test_what_is_no_page_is_refused(station: FakeStation, query: str) -> None:
    response = Client(application(station)).get(f"/api/audit{query}")
    assert response.status_code == 422
    assert "error" in response.json()


def test_without_an_audit_the_page_is_empty() -> None:
    assert page(Client(application(FakeStation())), "").last_n == 0


def test_it_needs_the_token_like_all_else(station: FakeStation) -> None:
    client = Client(application(station, access=Access.network(Login([user()]))))
    assert client.get("/api/audit").status_code == 401
    assert not client.open_stream("/api/audit/stream").is_served


def test_the_stream_tells_every_entry_once_and_in_order(station: FakeStation) -> None:
    async def main() -> None:
        put(station, 230)
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            url = f"{address}/api/audit/stream?after=20"
            async with websockets.connect(url) as reader:
                seen: list[int] = []
                while len(seen) < 210:
                    page = AuditPage.model_validate_json(await reader.recv())
                    seen += [entry.n for entry in page.entries]
                put(station, 3)
                while len(seen) < 213:
                    page = AuditPage.model_validate_json(await reader.recv())
                    seen += [entry.n for entry in page.entries]
                assert seen == list(range(21, 234))

    asyncio.run(main())


class TestCheck:
    def test_it_answers_as_an_order_would_and_gives_none(self, station: FakeStation) -> None:
        station.driver.handle(LinkOpened(1, "10.0.0.1:5"))
        for packet in (extended(b"A"), core()):
            station.driver.handle(PacketReceived(1, to_report(wire.decode(packet))))
        before = station.driver.station
        client = Client(application(station))
        checked = client.post("/api/orders/check", json=HOVER).json()["results"]
        assert station.driver.station is before
        given = client.post("/api/orders", json=HOVER).json()["results"]
        assert [r["accepted"] for r in checked] == [True, False]
        for asked, was in zip(checked, given, strict=True):
            assert asked["command_id"] == 0
            assert was["command_id"] > 0
            assert {**asked, "command_id": 0} == {**was, "command_id": 0}


def timeline(client: Client, query: str = "") -> TimelineView:
    return TimelineView.model_validate_json(client.get(f"/api/timeline{query}").text)


def test_the_timeline_keeps_orders_while_positions_come_and_go(tmp_path: Path) -> None:
    station = FakeStation()
    station.audit_log = log = AuditLog(tmp_path, quiet_kinds=frozenset({POSITION_KIND}))
    for number in range(3):
        log.put(AuditEntry("order.sent", f"hover {number}", "anna", f"SIM-{number}", "Drone"), 0)
        log.put(AuditEntry("alarm.raised", f"low battery {number}", serial=f"SIM-{number}"), 0)
    for _ in range(KEPT_ENTRIES):
        log.put(AuditEntry(POSITION_KIND, "position", serial="SIM-1"), 0)
    client = Client(application(station))
    found = timeline(client)
    assert [entry.text for entry in found.entries[:2]] == ["low battery 2", "hover 2"]
    assert (len(found.entries), found.has_more) == (6, False)
    assert found.entries[1].by == "anna"
    first = timeline(client, "?at_most=4")
    assert first.has_more
    rest = timeline(client, f"?before={first.entries[-1].n}")
    assert [entry.text for entry in rest.entries] == ["low battery 0", "hover 0"]
    of_one = timeline(client, "?serial=SIM-1&about=orders")
    assert [entry.text for entry in of_one.entries] == ["hover 1"]
    assert client.get("/api/timeline?about=weather").status_code == 422


def test_without_an_audit_the_timeline_is_empty() -> None:
    assert timeline(Client(application(FakeStation()))).entries == []
