"""The TCP server for companion apps: sockets around sessions, and the limits they share.

Places: beyond `max_links` a connection takes the place of an unidentified link without telemetry,
or is refused. Memory: half-received packets of all links have one budget. Beyond it the oldest
unidentified link that holds more than its share is closed; without one the largest half-received
packet is dropped, and its link stays, because it may carry orders. Either limit is one alarm.
"""

import asyncio
import fcntl
import socket
import sys
import termios
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, cast

from recon.link.capture import Capture, Direction
from recon.link.session import Objection, Session, no_objection
from recon.link.settings import MIB, LinkSettings
from recon.model.errors import describe_fault
from recon.model.event import (
    CommandDropped,
    Event,
    LinkClosed,
    LinkLimitReached,
    LinkOpened,
    StationFaulted,
)
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand

PLACES, MEMORY = "places", "memory"
"""The limits that all links share, in `LinkLimitReached`."""

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
        self.objection: Objection = no_objection
        """Judges an order again at the moment of sending."""
        self.connections: dict[int, Connection] = {}
        self.refused_connections = 0
        self.ended: dict[int, Session] = {}
        """The latest sessions that are over, for their counters."""
        self.ending: set[Connection] = set()
        """Closed connections whose last bytes are still searched."""
        self._buffered_bytes: dict[Connection, int] = {}
        self._buffered_total_bytes = 0
        self._limits_reached_at_ns: dict[str, int] = {}
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
        while self.ending:
            await asyncio.sleep(0)

    def sessions(self) -> dict[int, Session]:
        """Return the sessions that stand and those lately ended, by link."""
        standing = (c.session for c in self.connections.values() if c.session is not None)
        return self.ended | {session.link_id: session for session in standing}

    def has_room(self) -> bool:
        """Return whether another link fits; an unidentified one without telemetry must give way."""
        if len(self.connections) < self.settings.max_links:
            return True
        now_ns = self.now_ns()
        giving_way = [
            connection
            for connection in self.connections.values()
            if connection.session is not None and connection.session.is_without_telemetry(now_ns)
        ]
        # The oldest that has never sent a packet; without one the oldest of all.
        giving_way.sort(key=lambda c: c.session is not None and c.session.has_packets)
        for connection in giving_way[:1]:
            connection.close("no serial number and no telemetry, and another app needs the place")
            self.connections.pop(connection.link_id, None)
            return True
        return False

    def refuse(self, address: str) -> None:
        """Count a connection that found no place; the first one raises an alarm."""
        self.refused_connections += 1
        if PLACES not in self._limits_reached_at_ns:
            self._reach(
                PLACES,
                f"connection from {address} refused: {self.settings.max_links} apps are connected, "
                f"limit {self.settings.max_links}: close the apps that are not needed",
            )

    def note_buffered(self, connection: "Connection", buffered_bytes: int) -> None:
        """Account for the memory of a connection's half-received packet."""
        self._buffered_total_bytes += buffered_bytes - self._buffered_bytes.get(connection, 0)
        if buffered_bytes:
            self._buffered_bytes[connection] = buffered_bytes
        else:
            self._buffered_bytes.pop(connection, None)
        while self._buffered_total_bytes > self.settings.buffer_budget_bytes:
            self._free_memory()

    def _free_memory(self) -> None:
        """Take the memory of one half-received packet back."""
        fair_bytes = self.settings.buffer_budget_bytes // self.settings.max_links
        victim = min(
            (
                connection
                for connection, held_bytes in self._buffered_bytes.items()
                if held_bytes > fair_bytes and not connection.is_identified
            ),
            key=lambda connection: connection.link_id,
            default=None,
        )
        if victim is None:
            victim = max(self._buffered_bytes, key=lambda c: self._buffered_bytes[c])
        held_bytes = self._buffered_bytes[victim]
        budget = f"limit {self.settings.buffer_budget_bytes // MIB} MiB for all links"
        if victim.is_identified:
            what = f"half-received packet of link {victim.link_id} dropped"
        else:
            what = f"unidentified link {victim.link_id} closed"
        reason = (
            f"half-received packets take too much memory ({held_bytes // MIB} MiB here, {budget})"
        )
        victim.free_memory(reason)
        self._reach(MEMORY, f"{what}: {reason}: check which app sends incomplete images")

    def _reach(self, limit: str, problem: str) -> None:
        is_new = limit not in self._limits_reached_at_ns
        self._limits_reached_at_ns[limit] = self.now_ns()
        if is_new:
            self.handle(LinkLimitReached(limit, problem))

    def _check_limits(self) -> None:
        """End the alarms of limits that are no longer reached."""
        if not self._limits_reached_at_ns:
            return
        has_places = len(self.connections) < self.settings.max_links
        memory_ns = self._limits_reached_at_ns.get(MEMORY, self.now_ns())
        is_calm = self.now_ns() - memory_ns > seconds_to_ns(self.settings.limit_alarm_s)
        for limit, is_over in ((PLACES, has_places), (MEMORY, is_calm)):
            if is_over and self._limits_reached_at_ns.pop(limit, None) is not None:
                self.handle(LinkLimitReached(limit, None))

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
        self._check_limits()


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
        self._is_lost = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin a session, or refuse the connection when there are too many."""
        self._transport = cast(asyncio.Transport, transport)
        address = _address(self._transport.get_extra_info("peername"))
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
        self.server.connections[link_id] = self
        self.server.handle(LinkOpened(link_id, address))

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
        with self._isolated():
            self._receive(nbytes)

    def _receive(self, nbytes: int) -> None:
        if self.session is None:
            return
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
        self.server.ending.add(self)
        self._closing_reason = self._closing_reason or _reason(exc)
        self._is_lost = True
        with self._isolated():
            self._events.extend(self.session.end_stream())
        self._end(self.session)

    def _end(self, session: Session) -> None:
        """Handle some of the last events; with more left, go on in the loop's next turn."""
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
        self.server.note_buffered(self, 0)
        self.server.ending.discard(self)
        self.server.handle(LinkClosed(session.link_id, reason))
        if self.server.capture is not None:
            self.server.capture.end_link(session.link_id)

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
            self._tick()

    def _tick(self) -> None:
        if self.session is None or self._transport is None:
            return
        now_ns = self.server.now_ns()
        self.session.note_socket(self._is_clear(), now_ns)
        self._take(self.session.tick(now_ns, has_unread=self._has_unread(self.session)))
        self.pump()
        self._check_session(self.session)

    def pump(self) -> None:
        """Write packets that may go, each by itself, while the socket takes them."""
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
        unread = fcntl.ioctl(sock.fileno(), termios.FIONREAD, bytes(4))
        return int.from_bytes(unread, sys.byteorder) > 0

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
        if self.session is None or self._is_lost:
            return
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
