"""A bare station: the wire alone, with the time of each packet, which the real one would hide."""

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

from tests.android.processes import PATIENCE_S

from recon import wire

Received = tuple[float, wire.Packet]


@dataclass(slots=True)
class BareLink:
    """One connection of an app."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    opened_s: float = field(default_factory=time.monotonic)
    _deframer: wire.Deframer = field(default_factory=wire.Deframer)
    _waiting: list[Received] = field(default_factory=list)

    def send(self, packet: wire.Packet) -> float:
        """Send a packet; return the time."""
        self.writer.write(wire.encode(packet))
        return time.monotonic()

    async def next(self, is_wanted: Callable[[wire.Packet], bool] = lambda _: True) -> Received:
        """Return the next packet that is wanted, and its time; others are dropped."""
        async with asyncio.timeout(PATIENCE_S):
            while True:
                while self._waiting:
                    received = self._waiting.pop(0)
                    if is_wanted(received[1]):
                        return received
                data = await self.reader.read(65_536)
                assert data, "closed by the app"
                now_s = time.monotonic()
                packets = self._deframer.feed(data, time.monotonic_ns())
                self._waiting += [(now_s, packet) for packet in packets]

    async def core(self) -> tuple[float, wire.CoreTelemetry]:
        """Return the next core telemetry and its time."""
        at_s, packet = await self.next(lambda packet: isinstance(packet, wire.CoreTelemetry))
        assert isinstance(packet, wire.CoreTelemetry)
        return at_s, packet

    async def close(self) -> None:
        """Close the connection."""
        self.writer.close()
        with contextlib.suppress(OSError):
            await self.writer.wait_closed()


class BareStation:
    """Accepts apps, one after the other."""

    def __init__(self) -> None:
        self.port = 0
        self._links: asyncio.Queue[BareLink] = asyncio.Queue()
        self._opened: list[BareLink] = []

    async def link(self) -> BareLink:
        """Return the next connection."""
        return await asyncio.wait_for(self._links.get(), PATIENCE_S)

    def put_back(self, link: BareLink) -> None:
        """Have `link` return this connection next."""
        self._links.put_nowait(link)

    async def accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Take a connection that was opened."""
        link = BareLink(reader, writer)
        self._opened.append(link)
        self._links.put_nowait(link)

    async def close_all(self) -> None:
        """Close every connection."""
        for link in self._opened:
            await link.close()


@asynccontextmanager
async def bare_station() -> AsyncIterator[BareStation]:
    """Listen on a port that the system chooses."""
    bare = BareStation()
    server = await asyncio.start_server(bare.accept, "127.0.0.1", 0)
    bare.port = server.sockets[0].getsockname()[1]
    try:
        yield bare
    finally:
        server.close()
        await bare.close_all()
