"""The guard's port: one request, answered or refused with a sentence; nothing breaks it."""

import asyncio
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.guard.stop_port import MOST_BYTES, UNNAMED, StopPort
from recon.guard.watch import Intervention

CONSOLE = "http://127.0.0.1:8080"


class FakeGuard:
    """Notes who stopped all."""

    def __init__(self, *, is_orphan: bool = False) -> None:
        self.stopped_by: list[str] = []
        self.has_yielded = False
        self.is_orphan = is_orphan

    def stop_all(self, by: str) -> Intervention:
        self.stopped_by.append(by)
        return Intervention("all stop at the guard", ("A",), ("Drone 1",), by=by)

    def yield_to_next(self) -> tuple[Intervention, ...]:
        self.has_yielded = True
        return (Intervention("the station has ended", ("A",), ("Drone 1",)),)


class FakeTransport(asyncio.Transport):
    """Keeps what is written."""

    def __init__(self) -> None:
        super().__init__()
        self.written = b""
        self.is_closed = self.is_aborted = False

    def write(self, data: Any) -> None:
        self.written += bytes(data)

    def close(self) -> None:
        self.is_closed = True

    def abort(self) -> None:
        self.is_aborted = True


def spoken(guard: FakeGuard, *pieces: bytes) -> FakeTransport:
    async def speak() -> FakeTransport:
        port, transport = StopPort(guard, CONSOLE), FakeTransport()
        port.connection_made(transport)
        for piece in filter(None, pieces):
            if not transport.is_closed and not transport.is_aborted:
                port.data_received(piece)
        port.connection_lost(None)
        return transport

    return asyncio.run(speak())


def request(
    target: str = "/all-stop",
    *,
    method: str = "POST",
    host: str = "127.0.0.1:8081",
    body: bytes = b"",
    **headers: str,
) -> bytes:
    lines = [f"{method} {target} HTTP/1.1", f"Host: {host}", f"Content-Length: {len(body)}"]
    lines += [f"{name}: {value}" for name, value in headers.items()]
    return "\r\n".join([*lines, "", ""]).encode() + body


def answer(transport: FakeTransport) -> tuple[int, Any]:
    assert transport.is_closed
    head, _, body = transport.written.partition(b"\r\n\r\n")
    return int(head.split()[1]), json.loads(body)


def test_a_person_stops_all() -> None:
    guard = FakeGuard()
    status, said = answer(spoken(guard, request(body=b'{"by": "ann"}')))
    assert (status, said["held"]) == (200, ["Drone 1"])
    assert guard.stopped_by == ["ann"]


@pytest.mark.parametrize(
    "body", [b"", b"{}", b"[]", b"null", b'{"by": 3}', b'{"by": ""}', b'{"by": "a\\nb"}', b"\xff"]
)
def test_no_stop_fails_for_a_name(body: bytes) -> None:
    guard = FakeGuard()
    assert answer(spoken(guard, request(body=body)))[0] == 200
    assert guard.stopped_by == [UNNAMED]


def test_the_consoles_page_may_ask() -> None:
    guard = FakeGuard()
    transport = spoken(guard, request(Origin=CONSOLE))
    assert answer(transport)[0] == 200
    assert f"access-control-allow-origin: {CONSOLE}".encode() in transport.written.lower()


@pytest.mark.parametrize(
    ("status", "asked"),
    [
        (403, request(Origin="http://evil.example")),
        (403, request(Origin="http://127.0.0.1:9999")),
        (403, request(Origin="null")),
        (400, request(host="evil.example:8081")),
        (400, request(host="[")),
        (404, request("/")),
        (404, request(method="GET")),
        (404, request("/all-stop?x=1")),
        (400, b"nonsense\r\n\r\n"),
        (409, request("/give-way")),
    ],
)
def test_what_is_refused_stops_nothing_and_says_why(status: int, asked: bytes) -> None:
    guard = FakeGuard()
    code, said = answer(spoken(guard, asked))
    assert code == status
    assert said["error"]
    assert guard.stopped_by == []
    assert not guard.has_yielded


def test_an_orphan_gives_way_and_tells_what_it_did() -> None:
    guard = FakeGuard(is_orphan=True)
    status, said = answer(spoken(guard, request("/give-way")))
    assert status == 200
    assert said["interventions"][0]["why"] == "the station has ended"
    assert guard.has_yielded


def test_a_long_body_is_cut_off() -> None:
    guard = FakeGuard()
    transport = spoken(guard, request(body=b"x" * (MOST_BYTES + 1)))
    assert transport.is_aborted
    assert guard.stopped_by == []


def test_half_a_request_is_cut_off_in_time() -> None:
    async def wait() -> float:
        loop = asyncio.get_running_loop()
        port, transport = StopPort(FakeGuard(), CONSOLE), FakeTransport()
        port.connection_made(transport)
        port.data_received(b"POST /all-st")
        return port._timer.when() - loop.time()

    assert 0.0 < asyncio.run(wait()) <= 2.0


@given(st.lists(st.binary(min_size=1, max_size=200), max_size=5))
def test_no_bytes_break_it(pieces: list[bytes]) -> None:
    guard = FakeGuard()
    transport = spoken(guard, *pieces)
    assert guard.stopped_by == []
    if transport.is_closed:
        assert answer(transport)[0] >= 400


@given(st.integers(0, 120), st.integers(1, 40))
def test_a_request_in_pieces_is_one_request(first: int, second: int) -> None:
    guard, whole = FakeGuard(), request(body=b'{"by": "ann"}')
    transport = spoken(guard, whole[:first], whole[first : first + second], whole[first + second :])
    assert answer(transport)[0] == 200
    assert guard.stopped_by == ["ann"]
