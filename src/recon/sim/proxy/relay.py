"""The proxy's sockets: listen for apps, connect each to the station, and relay bytes.

Theory of operation
-------------------
Each accepted connection gets one of its own to the station, and two pumps, one per direction. A
pump reads while its `Channel` has room, and writes pieces when they are due; delay, rate, stalls
and changed bytes are all decided in the channel, which is pure and seeded. Without room the pump
does not read, so TCP flow control reaches the sender, as on a real slow link.

A connection ends in one of three ways. An orderly end of one side is passed on after the bytes
before it (half close). An error on one side, or a drawn reset, ends both sides with RST, as a lost
link does. When the station does not answer within `STATION_ANSWERS_WITHIN_S`, the app gets RST.
"""

import asyncio
import contextlib
import socket
import struct
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from random import Random

from recon.model.units import NS_PER_S
from recon.sim.closing import close
from recon.sim.errors import SimulationError
from recon.sim.proxy.damage import Channel, Damage

READ_BYTES = 65_536
MOST_CONNECTIONS = 64
STATION_ANSWERS_WITHIN_S = 5.0
RESET_ON_CLOSE = struct.pack("ii", 1, 0)
"""SO_LINGER on with 0 s: closing sends RST and discards unsent bytes."""

Say = Callable[[str], None]
Place = tuple[str, int]


class Towards(Enum):
    """Which direction is damaged; a reset always ends both."""

    BOTH = "both"
    STATION = "station"
    APP = "app"


@dataclass(frozen=True, slots=True, kw_only=True)
class ProxyConfig:
    """Where the proxy listens, where the station is, and the damage."""

    listen: Place
    station: Place
    damage: Damage = field(default_factory=Damage)
    towards: Towards = Towards.BOTH
    seed: int = 0

    def damage_towards(self, direction: Towards) -> Damage:
        """Return the damage to bytes in a direction."""
        return self.damage if self.towards in (Towards.BOTH, direction) else Damage()


async def run_proxy(
    config: ProxyConfig, say: Say = print, started: Callable[[int], None] | None = None
) -> None:
    """Relay bytes until the task is cancelled; then close every connection.

    `started` gets the port. Raises `SimulationError` when it cannot listen. A station that is not
    running is no error: the app's connection is reset, as without a proxy.
    """
    relay = _Relay(config, say)
    host, port = config.listen
    try:
        server = await asyncio.start_server(relay.serve, host, port, limit=READ_BYTES)
    except OSError as problem:
        raise SimulationError(
            f"--listen: expected a free address, got {host}:{port} ({problem.strerror})"
        ) from None
    port = server.sockets[0].getsockname()[1]
    say(f"listening on {host}:{port} for the station at {config.station[0]}:{config.station[1]}")
    if started is not None:
        started(port)
    try:
        await asyncio.Event().wait()
    finally:
        server.close()
        await relay.end()


@dataclass(slots=True)
class _Relay:
    """The open connections."""

    config: ProxyConfig
    say: Say
    _tasks: set[asyncio.Task[None]] = field(default_factory=set)
    _count: int = 0

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve one app until its connection ends, either way."""
        self._count += 1
        number = self._count
        # Bounded: each connection may hold up to 8 MiB.
        if len(self._tasks) >= MOST_CONNECTIONS:
            self.say(f"connection {number}: refused, {MOST_CONNECTIONS} are open")
            _reset(writer)
            return
        task = asyncio.ensure_future(self._relay(number, reader, writer))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        with contextlib.suppress(asyncio.CancelledError):
            await task

    async def end(self) -> None:
        """Close every connection."""
        for task in tuple(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _relay(
        self, number: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        host, port = self.config.station
        try:
            async with asyncio.timeout(STATION_ANSWERS_WITHIN_S):
                theirs = await asyncio.open_connection(host, port, limit=READ_BYTES)
        except OSError as problem:
            self.say(f"connection {number}: no station at {host}:{port} ({problem})")
            _reset(writer)
            return
        except asyncio.CancelledError:
            _reset(writer)
            raise
        self.say(f"connection {number}: open")
        connection = _Connection(self.config, number, (reader, writer), theirs)
        self.say(f"connection {number}: {await connection.run()}")


@dataclass(slots=True)
class _Connection:
    """An app's connection paired with its connection to the station."""

    config: ProxyConfig
    number: int
    app: tuple[asyncio.StreamReader, asyncio.StreamWriter]
    station: tuple[asyncio.StreamReader, asyncio.StreamWriter]

    async def run(self) -> str:
        """Relay until the connection ends; return how it ended, for the log."""
        random = Random(f"{self.config.seed}/{self.number}/reset")
        after_s = self.config.damage.reset_after_s(random)
        up = self._pump(Towards.STATION, self.app[0], self.station[1])
        down = self._pump(Towards.APP, self.station[0], self.app[1])
        try:
            async with asyncio.timeout(after_s if after_s < float("inf") else None):
                await _both(up, down)
        except TimeoutError:
            self._reset()
            return f"reset after {after_s:.1f} s"
        except OSError as problem:
            self._reset()
            return f"broken by one side ({problem})"
        finally:
            await asyncio.gather(close(self.app[1]), close(self.station[1]))
        return f"closed, {up.passed_bytes} bytes towards the station, {down.passed_bytes} back"

    def _pump(
        self, to: Towards, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> "_Pump":
        seed = f"{self.config.seed}/{self.number}/{to.value}"
        channel = Channel(self.config.damage_towards(to), seed, time.monotonic_ns())
        return _Pump(reader, writer, channel)

    def _reset(self) -> None:
        _reset(self.app[1])
        _reset(self.station[1])


@dataclass(slots=True)
class _Pump:
    """Reads from one end while the channel has room, writes to the other what is due."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    channel: Channel
    passed_bytes: int = 0

    async def run(self) -> None:
        """Run until the reader's end was passed on; raises `OSError` when a side breaks."""
        reading: asyncio.Future[bytes] | None = asyncio.ensure_future(self._read())
        is_ended = False
        try:
            while not is_ended or self.channel.next_due_ns is not None:
                if reading is None and not is_ended and self.channel.has_room:
                    reading = asyncio.ensure_future(self._read())
                await self._wait(reading)
                if reading is not None and reading.done():
                    is_ended = self._take(reading.result())
                    reading = None
                await self._write_due()
        finally:
            await _end_reading(reading)
        # Half close: the other direction may still carry bytes.
        if self.writer.can_write_eof():
            self.writer.write_eof()

    async def _read(self) -> bytes:
        return await self.reader.read(READ_BYTES)

    def _take(self, data: bytes) -> bool:
        """Push bytes read into the channel; return whether it was the end of the stream."""
        if data:
            self.channel.push(data, time.monotonic_ns())
        return not data

    async def _wait(self, reading: "asyncio.Future[bytes] | None") -> None:
        """Wait until bytes are read or the next piece is due."""
        due_ns = self.channel.next_due_ns
        pause_s = None if due_ns is None else max(0.0, (due_ns - time.monotonic_ns()) / NS_PER_S)
        if reading is not None:
            await asyncio.wait({reading}, timeout=pause_s)
        elif pause_s is not None:
            await asyncio.sleep(pause_s)

    async def _write_due(self) -> None:
        for piece in self.channel.pop_due(time.monotonic_ns()):
            self.writer.write(piece)
            self.passed_bytes += len(piece)
            # Without drain a slow receiver would fill memory instead of the channel.
            await self.writer.drain()


async def _both(up: _Pump, down: _Pump) -> None:
    """Run both directions to their ends; an error in one cancels the other."""
    tasks = [asyncio.ensure_future(up.run()), asyncio.ensure_future(down.run())]
    try:
        await asyncio.gather(*tasks)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _end_reading(reading: "asyncio.Future[bytes] | None") -> None:
    if reading is None:
        return
    reading.cancel()
    with contextlib.suppress(asyncio.CancelledError, OSError):
        await reading


def _reset(writer: asyncio.StreamWriter) -> None:
    """End a connection with RST: the peer reads an error, not an end of stream."""
    raw = writer.get_extra_info("socket")
    if raw is not None:
        with contextlib.suppress(OSError):
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET_ON_CLOSE)
    writer.transport.abort()
