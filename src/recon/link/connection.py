"""One app's socket: bytes into its session, packets out, events to the server in their order."""

import asyncio
import os
import select
import socket
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, cast

from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.link.tap import Direction
from recon.model.errors import describe_fault
from recon.model.event import CommandDropped, Event, LinkOpened, StationFaulted
from recon.safety import ApprovedCommand

if TYPE_CHECKING:
    from recon.link.server import LinkServer


class Connection(asyncio.BufferedProtocol):
    """One app's socket. What is read from it at a time is bounded by its own small buffer."""

    def __init__(self, server: "LinkServer") -> None:
        self.server = server
        self.session: Session | None = None
        self._transport: asyncio.Transport | None = None
        self._buffer = bytearray(server.settings.read_bytes)
        self._events: deque[Event] = deque()
        self._is_reading = True
        self._is_handling = False
        self._closing_reason: str | None = None
        self._is_lost = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin a session, or refuse the connection when there are too many."""
        self._transport = cast(asyncio.Transport, transport)
        address = address_text(self._transport.get_extra_info("peername"))
        if not self.server.has_room():
            self._transport.abort()
            self.server.refuse(address)
            return
        _prepare_socket(self._transport, self.server.settings)
        # A high-water mark of 0 makes the transport tell when everything written has left.
        self._transport.set_write_buffer_limits(high=0)
        now_ns = self.server.now_ns()
        link_id = self.server.new_link_id()
        self.session = Session(link_id, self.server.settings, now_ns)
        self.server.add(self)
        self.server.handle(LinkOpened(link_id, address))

    @property
    def socket(self) -> Any:
        """Return its socket, as asyncio lends it; None without one."""
        return None if self._transport is None else self._transport.get_extra_info("socket")

    @property
    def link_id(self) -> int:
        """The number of its session; 0 before it has one."""
        return 0 if self.session is None else self.session.link_id

    @property
    def is_identified(self) -> bool:
        """Whether its app has reported a serial number."""
        return self.session is not None and self.session.is_identified

    def get_buffer(self, sizehint: int) -> bytearray:
        """Lend the place for what is read next."""
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Take what came; many packets are handled in turns with the other links."""
        if self.session is None:
            return
        with self._isolated():
            data = bytes(memoryview(self._buffer)[:nbytes])
            now_ns = self.server.now_ns()
            self._record(Direction.FROM_APP, data, now_ns)
            self._take(self.session.receive(data, now_ns))
            self._check_session(self.session)
            # An answer may be what the next command has waited for.
            if self.session.commands_queued:
                self.pump()

    def _check_session(self, session: Session) -> None:
        """Account for what the session holds, and close it when it has a reason to."""
        self.server.note_buffered(self, session.buffered_bytes)
        if session.closing_reason is not None:
            self.close(session.closing_reason)

    def resume_writing(self) -> None:
        """Everything written has left: the next packet may go."""
        with self._isolated():
            self.pump()

    def connection_lost(self, exc: Exception | None) -> None:
        """End the session, with the reason, once all that it held is searched."""
        if self.session is None:
            return
        self.server.forget(self.session)
        self._closing_reason = self._closing_reason or _reason(exc)
        self._is_lost = True
        with self._isolated():
            self._events.extend(self.session.end_stream())
        self._end(self.session)

    def _end(self, session: Session) -> None:
        """Handle some of the last events; with more left, continue in the loop's next turn."""
        is_sound = False
        with self._isolated():
            self._advance(session)
            is_sound = True
        if is_sound and (self._events or session.is_busy):
            asyncio.get_running_loop().call_soon(self._end, session)
            return
        reason = self._closing_reason or ""
        with self._isolated():
            self._events.extend(session.drop_unsent(reason))
            self._handle(len(self._events))
        self.server.ended_with(self, reason)

    def free_memory(self, reason: str) -> None:
        """Drop the half-received packet; without a serial number close the connection too."""
        if self.session is not None:
            self.session.discard_half_packet()
            self.server.note_buffered(self, 0)
            if not self.session.is_identified:
                self.close(reason)

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
            if self.session is None or self._transport is None:
                return
            now_ns = self.server.now_ns()
            self.session.note_socket(self._is_clear(), now_ns)
            self._take(self.session.tick(now_ns, has_unread=self._has_unread(self.session)))
            self.pump()
            self._check_session(self.session)

    def pump(self) -> None:
        """Write packets that may go, one at a time, while the socket takes them."""
        while self.session is not None and self._transport is not None and self._is_clear():
            now_ns = self.server.now_ns()
            outgoing = self.session.next_packet(now_ns, self.server.objection)
            if outgoing is None:
                return
            if isinstance(outgoing, CommandDropped):
                self.server.handle(outgoing)
                continue
            self._transport.write(outgoing.data)
            self._record(Direction.TO_APP, outgoing.data, now_ns)
            self.server.handle(outgoing.event)

    def close(self, reason: str) -> None:
        """Close the socket now; unsent commands fail with the reason."""
        if self._closing_reason is None and self._transport is not None:
            self._closing_reason = reason
            _shut_down(self.socket)
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

    def _has_unread(self, session: Session) -> bool:
        """Return whether half a packet waits for bytes that lie unread in the kernel."""
        if not session.is_waiting_for_bytes:
            return False
        if not self._is_reading:
            return True
        sock = None if self._transport is None else self._transport.get_extra_info("socket")
        if sock is None or sock.fileno() < 0:
            return False
        # Descriptors are few (`max_links`): select takes them, and works on every system.
        return bool(select.select([sock.fileno()], [], [], 0.0)[0])

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
        """Handle some events; with more left, stop reading and continue in the loop's next turn."""
        if self.session is None or self._is_lost:
            return
        with self._isolated():
            self._advance(self.session)
            self._check_session(self.session)
            if self._transport is None or self._transport.is_closing():
                return
            if self._events or self.session.is_busy:
                self._is_reading = False
                self._transport.pause_reading()
                asyncio.get_running_loop().call_soon(self._work)
            elif not self._is_reading:
                self._is_reading = True
                self._transport.resume_reading()

    def _advance(self, session: Session) -> None:
        """Do one turn's work: handle some events, or else search on in what was received."""
        if self._events:
            self._handle(self.server.settings.events_per_turn)
        elif session.is_busy:
            self._events.extend(session.resume())

    def _handle(self, at_most: int) -> None:
        self._is_handling = True
        try:
            while self._events and at_most > 0:
                at_most -= 1
                self.server.handle(self._events.popleft())
        finally:
            self._is_handling = False

    def _record(self, direction: Direction, data: bytes, now_ns: int) -> None:
        if self.server.tap is not None and self.session is not None:
            self.server.tap(self.session.link_id, direction, data, now_ns)


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


def _shut_down(lent: Any) -> None:
    """End a connection although the guard has a duplicate of its socket.

    The socket that uvloop lends cannot be shut down, but a duplicate of it can.
    """
    if lent is not None:
        with suppress(OSError), socket.socket(fileno=os.dup(lent.fileno())) as own:
            own.shutdown(socket.SHUT_RDWR)


def _reason(exc: Exception | None) -> str:
    return "the app closed the connection" if exc is None else f"connection failed: {exc}"


def address_text(name: Any) -> str:
    """Return a socket's address as host and port."""
    if not isinstance(name, tuple):
        return str(name)
    host, port = name[0], name[1]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
