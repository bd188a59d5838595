"""A fault in a session's own code costs only its connection."""

import pytest
from tests.link.approved import core
from tests.link.harness import LOOPS, close, listening, run_on
from tests.link.test_server import order

from recon.link.session import Session
from recon.model.command import Hover
from recon.model.event import LinkClosed, StationFaulted
from recon.model.report import CoreReport

METHODS = ("receive", "tick", "submit", "next_packet", "end_stream")


def break_method(monkeypatch: pytest.MonkeyPatch, name: str, link_id: int) -> None:
    real = getattr(Session, name)

    def broken(session: Session, *arguments: object, **named: object) -> object:
        if session.link_id == link_id:
            raise ZeroDivisionError("division by zero")
        return real(session, *arguments, **named)

    monkeypatch.setattr(Session, name, broken)


@pytest.mark.parametrize("loop", sorted(LOOPS))
@pytest.mark.parametrize("method", METHODS)
def test_it_ends_that_link_with_an_event_and_the_next_link_works(
    loop: str, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def main() -> None:
        async with listening() as station:
            broken, _, first = await station.connect()
            whole, _, second = await station.connect()
            first.write(core())
            await station.until(lambda: station.reports(broken) != [])
            break_method(monkeypatch, method, broken)
            station.server.tick()
            order(station, 1, Hover(), broken)
            first.write(core())
            if method == "end_stream":
                first.close()
            await station.until(lambda: station.closed_reason(broken) is not None)
            (fault, *_) = station.of(StationFaulted)
            assert fault.where == f"on link {broken}"
            assert "ZeroDivisionError: division by zero (test_faults.py:" in fault.what
            second.write(core())
            await station.until(lambda: station.reports(whole) != [])
            assert isinstance(station.reports(whole)[0], CoreReport)
            assert [event.link_id for event in station.of(LinkClosed)] == [broken]
            await close(second)
            await close(first)

    run_on(loop, main)
