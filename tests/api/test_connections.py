"""Peers of the HTTP port that send half a request, or read nothing: their places become free."""

import asyncio
import socket
from collections.abc import Awaitable, Callable
from typing import cast

import pytest
from starlette.types import ASGIApp, Receive, Scope, Send
from tests.api.fake_station import FakeStation, application
from tests.api.serving import BigStation, connected, serving, until_closed
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from recon.api import connections, streams
from recon.api.connections import HttpConnection

PATIENCE_S = 60.0
HANDSHAKE = (
    b"GET %s HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
HALF_REQUESTS = [
    b"",
    b"GET /api/state HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ",
    b"POST /api/orders HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 9\r\n\r\n{",
    b"GET /api/commands HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\nGET /api/st",
]


def run(main: Callable[[], Awaitable[None]]) -> None:
    async def guarded() -> None:
        async with asyncio.timeout(3 * PATIENCE_S):
            await main()

    asyncio.run(guarded())


@pytest.fixture(autouse=True)
def short_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "PATIENCE_S", 0.3)


async def sent(url: str, data: bytes) -> socket.socket:
    peer = await connected(url)
    await asyncio.get_running_loop().sock_sendall(peer, data)
    return peer


@pytest.mark.parametrize("data", HALF_REQUESTS)
def test_half_a_request_loses_its_place(data: bytes) -> None:
    async def main() -> None:
        async with serving(application(FakeStation())) as url:
            peers = [await sent(url, data) for _ in range(40)]
            await asyncio.gather(*(until_closed(peer) for peer in peers))
            assert not HttpConnection.waiting

    run(main)


def test_a_request_in_parts_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "PATIENCE_S", 30.0)

    async def main() -> None:
        async with serving(application(FakeStation())) as url:
            peer = await sent(url, b"GET /api/commands HTT")
            loop = asyncio.get_running_loop()
            await loop.sock_sendall(peer, b"P/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            assert (await loop.sock_recv(peer, 100)).startswith(b"HTTP/1.1 200 OK")
            peer.close()

    run(main)


def test_the_oldest_connection_without_a_request_gives_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(connections, "PATIENCE_S", 60.0)
    monkeypatch.setattr(connections, "MAX_WAITING", 4)

    async def main() -> None:
        async with serving(application(FakeStation())) as url:
            peers = [await sent(url, HALF_REQUESTS[1]) for _ in range(5)]
            await until_closed(peers[0])
            assert len(HttpConnection.waiting) == 4
            for peer in peers[1:]:
                peer.close()

    run(main)


@pytest.mark.parametrize("path", ["/api/stream", "/api/state"])
def test_a_reader_that_never_reads_loses_its_place(
    path: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streams, "MAX_STATE_READERS", 1)
    station, reasons = BigStation(), list[str]()

    async def main() -> None:
        async with serving(application(station)) as url:
            request = (
                HANDSHAKE % path.encode()
                if path == "/api/stream"
                else b"GET /api/state HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" * 3
            )
            stuck = await sent(url, request)
            while True:
                try:
                    async with connect(
                        f"{url.replace('http', 'ws')}/api/stream", max_size=None
                    ) as reader:
                        assert len(await reader.recv()) > 100_000
                        break
                except ConnectionClosed as problem:
                    reasons.append("" if problem.rcvd is None else problem.rcvd.reason)
            await until_closed(stuck)
            assert set(reasons) <= {"1 readers are connected: limit reached"}

    run(main)


@pytest.mark.parametrize(
    ("path", "code", "sentence"),
    [
        ("/api/stream?owner=short", 1008, "owner: name must be 16 to 64"),
        ("/elsewhere", 1008, "No such stream"),
        ("/api/audit/stream?after=x", 1008, "after: "),
    ],
)
def test_a_refused_stream_has_a_code_and_a_sentence(path: str, code: int, sentence: str) -> None:
    async def main() -> None:
        async with serving(application(FakeStation())) as url:
            async with connect(f"{url.replace('http', 'ws')}{path}") as reader:
                with pytest.raises(ConnectionClosed) as closed:
                    await reader.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == code
            assert closed.value.rcvd.reason.startswith(sentence)

    run(main)


def test_a_slow_reader_that_reads_keeps_its_place() -> None:
    """Each message takes longer than the patience, but its bytes move."""

    async def chatty(scope: Scope, receive: Receive, send: Send) -> None:
        await receive()
        await send({"type": "websocket.accept"})
        for _ in range(4):
            await send({"type": "websocket.send", "bytes": bytes(3_000_000)})
        await send({"type": "websocket.close", "code": 1000})

    app: ASGIApp = chatty

    async def main() -> None:
        async with serving(app) as url:
            peer = await sent(url, HANDSHAKE % b"/")
            loop, received = asyncio.get_running_loop(), 0
            began_s = loop.time()
            while received < 12_000_000:
                data = await loop.sock_recv(peer, 60_000)
                assert data, f"closed after {received} bytes"
                received += len(data)
                await asyncio.sleep(0.004)
            assert loop.time() - began_s > 2 * connections.PATIENCE_S
            peer.close()

    run(main)


class StillLoop:
    """A loop whose timers run when the test calls them."""

    def __init__(self) -> None:
        self.timers: list[Callable[[], None]] = []

    def call_later(self, _delay_s: float, timer: Callable[[], None]) -> asyncio.TimerHandle:
        self.timers.append(timer)
        return cast(asyncio.TimerHandle, None)


class FakeTransport(asyncio.Transport):
    """Notes that it was aborted."""

    is_aborted = False

    def abort(self) -> None:
        self.is_aborted = True


def test_a_wait_ends_by_checks_not_by_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that stood still for a minute runs one late check: its peers keep their places."""
    loop, transport, states = StillLoop(), FakeTransport(), ["request"]
    monkeypatch.setattr(asyncio, "get_running_loop", lambda: loop)
    connections.Deadline(transport, lambda: states[-1])
    for _ in range(connections.CHECKS):
        loop.timers.pop()()
    assert not transport.is_aborted
    states.append("answer read in part")
    for _ in range(connections.CHECKS):
        loop.timers.pop()()
    assert not transport.is_aborted
    loop.timers.pop()()
    assert transport.is_aborted
    assert loop.timers == []
