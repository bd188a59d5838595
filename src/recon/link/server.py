"""The TCP server for companion apps: sockets around sessions, nothing more."""

import asyncio
import socket
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, cast

from recon.link.capture import Capture, Direction
from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.model.errors import describe_fault
from recon.model.event import Event, LinkClosed, LinkOpened, StationFaulted
from recon.safety import ApprovedCommand

HandleEvent = Callable[[Event], None]
Clock = Callable[[], int]


class LinkServer:
    """Listens for apps; hands every event to `handle` in the order it happened."""

    def __init__(
        self,
        handle: HandleEvent,
        now_ns: Clock,
        settings: LinkSettings,
        capture: Capture | None = None,
    ) -> None:
        self.handle = handle
        self.now_ns = now_ns
        self.settings = settings
        self.capture = capture
        self.connections: dict[int, Connection] = {}
        self.refused_connections = 0
        self.ended: dict[int, Session] = {}
        """The latest sessions that are over, for their counters."""
        self._next_link_id = 1
        self._server: asyncio.Server | None = None

    async def start(self, host: str, port: int) -> list[str]:
        """Begin to listen; return the addresses. Raises OSError when the port is taken."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(lambda: Connection(self), host, port, backlog=256)
        return [_address(s.getsockname()) for s in self._server.sockets]

    @property
    def port(self) -> int:
        """The port it listens on; 0 before it does."""
        sockets = () if self._server is None else self._server.sockets
        return int(sockets[0].getsockname()[1]) if sockets else 0

    async def stop(self) -> None:
        """Close the listening socket and every connection."""
        if self._server is not None:
            self._server.close()
        for connection in tuple(self.connections.values()):
            connection.close("the station stops")
        await asyncio.sleep(0)

    def sessions(self) -> dict[int, Session]:
        """Return the sessions that stand and those lately ended, by link."""
        standing = (c.session for c in self.connections.values() if c.session is not None)
        return self.ended | {session.link_id: session for session in standing}

    def has_room(self) -> bool:
        """Return whether another link fits; the oldest that has never spoken must give way."""
        if len(self.connections) < self.settings.max_links:
            return True
        for connection in tuple(self.connections.values()):
            if connection.session is not None and not connection.session.has_packets:
                connection.close("others need the place, and it has never spoken")
                self.connections.pop(connection.session.link_id, None)
                return True
        return False

    def forget(self, session: Session) -> None:
        """Take a session that is over from those that stand; the oldest ended one goes."""
        self.connections.pop(session.link_id, None)
        self.ended[session.link_id] = session
        if len(self.ended) > self.settings.ended_sessions_kept:
            del self.ended[next(iter(self.ended))]

    def new_link_id(self) -> int:
        """Return the next connection's number."""
        link_id = self._next_link_id
        self._next_link_id += 1
        return link_id

    def send(self, approved: ApprovedCommand) -> None:
        """Send an approved command on each link it was approved for."""
        for link_id in approved.link_ids:
            connection = self.connections.get(link_id)
            if connection is not None:
                connection.submit(approved)

    def withdraw_motion(self, link_ids: tuple[int, ...], reason: str) -> None:
        """Drop the orders to move that wait unsent on these links."""
        for link_id in link_ids:
            connection = self.connections.get(link_id)
            if connection is not None:
                connection.withdraw_motion(reason)

    def close_link(self, link_id: int, reason: str) -> None:
        """Close one connection."""
        connection = self.connections.get(link_id)
        if connection is not None:
            connection.close(reason)

    def tick(self) -> None:
        """Let time pass in every session."""
        for connection in tuple(self.connections.values()):
            connection.tick()


class Connection(asyncio.BufferedProtocol):
    """One app's socket. What is read from it at a time is bounded by its own small buffer."""

    def __init__(self, server: LinkServer) -> None:
        self.server = server
        self.session: Session | None = None
        self._transport: asyncio.Transport | None = None
        self._buffer = bytearray(server.settings.read_bytes)
        self._events: deque[Event] = deque()
        self._is_reading = True
        self._is_handling = False
        self._closing_reason: str | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin a session, or refuse the connection when there are too many."""
        self._transport = cast(asyncio.Transport, transport)
        if not self.server.has_room():
            self.server.refused_connections += 1
            self._transport.abort()
            return
        _prepare_socket(self._transport, self.server.settings)
        # A high-water mark of 0 makes the transport tell when everything written has left.
        self._transport.set_write_buffer_limits(high=0)
        now_ns = self.server.now_ns()
        link_id = self.server.new_link_id()
        self.session = Session(link_id, self.server.settings, now_ns)
        self.server.connections[link_id] = self
        address = _address(self._transport.get_extra_info("peername"))
        self.server.handle(LinkOpened(link_id, address))

    def get_buffer(self, sizehint: int) -> bytearray:
        """Lend the place for what is read next."""
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Take what came; many packets are handled in turns with the other links."""
        with self._isolated():
            self._receive(nbytes)

    def _receive(self, nbytes: int) -> None:
        if self.session is None:
            return
        data = bytes(memoryview(self._buffer)[:nbytes])
        now_ns = self.server.now_ns()
        self._record(Direction.FROM_APP, data, now_ns)
        self._take(self.session.receive(data, now_ns))
        if self.session.closing_reason is not None:
            self.close(self.session.closing_reason)
        # An answer may be what the next command has waited for.
        if self.session.commands_queued:
            self.pump()

    def resume_writing(self) -> None:
        """Everything written has left: the next packet may go."""
        with self._isolated():
            self.pump()

    def connection_lost(self, exc: Exception | None) -> None:
        """End the session, with the reason."""
        if self.session is None:
            return
        self.server.forget(self.session)
        reason = self._closing_reason or _reason(exc)
        with self._isolated():
            self._events.extend(self.session.finish(reason, self.server.now_ns()))
            self._handle(len(self._events))
        self.server.handle(LinkClosed(self.session.link_id, reason))
        if self.server.capture is not None:
            self.server.capture.end_link(self.session.link_id)

    def submit(self, approved: ApprovedCommand) -> None:
        """Queue a command and write it if it may go now."""
        if self.session is None:
            return
        with self._isolated():
            self._take(self.session.submit(approved))
            self.pump()

    def withdraw_motion(self, reason: str) -> None:
        """Drop the order to move that waits unsent."""
        if self.session is None:
            return
        with self._isolated():
            self._take(self.session.withdraw_motion(reason))

    def tick(self) -> None:
        """Let time pass."""
        with self._isolated():
            self._tick()

    def _tick(self) -> None:
        if self.session is None or self._transport is None:
            return
        now_ns = self.server.now_ns()
        self.session.note_socket(self._is_clear(), now_ns)
        self._take(self.session.tick(now_ns))
        self.pump()
        if self.session.closing_reason is not None:
            self.close(self.session.closing_reason)

    def pump(self) -> None:
        """Write packets that may go, each by itself, while the socket takes them."""
        while self.session is not None and self._transport is not None and self._is_clear():
            now_ns = self.server.now_ns()
            outgoing = self.session.next_packet(now_ns)
            if outgoing is None:
                return
            self._transport.write(outgoing.data)
            self._record(Direction.TO_APP, outgoing.data, now_ns)
            self.server.handle(outgoing.event)

    def close(self, reason: str) -> None:
        """Close the socket now; unsent commands fail with the reason."""
        if self._closing_reason is None and self._transport is not None:
            self._closing_reason = reason
            self._transport.abort()

    @contextmanager
    def _isolated(self) -> Iterator[None]:
        """A fault in the station's own code is reported and costs this connection only."""
        try:
            yield
        except Exception as fault:
            number = None if self.session is None else self.session.link_id
            self.server.handle(StationFaulted(f"on link {number}", describe_fault(fault)))
            self.close("a fault in the station's own code")

    def _is_clear(self) -> bool:
        return (
            self._transport is not None
            and not self._transport.is_closing()
            and self._transport.get_write_buffer_size() == 0
        )

    def _take(self, events: Iterable[Event]) -> None:
        self._events.extend(events)
        # Handling an event can send a command on this very link, and so come back here.
        if self._is_reading and not self._is_handling:
            self._work()

    def _work(self) -> None:
        """Handle some events; with more left, stop reading and go on in the loop's next turn."""
        with self._isolated():
            self._work_on()

    def _work_on(self) -> None:
        self._handle(self.server.settings.events_per_turn)
        if self._transport is None or self._transport.is_closing():
            return
        if self._events:
            self._is_reading = False
            self._transport.pause_reading()
            asyncio.get_running_loop().call_soon(self._work)
        elif not self._is_reading:
            self._is_reading = True
            self._transport.resume_reading()

    def _handle(self, at_most: int) -> None:
        self._is_handling = True
        try:
            while self._events and at_most > 0:
                at_most -= 1
                self.server.handle(self._events.popleft())
        finally:
            self._is_handling = False

    def _record(self, direction: Direction, data: bytes, now_ns: int) -> None:
        if self.server.capture is not None and self.session is not None:
            self.server.capture.record(self.session.link_id, direction, data, now_ns)


def _prepare_socket(transport: asyncio.Transport, settings: LinkSettings) -> None:
    sock = transport.get_extra_info("socket")
    if sock is None:
        return
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in (
        ("TCP_KEEPIDLE", settings.keepalive_idle_s),
        ("TCP_KEEPINTVL", settings.keepalive_interval_s),
        ("TCP_KEEPCNT", settings.keepalive_probes),
    ):
        # Not every system has all three names; keepalive itself is on everywhere.
        if hasattr(socket, name):
            sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, settings.send_buffer_bytes)


def _address(name: Any) -> str:
    if not isinstance(name, tuple):
        return str(name)
    host, port = name[0], name[1]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def _reason(exc: Exception | None) -> str:
    return "the app closed the connection" if exc is None else f"connection failed: {exc}"
