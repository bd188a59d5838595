"""Applications on real sockets of loopback, and peers that speak bytes."""

import asyncio
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import uvicorn
from starlette.types import ASGIApp
from tests.api.fake_station import FakeStation, application

from recon.api.connections import HttpConnection, StreamConnection
from recon.api.schema import StationState
from recon.api.security import Access

PATIENCE_S = 120.0


@asynccontextmanager
async def serving(app: ASGIApp, port: int = 0) -> AsyncIterator[str]:
    """Serve an application with the station's own connections; yield its address."""
    listening = socket.create_server(("127.0.0.1", port))
    server = uvicorn.Server(
        uvicorn.Config(
            app,
            log_level="critical",
            http=HttpConnection,
            ws=StreamConnection,
            lifespan="off",
            timeout_graceful_shutdown=1,
        )
    )
    task = asyncio.create_task(server.serve(sockets=[listening]))
    try:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
    finally:
        server.should_exit = True
        await task
        listening.close()


@asynccontextmanager
async def streaming(station: FakeStation, access: Access | None = None) -> AsyncIterator[str]:
    """Serve a station; yield the address that its streams' paths follow."""
    async with serving(application(station, access=access)) as url:
        yield url.replace("http", "ws", 1)


class BigStation(FakeStation):
    """A station whose state is large: one megabyte of text."""

    def state(self) -> StationState:
        state = super().state()
        name = state.station.model_copy(update={"version": "v" * 1_000_000})
        return state.model_copy(update={"station": name, "time_ns": self.states_made})


async def connected(url: str) -> socket.socket:
    """Return a connection whose kernel takes little; left to themselves some take 32 MiB."""
    place = urlsplit(url)
    peer = socket.socket()
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    peer.setblocking(False)
    await asyncio.get_running_loop().sock_connect(peer, (place.hostname, place.port))
    return peer


async def until_closed(peer: socket.socket) -> None:
    """Read until the station ends the connection."""
    loop = asyncio.get_running_loop()
    try:
        while await loop.sock_recv(peer, 65536):
            pass
    except ConnectionError:
        pass
    finally:
        peer.close()
