"""A link server on loopback, with all its events recorded."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import TypeVar

import uvloop

from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.link.tap import Tap
from recon.model.event import Event, LinkClosed, LinkOpened, PacketReceived
from recon.model.report import Report

PATIENCE_S = 120.0
POLL_S = 0.01

E = TypeVar("E")

LOOPS: dict[str, Callable[[], asyncio.AbstractEventLoop]] = {
    "asyncio": asyncio.new_event_loop,
    "uvloop": uvloop.new_event_loop,
}


def run_on(loop: str, main: Callable[[], Awaitable[None]]) -> None:
    """Run a test's coroutine on one kind of event loop."""

    async def guarded() -> None:
        async with asyncio.timeout(3 * PATIENCE_S):
            await main()

    with asyncio.Runner(loop_factory=LOOPS[loop]) as runner:
        runner.run(guarded())


class Listening:
    """A server whose events are kept; `react` may act on each, as the station does."""

    def __init__(self, settings: LinkSettings, tap: Tap | None = None) -> None:
        self.events: list[Event] = []
        self.times_ns: list[int] = []
        self.react: Callable[[Event], None] = lambda event: None
        self.server = LinkServer(self._handle, self._now_ns, settings, tap)
        self._changed = asyncio.Event()
        self._ahead_ns = 0

    def of(self, kind: type[E]) -> list[E]:
        return [event for event in self.events if isinstance(event, kind)]

    def reports(self, link_id: int) -> list[Report]:
        return [e.report for e in self.of(PacketReceived) if e.link_id == link_id]

    def closed_reason(self, link_id: int) -> str | None:
        return next((e.reason for e in self.of(LinkClosed) if e.link_id == link_id), None)

    async def until(self, is_reached: Callable[[], bool], patience_s: float = PATIENCE_S) -> None:
        """Wait for something to happen, letting the server's time pass meanwhile."""
        async with asyncio.timeout(patience_s):
            while not is_reached():
                self.server.tick()
                self._changed.clear()
                try:
                    async with asyncio.timeout(POLL_S):
                        await self._changed.wait()
                except TimeoutError:
                    continue

    def skip(self, seconds: float) -> None:
        """Let this much of the server's time pass at once, however busy the machine is."""
        self._ahead_ns += round(seconds * 1e9)

    async def connect(self) -> tuple[int, asyncio.StreamReader, asyncio.StreamWriter]:
        """Connect an app; return its link's id too."""
        known = len(self.of(LinkOpened))
        reader, writer = await asyncio.open_connection("127.0.0.1", self.server.port)
        await self.until(lambda: len(self.of(LinkOpened)) > known)
        return self.of(LinkOpened)[known].link_id, reader, writer

    def _now_ns(self) -> int:
        return time.monotonic_ns() + self._ahead_ns

    def _handle(self, event: Event) -> None:
        self.events.append(event)
        self.times_ns.append(self._now_ns())
        self._changed.set()
        self.react(event)


@asynccontextmanager
async def listening(
    settings: LinkSettings | None = None, tap: Tap | None = None
) -> AsyncIterator[Listening]:
    """Listen on a free port; nothing stays open afterwards."""
    station = Listening(settings or LinkSettings(), tap)
    await station.server.start("127.0.0.1", 0)
    try:
        yield station
    finally:
        await station.server.stop()
        await station.until(lambda: not station.server.connections)


async def close(*writers: asyncio.StreamWriter) -> None:
    """Close apps' sockets, whatever state they are in."""
    for writer in writers:
        writer.close()
        try:
            await writer.wait_closed()
        except OSError:
            continue
