"""Connections of the HTTP server, with an end for peers that send or read nothing.

Uvicorn waits without end for the rest of a request, and for a reader of a response or stream.
Here a connection that has waited `PATIENCE_S` in one and the same state for its peer is aborted:
for a request, for a reader that takes nothing, or for its closing. Readers that answer no ping end
after `PING_S` and as long again, whatever fits into the kernel's buffers.
"""

import asyncio
import socket
import sys
from collections.abc import Callable, Hashable
from typing import ClassVar, cast

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

if sys.platform != "win32":
    import fcntl
    import termios

PATIENCE_S = 10.0
"""A request of 1 MiB takes this long at 0.8 Mbit/s."""

CHECKS = 10
"""The patience is over when so many checks in a row find the same. Counted, not timed: a
computer that stood still for a while has taken nothing from its peers either."""

MAX_WAITING = 128
"""Connections without a request; the oldest gives way. A browser opens six."""

PING_S = 10.0

STEP_BYTES = 64 * 1024
"""A reader must take this much within the patience."""

SEND_BUFFER_BYTES = 128 * 1024
"""Send buffer of a stream's socket. A kernel's default is megabytes: minutes of states for a slow
radio link, each of them old when it arrives."""


class Deadline:
    """Aborts a connection once it has been in one state of waiting for too long.

    `state` returns what the connection waits for, None for nothing.
    """

    def __init__(self, transport: asyncio.Transport, state: Callable[[], Hashable]) -> None:
        self._transport = transport
        self._state = state
        self._loop = asyncio.get_running_loop()
        self._last: Hashable = None
        self._found_same = 0
        self._timer = self._loop.call_later(PATIENCE_S / CHECKS, self._check)

    def cancel(self) -> None:
        """Watch no longer."""
        self._timer.cancel()

    def _check(self) -> None:
        state = self._state()
        if state is None or state != self._last:
            self._last, self._found_same = state, 0
        else:
            self._found_same += 1
            if self._found_same >= CHECKS:
                self._transport.abort()
                return
        self._timer = self._loop.call_later(PATIENCE_S / CHECKS, self._check)


class HttpConnection(H11Protocol):
    """A connection that must complete its requests and read its responses."""

    waiting: ClassVar[dict["HttpConnection", None]] = {}
    """Connections without a request so far, the oldest first."""

    _deadline: Deadline | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin to wait for a request."""
        super().connection_made(cast(asyncio.Transport, transport))
        self._deadline = Deadline(self.transport, self._awaited)
        self.waiting[self] = None
        if len(self.waiting) > MAX_WAITING:
            oldest = next(iter(self.waiting))
            self.waiting.pop(oldest)
            oldest.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop waiting."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take bytes of a request."""
        super().data_received(data)
        if self.cycle is not None:
            self.waiting.pop(self, None)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection over to `StreamConnection`."""
        self._stop_waiting()
        super().handle_websocket_upgrade(event)

    def _stop_waiting(self) -> None:
        self.waiting.pop(self, None)
        if self._deadline is not None:
            self._deadline.cancel()

    def _awaited(self) -> Hashable:
        if self.transport.is_closing():
            return "close"
        if self.flow.write_paused:
            return _reader(self.transport)
        if self.cycle is None or self.cycle.response_complete or self.cycle.more_body:
            return "request", self.cycle
        return None


class StreamConnection(WebSocketsSansIOProtocol):
    """A WebSocket whose peer must read what is sent."""

    _deadline: Deadline | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take over an upgraded connection."""
        super().connection_made(transport)
        own = self.transport.get_extra_info("socket")
        if own is not None:
            own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        self._deadline = Deadline(self.transport, self._awaited)

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop waiting."""
        if self._deadline is not None:
            self._deadline.cancel()
        super().connection_lost(exc)

    def _awaited(self) -> Hashable:
        if self.transport.is_closing():
            return "close"
        return None if self.writable.is_set() else _reader(self.transport)


def _reader(transport: asyncio.Transport) -> Hashable:
    # Nothing is added while writing is paused, so what is left shows whether the peer reads.
    left_bytes = transport.get_write_buffer_size() + _in_kernel_bytes(transport)
    return "reader", left_bytes // STEP_BYTES


def _in_kernel_bytes(transport: asyncio.Transport) -> int:
    """Return how much the peer has not acknowledged; the kernel takes more in large steps only.

    Windows does not tell: there a reader counts by what leaves the transport alone.
    """
    if sys.platform == "win32":
        return 0
    sock = transport.get_extra_info("socket")
    try:
        queued = fcntl.ioctl(sock.fileno(), termios.TIOCOUTQ, bytes(4))
    except (AttributeError, OSError, ValueError):
        return 0
    return int.from_bytes(queued, sys.byteorder)
