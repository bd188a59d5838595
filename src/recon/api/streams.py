"""The WebSocket streams: states to consoles and clients, and audit entries.

States are conflated: a slow reader gets the newest state when it is ready, at most 10 Hz. The
server's send blocks while more than 64 KiB wait for the socket, whose buffer in the kernel is
bounded too, so a slow reader is sent little that is old; one that reads nothing loses its place
(`api/connections.py`). Audit entries are not conflated: a slow reader holds one page and gets the
rest as it reads; one that falls behind what the station keeps in memory sees a gap in the numbers
(`first_n`).

A reader that asks for it (`changes=2`) gets the first state whole, and then what has changed since
the last one it was sent (`api/state_changes.py`). A page of an older console, which asks for
another format of changes, gets whole states.

An owner is an open state stream that steered orders depend on (`/api/stream?owner=NAME`). It sends
a keepalive, any text, at least twice a second. When its connection closes, or no message arrives
for `SILENT_S` (a computer that sleeps, a program that hangs), its steered orders end: the vehicles
stop and hold. A name belongs to one stream at a time, and a client draws a new one for each
connection, so an ended order never resumes.
"""

import asyncio
import string
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.api.schema import AuditPage, StationState
from recon.api.security import (
    POLICY_VIOLATION,
    TRY_AGAIN_LATER,
    accept_stream,
    person_of,
    refuse_stream,
)
from recon.api.state_changes import change_text
from recon.model.event import (
    Event,
    OwnerConnected,
    OwnerDisconnected,
    PersonConnected,
    PersonDisconnected,
)
from recon.model.person import Role

CHANGES = "2"
"""The format of changes."""

INTERVAL_S = 0.1
MAX_STATE_READERS = 32
MAX_AUDIT_READERS = 16
MAX_ENTRIES = 100
"""Audit entries in one message; with the longest missions some 2 MiB."""

SILENT_S = 2.0
"""Four keepalives lost. A vehicle at 5 m/s has moved on by 10 m."""
OWNER_SILENT = 4008
"""Close code (private use, RFC 6455) for an owner that sent no keepalive in time."""
SHORTEST_NAME = 16
LONGEST_NAME = 64
_LETTERS = frozenset(string.ascii_letters + string.digits + "-_")


class Owners:
    """The names of the open owner streams."""

    def __init__(self, handle: Callable[[Event], None]) -> None:
        self._handle = handle
        self._names: set[str] = set()

    def fault(self, name: str | None) -> str | None:
        """Return why a stream cannot use this name, in one sentence; None when it can."""
        if name is None:
            return None
        if not SHORTEST_NAME <= len(name) <= LONGEST_NAME or not _LETTERS.issuperset(name):
            return (
                f"owner: name must be {SHORTEST_NAME} to {LONGEST_NAME} letters, digits, - or _; "
                f"got {len(name)} characters"
            )
        return f"owner: {name[:8]}... is in use by another stream" if name in self._names else None

    @asynccontextmanager
    async def open(self, name: str | None) -> AsyncIterator[None]:
        """Register an owner for as long as the block runs; do nothing without a name."""
        if name is None:
            yield
            return
        self._names.add(name)
        self._handle(OwnerConnected(name))
        try:
            yield
        finally:
            self._names.discard(name)
            self._handle(OwnerDisconnected(name))


class StateStream:
    """Serves all readers; those of one interval share one encoded state."""

    def __init__(
        self, make_state: Callable[[], StationState], handle: Callable[[Event], None]
    ) -> None:
        self._make_state = make_state
        self._handle = handle
        self._state: StationState | None = None
        self._text: str | None = None
        self._change: tuple[StationState, str] | None = None
        self._made_at_s = float("-inf")
        self._readers = 0
        self._owners = Owners(handle)

    async def serve(self, socket: WebSocket) -> None:
        """Send states to one reader until it disconnects."""
        if self._readers >= MAX_STATE_READERS:
            sentence = f"{MAX_STATE_READERS} readers are connected: limit reached"
            await refuse_stream(socket, TRY_AGAIN_LATER, sentence)
            return
        owner = socket.query_params.get("owner")
        fault = self._owners.fault(owner)
        if fault is not None:
            await refuse_stream(socket, POLICY_VIOLATION, fault)
            return
        self._readers += 1
        try:
            await accept_stream(socket)
            await self._send_until_gone(
                socket, owner, socket.query_params.get("changes") == CHANGES
            )
            if owner is not None:
                await socket.close(OWNER_SILENT, f"owner: no message for {SILENT_S:g} s")
        except (WebSocketDisconnect, RuntimeError):
            return
        finally:
            self._readers -= 1

    async def _send_until_gone(
        self, socket: WebSocket, owner: str | None, takes_changes: bool
    ) -> None:
        # Receiving is a task of its own: sending blocks while the reader takes nothing.
        gone = asyncio.ensure_future(self._listen(socket, owner))
        try:
            base: StationState | None = None
            while not gone.done():
                state = self._newest()
                text = self._whole(state) if base is None else self._since(base, state)
                await socket.send_text(text)
                base = state if takes_changes else None
                await asyncio.wait((gone,), timeout=INTERVAL_S)
        finally:
            gone.cancel()

    async def _listen(self, socket: WebSocket, owner: str | None) -> None:
        person = person_of(socket)
        self._handle(PersonConnected(person.name))
        try:
            if owner is None:
                await _until_gone(socket)
                return
            # An observer may command nothing: its open page is no operator who would act.
            counted = owner if person.role.includes(Role.PILOT) else None
            async with self._owners.open(counted):
                await _until_silent(socket)
        finally:
            self._handle(PersonDisconnected(person.name))

    def _newest(self) -> StationState:
        if self._state is None or time.monotonic() - self._made_at_s >= INTERVAL_S / 2:
            self._state, self._text, self._change = self._make_state(), None, None
            self._made_at_s = time.monotonic()
        return self._state

    def _whole(self, state: StationState) -> str:
        """Return the newest state as text, once for all readers."""
        if self._text is None:
            self._text = state.model_dump_json()
        return self._text

    def _since(self, base: StationState, state: StationState) -> str:
        """Return the change since a reader's last state, once for all that keep up."""
        if self._change is None or self._change[0] is not base:
            self._change = base, change_text(base, state)
        return self._change[1]


class AuditStream:
    """Sends every audit entry to every reader, in order, from a number on."""

    def __init__(self, page_after: Callable[[int, int], AuditPage]) -> None:
        """`page_after` returns the entries after a number, up to a limit."""
        self._page_after = page_after
        self._readers = 0

    async def serve(self, socket: WebSocket, after: int) -> None:
        """Send entries to one reader until it disconnects."""
        if self._readers >= MAX_AUDIT_READERS:
            sentence = f"{MAX_AUDIT_READERS} readers are connected: limit reached"
            await refuse_stream(socket, TRY_AGAIN_LATER, sentence)
            return
        self._readers += 1
        try:
            await accept_stream(socket)
            await self._send_until_gone(socket, after)
        except (WebSocketDisconnect, RuntimeError):
            return
        finally:
            self._readers -= 1

    async def _send_until_gone(self, socket: WebSocket, after: int) -> None:
        gone = asyncio.ensure_future(_until_gone(socket))
        try:
            while not gone.done():
                page = self._page_after(after, MAX_ENTRIES)
                if page.entries:
                    await socket.send_text(page.model_dump_json())
                    after = page.entries[-1].n
                if after >= page.last_n:
                    await asyncio.wait((gone,), timeout=INTERVAL_S)
        finally:
            gone.cancel()


async def _until_silent(socket: WebSocket) -> None:
    """Receive until an owner disconnects or sends nothing for `SILENT_S`."""
    try:
        while True:
            async with asyncio.timeout(SILENT_S):
                message = await socket.receive()
            if message["type"] == "websocket.disconnect":
                return
    except (TimeoutError, WebSocketDisconnect, RuntimeError):
        return


async def _until_gone(socket: WebSocket) -> None:
    """Receive and ignore messages until a reader disconnects."""
    try:
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
    except (WebSocketDisconnect, RuntimeError):
        return
