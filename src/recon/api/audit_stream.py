"""The stream of the audit: every entry to every reader, in order, from the number asked for on.

Nothing is conflated. A reader that is slow holds one page, and is told the rest as it reads on; one
that falls behind what the station keeps in memory sees it by the numbers (`first_n`).
"""

import asyncio

from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.api.port import StationPort
from recon.api.security import PROTOCOL
from recon.api.stream import until_gone

MOST_ON_A_PAGE = 100
"""Entries in one answer; with the longest missions some 2 MiB."""
INTERVAL_S = 0.1
MOST_READERS = 16


class AuditStream:
    """Serves all readers."""

    def __init__(self, port: StationPort) -> None:
        self._port = port
        self._readers = 0

    async def serve(self, socket: WebSocket, after: int) -> None:
        """Send entries to one reader until it goes."""
        if self._readers >= MOST_READERS:
            await socket.close(1013, f"{MOST_READERS} readers are connected already")
            return
        self._readers += 1
        try:
            offered = socket.scope.get("subprotocols", [])
            await socket.accept(subprotocol=PROTOCOL if PROTOCOL in offered else None)
            await self._send_until_gone(socket, after)
        except (WebSocketDisconnect, RuntimeError):
            return
        finally:
            self._readers -= 1

    async def _send_until_gone(self, socket: WebSocket, after: int) -> None:
        gone = asyncio.ensure_future(until_gone(socket))
        try:
            while not gone.done():
                page = self._port.audit(after, MOST_ON_A_PAGE)
                if page.entries:
                    await socket.send_text(page.model_dump_json())
                    after = page.entries[-1].n
                if after >= page.last_n:
                    await asyncio.wait((gone,), timeout=INTERVAL_S)
        finally:
            gone.cancel()
