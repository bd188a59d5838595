"""The stream of states: the newest one, as fast as the reader takes them, 10 Hz at most.

Towards slow readers state is conflated: while a message waits to be taken, no other is made, and
what is made then is of that moment. The server's send waits as long as more than its 64 KiB wait
for the socket, so a reader that does not read holds those and one message, whatever its pace.
"""

import asyncio
import time
from collections.abc import Callable

from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.api.owners import Owners, until_silent
from recon.api.port import StationPort
from recon.api.security import PROTOCOL

INTERVAL_S = 0.1
MOST_READERS = 32
OWNER_SILENT = 4008
"""Close code (private use, RFC 6455) for an owner that sent no keepalive in time."""


class StateStream:
    """Serves all readers; one state is made for all who ask within the same interval."""

    def __init__(self, port: StationPort, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._port = port
        self._clock_s = clock_s
        self._text = ""
        self._made_at_s = float("-inf")
        self._readers = 0
        self._owners = Owners(port)

    async def serve(self, socket: WebSocket) -> None:
        """Send states to one reader until it goes."""
        if self._readers >= MOST_READERS:
            await socket.close(1013, f"{MOST_READERS} readers are connected already")
            return
        owner = socket.query_params.get("owner")
        fault = self._owners.fault(owner)
        if fault is not None:
            await socket.close(1008, fault)
            return
        self._readers += 1
        try:
            offered = socket.scope.get("subprotocols", [])
            await socket.accept(subprotocol=PROTOCOL if PROTOCOL in offered else None)
            await self._send_until_gone(socket, owner)
            if owner is not None:
                await socket.close(OWNER_SILENT, "owner: no keepalive in time")
        except (WebSocketDisconnect, RuntimeError):
            return
        finally:
            self._readers -= 1

    async def _send_until_gone(self, socket: WebSocket, owner: str | None) -> None:
        # Listening is a task of its own: sending waits as long as the reader takes nothing.
        gone = asyncio.ensure_future(self._listen(socket, owner))
        try:
            while not gone.done():
                await socket.send_text(self._newest())
                await asyncio.wait((gone,), timeout=INTERVAL_S)
        finally:
            gone.cancel()

    async def _listen(self, socket: WebSocket, owner: str | None) -> None:
        if owner is None:
            await until_gone(socket)
            return
        async with self._owners.holding(owner):
            await until_silent(socket)

    def _newest(self) -> str:
        if self._clock_s() - self._made_at_s >= INTERVAL_S / 2:
            self._text = self._port.state().model_dump_json()
            self._made_at_s = self._clock_s()
        return self._text


async def until_gone(socket: WebSocket) -> None:
    """Read and ignore what a reader sends, to learn when it goes."""
    try:
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
    except (WebSocketDisconnect, RuntimeError):
        return
