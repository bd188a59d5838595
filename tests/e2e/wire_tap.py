"""A relay between apps and a station that counts what goes to each app; both ends are real sockets.

It outlives the station: while there is none, apps are turned away, as by a closed port.
"""

import asyncio
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from recon import wire

READ_BYTES = 65_536


@dataclass(slots=True)
class WireTap:
    """Commands that went to the apps, by packet and by the serial of the app's link."""

    station_port: int
    port: int = 0
    sent: Counter[tuple[str, str]] = field(default_factory=Counter)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def take(self) -> Counter[tuple[str, str]]:
        """Return what was counted since the last call: (serial, packet) to how many."""
        with self._lock:
            taken, self.sent = self.sent, Counter()
        return taken

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            to_station = await asyncio.open_connection("127.0.0.1", self.station_port)
        except OSError:
            writer.close()
            return
        link = _Link(self)
        up = asyncio.create_task(_relay(reader, to_station[1], link.from_app))
        down = asyncio.create_task(_relay(to_station[0], writer, link.to_app))
        await asyncio.wait((up, down), return_when=asyncio.FIRST_COMPLETED)
        for task in (up, down):
            task.cancel()
        for end in (writer, to_station[1]):
            end.close()
            with suppress(OSError):
                await end.wait_closed()

    def count(self, serial: str, packet: wire.Packet) -> None:
        with self._lock:
            self.sent[serial, type(packet).__name__] += 1


class _Link:
    """One connection's streams, read on the way."""

    def __init__(self, tap: WireTap) -> None:
        self._tap = tap
        self._serial = "unknown"
        self._up, self._down = wire.Deframer(), wire.Deframer()

    def from_app(self, data: bytes) -> None:
        for packet in self._up.feed(data):
            if isinstance(packet, wire.ExtendedTelemetry):
                self._serial = packet.serial.decode()

    def to_app(self, data: bytes) -> None:
        for packet in self._down.feed(data):
            self._tap.count(self._serial, packet)


async def _relay(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, look: object) -> None:
    assert callable(look)
    with suppress(OSError):
        while data := await reader.read(READ_BYTES):
            look(data)
            writer.write(data)
            await writer.drain()


@contextmanager
def tapped(station_port: int) -> Iterator[WireTap]:
    """Relay on a free port, on a thread with a loop of its own."""
    tap, ready = WireTap(station_port), threading.Event()
    loop = asyncio.new_event_loop()
    ending = asyncio.Event()

    async def main() -> None:
        server = await asyncio.start_server(tap.serve, "127.0.0.1", 0)
        tap.port = server.sockets[0].getsockname()[1]
        ready.set()
        await ending.wait()
        server.close()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)

    thread = threading.Thread(target=lambda: loop.run_until_complete(main()))
    thread.start()
    assert ready.wait(20.0)
    try:
        yield tap
    finally:
        loop.call_soon_threadsafe(ending.set)
        thread.join()
        loop.close()
