"""Readers of the stream that hold steered orders: alive as long as they say so.

A stream that names a owner (`/api/stream?owner=NAME`) must say anything at all, an empty text
will do, twice a second. When it ends, or is silent for two seconds (a computer that sleeps, a
program that hangs), what it holds ends with it: the vehicle is stopped. A name is used by one
stream at a time, and a new connection takes a new one: nothing held comes back to life.
"""

import asyncio
import string
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.api.port import StationPort

SILENT_S = 2.0
"""Four beats lost. A vehicle at 5 m/s is 10 m farther by then."""

SHORTEST_NAME = 16
LONGEST_NAME = 64
_LETTERS = frozenset(string.ascii_letters + string.digits + "-_")


class Owners:
    """The names of the streams that hold orders now."""

    def __init__(self, port: StationPort) -> None:
        self._port = port
        self._names: set[str] = set()

    def fault(self, name: str | None) -> str | None:
        """Return why a stream cannot have this name, in one sentence; None when it can."""
        if name is None:
            return None
        if not SHORTEST_NAME <= len(name) <= LONGEST_NAME or not _LETTERS.issuperset(name):
            return (
                f"owner: {SHORTEST_NAME} to {LONGEST_NAME} letters, digits and -_ make a name, "
                "best drawn at random"
            )
        return f"owner: {name[:8]}... is in use by another stream" if name in self._names else None

    @asynccontextmanager
    async def holding(self, name: str | None) -> AsyncIterator[None]:
        """Hold as long as the block lasts, if there is a name."""
        if name is None:
            yield
            return
        self._names.add(name)
        self._port.owner_connected(name)
        try:
            yield
        finally:
            self._names.discard(name)
            self._port.owner_disconnected(name)


async def until_silent(socket: WebSocket) -> None:
    """Read what a owner says until it goes, or says nothing for too long."""
    try:
        while True:
            async with asyncio.timeout(SILENT_S):
                message = await socket.receive()
            if message["type"] == "websocket.disconnect":
                return
    except (TimeoutError, WebSocketDisconnect, RuntimeError):
        return
