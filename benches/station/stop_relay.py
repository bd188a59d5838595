"""A prototype: a process between the apps and the station that can stop vehicles by itself.

    python -m benches.station.stop_relay STATION_PORT

Every connection of an app is passed on to the station, byte for byte in both directions. The relay
reads the apps' telemetry along the way; so it knows who flies. A line on its stop port makes it
write a hover to each of them at once, whatever the station does. Prints its two ports; ends with
its input. It measures what a process of its own for stops costs and buys
(docs/decisions); it judges nothing, and is no part of Recon.
"""

import asyncio
import sys
from typing import cast

import uvloop

from recon import wire

HOVER = wire.encode(wire.EmergencyCommand(action=0))
LARGE_BYTES = 4 * 1024 * 1024
"""So much may wait for one side before the other is not read."""


class _End(asyncio.Protocol):
    """One of the two ends of a relayed connection."""

    def __init__(self) -> None:
        self.transport: asyncio.Transport | None = None
        self.other: _End | None = None
        self._waiting: list[bytes] = []

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)
        self.transport.set_write_buffer_limits(high=LARGE_BYTES)
        for data in self._waiting:
            self.transport.write(data)
        self._waiting.clear()

    def data_received(self, data: bytes) -> None:
        if self.other is not None:
            self.other.pass_on(data)

    def pass_on(self, data: bytes) -> None:
        """Write what the other end received."""
        if self.transport is None:
            self._waiting.append(data)
        else:
            self.transport.write(data)

    def pause_writing(self) -> None:
        if self.other is not None and self.other.transport is not None:
            self.other.transport.pause_reading()

    def resume_writing(self) -> None:
        if self.other is not None and self.other.transport is not None:
            self.other.transport.resume_reading()

    def connection_lost(self, _exc: Exception | None) -> None:
        other, self.other = self.other, None
        if other is not None and other.transport is not None:
            other.transport.close()


class AppEnd(_End):
    """The end to an app; knows whether its vehicle flies."""

    def __init__(self, relay: "Relay") -> None:
        super().__init__()
        self.relay = relay
        self.is_flying = False
        self._deframer = wire.Deframer()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self.relay.app_ends.add(self)
        self.other = station_end = _End()
        station_end.other = self
        connecting = asyncio.get_running_loop().create_connection(
            lambda: station_end, "127.0.0.1", self.relay.station_port
        )
        self.relay.tasks.add(task := asyncio.ensure_future(connecting))
        task.add_done_callback(self.relay.tasks.discard)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        for packet in self._deframer.feed(data):
            if isinstance(packet, wire.CoreTelemetry):
                self.is_flying = packet.is_flying != 0

    def connection_lost(self, exc: Exception | None) -> None:
        self.relay.app_ends.discard(self)
        super().connection_lost(exc)


class StopEnd(asyncio.Protocol):
    """A connection to the stop port."""

    def __init__(self, relay: "Relay") -> None:
        self.relay = relay
        self.transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)

    def data_received(self, data: bytes) -> None:
        count = 0
        for end in self.relay.app_ends:
            if end.is_flying and end.transport is not None:
                end.transport.write(HOVER)
                count += 1
        assert self.transport is not None
        self.transport.write(f"{count}\n".encode())


class Relay:
    """All connections."""

    def __init__(self, station_port: int) -> None:
        self.station_port = station_port
        self.app_ends: set[AppEnd] = set()
        self.tasks: set[asyncio.Future[object]] = set()

    async def run(self) -> None:
        """Serve until the input ends."""
        loop = asyncio.get_running_loop()
        apps = await loop.create_server(lambda: AppEnd(self), "127.0.0.1", 0)
        stops = await loop.create_server(lambda: StopEnd(self), "127.0.0.1", 0)
        ports = [server.sockets[0].getsockname()[1] for server in (apps, stops)]
        print(*ports, flush=True)
        await loop.run_in_executor(None, sys.stdin.read)


if __name__ == "__main__":
    uvloop.run(Relay(int(sys.argv[1])).run())
