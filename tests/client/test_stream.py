"""Streams that break off, fall silent, or come from something else than a station."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest
from starlette.types import Receive, Scope, Send
from tests.client import told
from tests.client.misbehaving import server
from tests.client.running_station import serving

from recon.client import (
    BadAnswerError,
    ClientError,
    ConnectionLostError,
    MaybeSentError,
    Order,
    RequestRefusedError,
    Staleness,
    Station,
    StationUnreachableError,
    stream,
)

Tell = Callable[[str | bytes], Awaitable[None]]
Script = Callable[[Tell], Awaitable[None]]
RESULT = (
    '{"serial": %s, "link_id": 1, "vehicle_name": "one", "accepted": true, "command_id": 1,'
    ' "rule": null, "reason": null}'
)


class FakeStation:
    """Plays one script after another to each reader that comes; the last one again and again."""

    def __init__(self, *scripts: Script, results: str = RESULT % '"SIM-1"') -> None:
        self.scripts = list(scripts)
        self.results = results
        self.readers = 0
        self.orders = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            self.orders += 1
            body = f'{{"results": [{self.results}]}}'.encode()
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": body})
            return
        script = self.scripts[min(self.readers, len(self.scripts) - 1)]
        self.readers += 1
        await receive()
        await send({"type": "websocket.accept"})

        async def tell(text: str | bytes) -> None:
            kind = "text" if isinstance(text, str) else "bytes"
            await send({"type": "websocket.send", kind: text})

        await script(tell)
        await send({"type": "websocket.close", "code": 1001})


def telling(*texts: str | bytes, then_silent: bool = False) -> Script:
    async def script(tell: Tell) -> None:
        for text in texts:
            await tell(text)
        if then_silent:
            await asyncio.Event().wait()

    return script


ONE = told.state_text(vehicles=(told.vehicle(),))
ONE_LATER = told.state_text(6_000_000_000, vehicles=(told.vehicle(),))


class HandClock:
    """A clock that stands until it is set on."""

    def __init__(self) -> None:
        self.ns = 0

    def __call__(self) -> int:
        return self.ns

    def pass_s(self, seconds: float) -> None:
        self.ns += round(seconds * 1e9)


@asynccontextmanager
async def fake_station(
    station: FakeStation, clock: HandClock | None = None
) -> AsyncIterator[Station]:
    async with serving(station) as url:
        opened = Station(url)
        if clock is not None:
            opened._stream.now_ns = clock
        async with opened:
            yield opened


def test_a_silent_stream_is_told_as_late_and_then_as_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.client.vehicle.QUIET_S", 0.02)

    async def main() -> None:
        clock = HandClock()
        async with fake_station(FakeStation(telling(ONE, then_silent=True)), clock) as station:
            states = (await station.vehicle("SIM-1")).telemetry(lost_after_s=10.0)
            assert (await anext(states)).position.age_s == pytest.approx(0.05)
            for passed_s, word in ((0.0, "live"), (1.0, "late"), (3.0, "lost"), (9.99, "silent")):
                clock.ns = round(passed_s * 1e9)
                state = await anext(states)
                assert state.staleness is Staleness(word)
                assert state.position.age_s == pytest.approx(0.05 + passed_s)
            clock.pass_s(0.02)
            with pytest.raises(ConnectionLostError, match="got none for 10 s"):
                await anext(states)

    asyncio.run(main())


def test_what_lay_in_the_buffers_is_not_told_as_new() -> None:
    """A message made a tenth of a second after the last one is read 1.3 s after it."""
    is_late = asyncio.Event()

    async def script(tell: Tell) -> None:
        await tell(told.state_text(0, vehicles=(told.vehicle(),)))
        await is_late.wait()
        await tell(told.state_text(100_000_000, vehicles=(told.vehicle(),)))
        await asyncio.Event().wait()

    async def main() -> None:
        clock = HandClock()
        async with fake_station(FakeStation(script), clock) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            assert (await anext(states)).is_live
            clock.pass_s(1.3)
            is_late.set()
            state = await anext(states)
            assert state.staleness is Staleness.LATE
            assert state.telemetry_age_s == pytest.approx(1.25)

    asyncio.run(main())


def test_a_stream_that_breaks_off_is_opened_again() -> None:
    async def main() -> None:
        fake = FakeStation(telling(ONE), telling(ONE_LATER, then_silent=True))
        async with fake_station(fake) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            await anext(states)
            assert (await anext(states)).is_live
            assert fake.readers == 2

    asyncio.run(main())


def test_a_station_started_anew_does_not_answer_for_older_orders() -> None:
    """Its first order has the same number, and is another one."""
    begun_anew = told.state_text(
        run_started_ns=told.RUN_STARTED_NS + 10**9, commands=(told.command(1, "confirmed"),)
    )
    is_ordered = asyncio.Event()

    async def first(tell: Tell) -> None:
        await tell(ONE)
        await is_ordered.wait()

    async def main() -> None:
        fake = FakeStation(first, telling(begun_anew, then_silent=True))
        async with fake_station(fake) as station:
            order = await (await station.vehicle("SIM-1")).hold()
            assert isinstance(order, Order)
            is_ordered.set()
            with pytest.raises(ConnectionLostError, match="started anew"):
                await order.wait()
            assert fake.orders == 1

    asyncio.run(main())


@pytest.mark.parametrize("results", ["", RESULT % '"SIM-2"', ", ".join([RESULT % '"SIM-1"'] * 2)])
def test_results_for_others_answer_nothing(results: str) -> None:
    async def main() -> None:
        fake = FakeStation(telling(ONE, then_silent=True), results=results)
        async with fake_station(fake) as station:
            vehicle = await station.vehicle("SIM-1")
            with pytest.raises(MaybeSentError, match="may have been sent"):
                await vehicle.land()
            assert fake.orders == 1

    asyncio.run(main())


@pytest.mark.parametrize(
    "foreign", ["hello", "[]", "{}", b"\x00\xff", ONE.replace('"live"', '"fresh"')]
)
def test_a_stream_of_something_else_is_told(foreign: str | bytes) -> None:
    async def main() -> None:
        fake = FakeStation(telling(foreign, then_silent=True))
        with pytest.raises(BadAnswerError, match="expected a state as JSON"):
            async with fake_station(fake):
                pass
        assert fake.readers == 1

    asyncio.run(main())


def test_a_stream_that_turns_foreign_ends_the_telemetry() -> None:
    async def main() -> None:
        async with fake_station(FakeStation(telling(ONE, "rubbish", then_silent=True))) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            with pytest.raises(BadAnswerError, match="rubbish"):
                async for _ in states:
                    pass

    asyncio.run(main())


def test_a_huge_state_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "LONGEST_STATE_BYTES", 1000)

    async def main() -> None:
        with pytest.raises(BadAnswerError, match="up to 1000 bytes"):
            async with fake_station(FakeStation(telling(ONE, then_silent=True))):
                pass

    asyncio.run(main())


def opened_against(status: str, *headers: str) -> ClientError:
    """Open a station at a server that answers the handshake with this."""

    head = "\r\n".join([f"HTTP/1.1 {status}", "Content-Length: 0", *headers, "", ""])

    async def main() -> ClientError:
        async with server(head.encode()) as here:
            with pytest.raises(ClientError) as problem:
                await Station(here.url, "secret-1").__aenter__()
            return problem.value

    return asyncio.run(main())


def test_a_redirect_is_not_followed() -> None:
    problem = opened_against("307 Temporary", "Location: ws://127.0.0.1:9/api/stream")
    assert isinstance(problem, RequestRefusedError)
    assert "HTTP 307" in str(problem)


def test_a_station_that_cannot_be_reached_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.client.station.OPEN_WITHIN_S", 0.5)
    problem = opened_against("503 Service Unavailable")
    assert isinstance(problem, StationUnreachableError)
    assert "503" in str(problem)
