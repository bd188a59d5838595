"""Streams that close, fall silent, or do not come from a station."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.types import Receive, Scope, Send
from tests.api.serving import serving
from tests.client import fake_state
from tests.client.raw_server import server
from tests.client.running_station import running_station
from tests.patient_loop import run_patiently

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
from recon.client.stream import WINDOW_NS, StreamClock

SendText = Callable[[str | bytes], Awaitable[None]]
Script = Callable[[SendText], Awaitable[None]]
RESULT = (
    '{"serial": %s, "link_id": 1, "vehicle_name": "one", "accepted": true, "command_id": 1,'
    ' "rule": null, "reason": null}'
)


class FakeStation:
    """Runs one script per reader, the last one repeatedly."""

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

        async def send_text(text: str | bytes) -> None:
            kind = "text" if isinstance(text, str) else "bytes"
            await send({"type": "websocket.send", kind: text})

        await script(send_text)
        await send({"type": "websocket.close", "code": 1001})


def sending(*texts: str | bytes, then_silent: bool = False) -> Script:
    async def script(send_text: SendText) -> None:
        for text in texts:
            await send_text(text)
        if then_silent:
            await asyncio.Event().wait()

    return script


ONE = fake_state.state_text(vehicles=(fake_state.vehicle(),))
ONE_LATER = fake_state.state_text(6_000_000_000, vehicles=(fake_state.vehicle(),))


class ManualClock:
    """A clock that the test advances."""

    def __init__(self) -> None:
        self.ns = 0

    def __call__(self) -> int:
        return self.ns

    def advance_s(self, seconds: float) -> None:
        self.ns += round(seconds * 1e9)


@asynccontextmanager
async def fake_station(
    station: FakeStation, clock: ManualClock | None = None
) -> AsyncIterator[Station]:
    async with serving(station) as url:
        opened = Station(url)
        if clock is not None:
            opened._stream.now_ns = clock
        async with opened:
            yield opened


def test_telemetry_of_a_silent_stream_becomes_late_and_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("recon.client.vehicle.REPEAT_S", 0.02)

    async def main() -> None:
        clock = ManualClock()
        async with fake_station(FakeStation(sending(ONE, then_silent=True)), clock) as station:
            states = (await station.vehicle("SIM-1")).telemetry(lost_after_s=10.0)
            assert (await anext(states)).position.age_s == pytest.approx(0.05)
            for passed_s, staleness in (
                (0.0, "live"),
                (1.0, "late"),
                (3.0, "lost"),
                (9.99, "silent"),
            ):
                clock.ns = round(passed_s * 1e9)
                state = await anext(states)
                assert state.staleness is Staleness(staleness)
                assert state.position.age_s == pytest.approx(0.05 + passed_s)
            clock.advance_s(0.02)
            with pytest.raises(ConnectionLostError, match="got none for 10 s"):
                await anext(states)

    run_patiently(main())


def test_buffered_messages_are_not_live() -> None:
    """A message created 0.1 s after the last one is read 1.3 s after it."""
    is_late = asyncio.Event()

    async def script(send_text: SendText) -> None:
        await send_text(fake_state.state_text(0, vehicles=(fake_state.vehicle(),)))
        await is_late.wait()
        await send_text(fake_state.state_text(100_000_000, vehicles=(fake_state.vehicle(),)))
        await asyncio.Event().wait()

    async def main() -> None:
        clock = ManualClock()
        async with fake_station(FakeStation(script), clock) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            assert (await anext(states)).is_live
            clock.advance_s(1.3)
            is_late.set()
            state = await anext(states)
            assert state.staleness is Staleness.LATE
            assert state.telemetry_age_s == pytest.approx(1.25)

    run_patiently(main())


def test_a_closed_stream_is_reopened() -> None:
    async def main() -> None:
        fake = FakeStation(sending(ONE), sending(ONE_LATER, then_silent=True))
        async with fake_station(fake) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            await anext(states)
            assert (await anext(states)).is_live
            assert fake.readers == 2

    run_patiently(main())


def test_orders_from_before_a_restart_are_lost() -> None:
    """The first order after the restart has the same id but is a different one."""
    restarted = fake_state.state_text(
        run_started_ns=fake_state.RUN_STARTED_NS + 10**9,
        commands=(fake_state.command(1, "confirmed"),),
    )
    is_ordered = asyncio.Event()

    async def first(send_text: SendText) -> None:
        await send_text(ONE)
        await is_ordered.wait()

    async def main() -> None:
        fake = FakeStation(first, sending(restarted, then_silent=True))
        async with fake_station(fake) as station:
            order = await (await station.vehicle("SIM-1")).hold()
            assert isinstance(order, Order)
            is_ordered.set()
            with pytest.raises(ConnectionLostError, match="restarted"):
                await order.wait()
            assert fake.orders == 1

    run_patiently(main())


@pytest.mark.parametrize("results", ["", RESULT % '"SIM-2"', ", ".join([RESULT % '"SIM-1"'] * 2)])
def test_results_for_other_vehicles_are_no_answer(results: str) -> None:
    async def main() -> None:
        fake = FakeStation(sending(ONE, then_silent=True), results=results)
        async with fake_station(fake) as station:
            vehicle = await station.vehicle("SIM-1")
            with pytest.raises(MaybeSentError, match="may have been sent"):
                await vehicle.land()
            assert fake.orders == 1

    run_patiently(main())


@pytest.mark.parametrize(
    "data", ["hello", "[]", "{}", b"\x00\xff", ONE.replace('"live"', '"fresh"')]
)
def test_a_stream_without_states_is_rejected(data: str | bytes) -> None:
    async def main() -> None:
        fake = FakeStation(sending(data, then_silent=True))
        with pytest.raises(BadAnswerError, match="expected a state as JSON"):
            async with fake_station(fake):
                pass
        assert fake.readers == 1

    run_patiently(main())


def test_an_unreadable_message_ends_the_telemetry() -> None:
    async def main() -> None:
        async with fake_station(FakeStation(sending(ONE, "rubbish", then_silent=True))) as station:
            states = (await station.vehicle("SIM-1")).telemetry()
            with pytest.raises(BadAnswerError, match="rubbish"):
                async for _ in states:
                    pass

    run_patiently(main())


def test_a_huge_state_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "LONGEST_STATE_BYTES", 1000)

    async def main() -> None:
        with pytest.raises(BadAnswerError, match="up to 1000 bytes"):
            async with fake_station(FakeStation(sending(ONE, then_silent=True))):
                pass

    run_patiently(main())


def opened_against(status: str, *headers: str) -> ClientError:
    """Open a station whose server answers the handshake with this status; return the error."""

    head = "\r\n".join([f"HTTP/1.1 {status}", "Content-Length: 0", *headers, "", ""])

    async def main() -> ClientError:
        async with server(head.encode()) as here:
            with pytest.raises(ClientError) as problem:
                await Station(here.url, "secret-1").__aenter__()
            return problem.value

    return run_patiently(main())


def test_a_redirect_is_not_followed() -> None:
    problem = opened_against("307 Temporary", "Location: ws://127.0.0.1:9/api/stream")
    assert isinstance(problem, RequestRefusedError)
    assert "HTTP 307" in str(problem)


def test_an_unreachable_station_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.client.station.OPEN_WITHIN_S", 0.5)
    problem = opened_against("503 Service Unavailable")
    assert isinstance(problem, StationUnreachableError)
    assert "503" in str(problem)


MS = 1_000_000
RUN = 5


@given(
    st.integers(-(10**18), 10**18),
    st.lists(st.integers(0, 3000), min_size=1, max_size=50),
)
def test_delays_are_known_relative_to_the_fastest_message(
    clock_offset_ns: int, delays_ms: list[int]
) -> None:
    """Truth: created every 100 ms, arriving in order after at least 2 ms and the given delay."""
    clock = StreamClock()
    last_ns, fastest_ns = 0, 10**18
    for number, delay_ms in enumerate(delays_ms):
        created_ns = number * 100 * MS
        arrived_ns = last_ns = max(last_ns, created_ns + (2 + delay_ms) * MS)
        fastest_ns = min(fastest_ns, arrived_ns - created_ns)
        found_ns = clock.created_at_ns(created_ns + clock_offset_ns, RUN, arrived_ns)
        assert found_ns <= arrived_ns
        assert found_ns == created_ns + fastest_ns


def test_clock_drift_is_tracked() -> None:
    clock = StreamClock()
    for second in range(0, 36_000, 10):
        station_ns = second * 1_000 * MS
        ours_ns = station_ns + station_ns // 20_000
        delay_ns = ours_ns - clock.created_at_ns(station_ns, RUN, ours_ns)
        assert delay_ns <= 3 * WINDOW_NS // 20_000


def test_another_run_of_the_station_has_another_clock() -> None:
    clock = StreamClock()
    assert clock.created_at_ns(1_000, RUN, 50) == 50
    assert clock.created_at_ns(9, RUN + 1, 70) == 70


def test_a_refused_stream_states_the_reason() -> None:
    async def main() -> None:
        async with running_station(vehicles=0, token="the-token-of-the-station") as url:
            for token, sentence in (("another-token-than-this", "wrong"), (None, "missing")):
                with pytest.raises(RequestRefusedError, match=f"token {sentence}.*--token-file"):
                    async with Station(url, token):
                        pass

    run_patiently(main())
