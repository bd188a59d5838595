"""The TCP server for companion apps: the open connections, and what they share.

Beyond `max_links` a connection takes the place of an unidentified link without telemetry, or is
refused. What else all links share is in `shared_limits`; `connection` is one app's socket.
"""

import asyncio
from collections.abc import Callable
from typing import Any, Protocol

from recon.link.connection import Connection, address_text
from recon.link.session import Objection, Session, no_objection
from recon.link.settings import LinkSettings
from recon.link.shared_limits import MEMORY, PLACES, BufferBudget, LimitAlarms
from recon.link.tap import Tap
from recon.model.event import Event, LinkClosed
from recon.safety import ApprovedCommand

HandleEvent = Callable[[Event], None]
Clock = Callable[[], int]


class SocketWatch(Protocol):
    """Takes a duplicate of each connection's socket: the station's guard."""

    def opened(self, link_id: int, sock: Any) -> None:
        """Take an open connection; `sock` is closed with it."""
        ...

    def closed(self, link_id: int) -> None:
        """A connection is over."""
        ...


class LinkServer:
    """Listens for apps; hands every event to `handle` in the order it happened."""

    def __init__(
        self,
        handle: HandleEvent,
        now_ns: Clock,
        settings: LinkSettings,
        tap: Tap | None = None,
    ) -> None:
        self.handle = handle
        self.now_ns = now_ns
        self.settings = settings
        self.tap = tap
        self.objection: Objection = no_objection
        """Judges an order again at the moment of sending."""
        self.watch: SocketWatch | None = None
        self.connections: dict[int, Connection] = {}
        self.refused_connections = 0
        self.ended: dict[int, Session] = {}
        """The latest sessions that are over, for their counters."""
        self.unfinished: dict[int, Connection] = {}
        """Connections whose bytes are not all searched yet, open and closed ones."""
        self._budget = BufferBudget(settings.buffer_budget_bytes, settings.max_links)
        self._alarms = LimitAlarms(settings.limit_alarm_s)
        self._next_link_id = 1
        self._server: asyncio.Server | None = None

    async def start(self, host: str, port: int) -> list[str]:
        """Begin to listen; return the addresses. Raises OSError when the port is taken."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(lambda: Connection(self), host, port, backlog=256)
        return [address_text(s.getsockname()) for s in self._server.sockets]

    @property
    def port(self) -> int:
        """The port it listens on; 0 before it does."""
        sockets = () if self._server is None else self._server.sockets
        return int(sockets[0].getsockname()[1]) if sockets else 0

    @property
    def hosts(self) -> list[str]:
        """The IP addresses it listens on."""
        return [] if self._server is None else [s.getsockname()[0] for s in self._server.sockets]

    async def stop(self) -> None:
        """Close the listening socket and every connection."""
        if self._server is not None:
            self._server.close()
        for connection in tuple(self.connections.values()):
            connection.close("the station stops")
        await asyncio.sleep(0)
        while self.unfinished:
            await asyncio.sleep(0)

    def sessions(self) -> dict[int, Session]:
        """Return the open sessions and the recently ended ones, by link."""
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
        self._reach(
            PLACES,
            f"connection from {address} refused: {self.settings.max_links} apps are connected, "
            f"limit {self.settings.max_links}: close the apps that are not needed",
        )

    def note_buffered(self, connection: Connection, buffered_bytes: int) -> None:
        """Account for the memory of a connection's half-received packet."""
        self._budget.note(connection.link_id, buffered_bytes)
        while (over := self._budget.to_free(self._is_identified)) is not None:
            self._budget.note(over.link_id, 0)
            self._reach(MEMORY, over.problem)
            self.unfinished[over.link_id].free_memory(over.reason)

    def ended_with(self, connection: Connection, reason: str) -> None:
        """Report the end of a link whose last bytes are searched."""
        self.note_buffered(connection, 0)
        del self.unfinished[connection.link_id]
        self.handle(LinkClosed(connection.link_id, reason))

    def _is_identified(self, link_id: int) -> bool:
        return self.unfinished[link_id].is_identified

    def _reach(self, limit: str, problem: str) -> None:
        event = self._alarms.reached(limit, problem, self.now_ns())
        if event is not None:
            self.handle(event)

    def _check_limits(self) -> None:
        has_places = len(self.connections) < self.settings.max_links
        for event in self._alarms.over(self.now_ns(), has_places=has_places):
            self.handle(event)

    def add(self, connection: Connection) -> None:
        """Add a new connection to the open ones."""
        self.connections[connection.link_id] = connection
        self.unfinished[connection.link_id] = connection
        if self.watch is not None:
            self.watch.opened(connection.link_id, connection.socket)

    def forget(self, session: Session) -> None:
        """Remove an ended session from the open ones; drop the oldest ended one."""
        self.connections.pop(session.link_id, None)
        self.ended[session.link_id] = session
        if self.watch is not None:
            self.watch.closed(session.link_id)
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
