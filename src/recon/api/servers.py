"""The HTTP servers: one without TLS for loopback, one with TLS for other computers.

Uvicorn counts a connection only after its TLS handshake, and waits a minute for it: half handshakes
would cost places that no limit counts. So `HttpsServer` accepts connections itself:

    accepted --> handshake --done--> HTTP --> ...
                     --`PATIENCE_S`, an error, or too many at once: the oldest--> closed

Its limits are its own: strangers in the network cannot push out connections that wait at loopback.
Handshakes take CPU time of the station's event loop, so they begin at a limited rate; further
connections wait in the kernel's backlog.
"""

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from typing import ClassVar

import uvicorn

from recon.api import connections
from recon.api.connections import HttpConnection

HANDSHAKES_HZ = 50.0
"""About 1 ms each: at most a twentieth of the loop's time."""
BURST = 20
"""Handshakes that begin at once: a console opens six connections."""

ACCEPT_AGAIN_S = 1.0
"""Pause after an error of accepting, such as no free file descriptor."""


class HttpServer(uvicorn.Server):
    """Uvicorn without its own signal handling.

    That would raise the signal again once the server has ended, and so kill the process before the
    links are closed and the captures written.
    """

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals alone; the station takes them."""
        yield


class SecuredConnection(HttpConnection):
    """An HTTP connection of the network's address, which has places of its own."""

    waiting: ClassVar[dict[HttpConnection, None]] = {}


class HandshakePace:
    """Token bucket that decides when the next handshake may begin."""

    def __init__(self) -> None:
        self._full_at_s = 0.0

    def wait_s(self, now_s: float) -> float:
        """Count a handshake; return how long it waits before it begins, seconds."""
        self._full_at_s = max(self._full_at_s, now_s) + 1.0 / HANDSHAKES_HZ
        return max(0.0, self._full_at_s - now_s - BURST / HANDSHAKES_HZ)


class HttpsServer(HttpServer):
    """A server that does the TLS handshakes of its connections within limits."""

    def __init__(self, config: uvicorn.Config, context: ssl.SSLContext) -> None:
        super().__init__(config)
        self._context = context
        self._pace = HandshakePace()
        self._handshakes: dict[asyncio.Task[None], None] = {}
        """The oldest first."""
        self._accepting: list[asyncio.Task[None]] = []

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to accept connections of listening sockets."""
        await super().startup(sockets=[])
        for sock in sockets or []:
            sock.setblocking(False)
            self._accepting.append(asyncio.create_task(self._accept(sock)))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Accept no more, end handshakes, then end the connections as uvicorn does."""
        ending = (*self._accepting, *self._handshakes)
        for task in ending:
            task.cancel()
        await asyncio.gather(*ending, return_exceptions=True)
        await super().shutdown(sockets)

    async def _accept(self, sock: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                accepted, _ = await loop.sock_accept(sock)
            except OSError:
                await asyncio.sleep(ACCEPT_AGAIN_S)
                continue
            task = asyncio.create_task(self._shake_hands(accepted))
            self._handshakes[task] = None
            task.add_done_callback(lambda ended: self._handshakes.pop(ended, None))
            if len(self._handshakes) > connections.MAX_WAITING:
                next(iter(self._handshakes)).cancel()
            await asyncio.sleep(self._pace.wait_s(loop.time()))

    async def _shake_hands(self, accepted: socket.socket) -> None:
        try:
            await asyncio.get_running_loop().connect_accepted_socket(
                self._new_connection,
                accepted,
                ssl=self._context,
                ssl_handshake_timeout=connections.PATIENCE_S,
            )
        except (OSError, TimeoutError):
            # A port scanner, a client that does not trust the certificate, or one too slow.
            with contextlib.suppress(OSError):
                accepted.close()
        except asyncio.CancelledError:
            accepted.close()
            raise

    def _new_connection(self) -> SecuredConnection:
        return SecuredConnection(
            config=self.config, server_state=self.server_state, app_state=self.lifespan.state
        )
