"""Runs simulated apps on real TCP connections, until cancelled.

Each app has a task that connects, reconnects with a growing delay, and serves: it reads what the
app accepts, sends what is due, and starts a thread for each frame to render. Faults that need the
socket (`LinkOrder`) are carried out here.
"""

import asyncio
import contextlib
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from typing import Any

from recon.model.errors import ReconError
from recon.model.units import NS_PER_S
from recon.sim.app.app import MAIN_LINK, LinkOrder, LinkOrderKind, SimulatedApp
from recon.sim.app.camera_feed import Shot
from recon.sim.closing import close
from recon.sim.fleet import SimulationConfig, build_fleet

SECOND_LINK = 1
STICK = "stick"
"""What the app reports of a stick command it flies."""
READ_BYTES = 65_536
FIRST_BACKOFF_S = 0.2
LONGEST_BACKOFF_S = 2.0
LONGEST_WAIT_S = 0.1
WRITE_BUFFER_BYTES = 8 * 1024 * 1024
"""Unsent bytes; beyond this a station that does not read gets no more packets until it reads."""

Say = Callable[[str], None]


async def run_fleet(
    config: SimulationConfig, say: Say = print, start_ns: int | None = None
) -> None:
    """Fly the fleet until the task is cancelled; `say` gets one line per event.

    The world's time is zero at `start_ns` of the computer's monotonic clock; None: now.

    Raises `SimulationError` for an invalid configuration. A station that is not running, or goes
    away, is no error: each app reconnects.
    """
    start_ns = time.monotonic_ns() if start_ns is None else start_ns
    apps = build_fleet(config, start_ns, renders_inline=False)
    serials = ", ".join(app.settings.serial for app in apps)
    say(f"simulating {serials} for the station at {config.station_host}:{config.station_port}")
    async with asyncio.TaskGroup() as group:
        for app in apps:
            group.create_task(_AppShell(app, config.station_host, config.station_port, say).run())


@dataclass(slots=True)
class _AppShell:
    """One app's connections, and the threads that render its frames."""

    app: SimulatedApp
    host: str
    port: int
    say: Say
    _side_tasks: set[asyncio.Task[None]] = field(default_factory=set)
    _newest_line: str = ""

    async def run(self) -> None:
        """Connect, serve, and connect again."""
        backoff_s = FIRST_BACKOFF_S
        if self.app.feed is not None:
            await asyncio.to_thread(self.app.feed.source.prepare)
        try:
            while True:
                try:
                    reader, writer = await asyncio.open_connection(self.host, self.port)
                except OSError as problem:
                    if backoff_s == FIRST_BACKOFF_S:
                        self._log(f"no station at {self.host}:{self.port} ({problem}), retrying")
                    await asyncio.sleep(backoff_s)
                    backoff_s = min(2.0 * backoff_s, LONGEST_BACKOFF_S)
                    continue
                backoff_s = FIRST_BACKOFF_S
                await self._serve_main(reader, writer)
        finally:
            for task in tuple(self._side_tasks):
                task.cancel()
            await asyncio.gather(*self._side_tasks, return_exceptions=True)

    async def _serve_main(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._log(f"connected to {self.host}:{self.port}")
        order = None
        try:
            order = await self._serve(reader, writer, MAIN_LINK)
        finally:
            self.app.disconnected(MAIN_LINK)
            # Kept open by a task of its own, so that the app reconnects at once.
            if order is not None and order.kind is LinkOrderKind.ABANDON:
                self._start(_hold_open(writer, order.seconds))
            else:
                await close(writer)
        if order is not None and order.kind is LinkOrderKind.RECONNECT:
            await asyncio.sleep(order.seconds)
        elif order is None:
            self._log("connection lost")
            await asyncio.sleep(FIRST_BACKOFF_S)

    async def _serve(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, link: int
    ) -> LinkOrder | None:
        """Read and write until the connection ends (None) or a fault requires an action on it."""
        writer.transport.set_write_buffer_limits(high=WRITE_BUFFER_BYTES)
        self.app.connected(time.monotonic_ns(), link)
        # One pending read is kept across loops: cancelling a StreamReader.read may lose bytes.
        receiving: asyncio.Future[bytes] | None = None
        try:
            while True:
                order = self._send_due(writer, link)
                if order is not None:
                    return order
                if receiving is None and self.app.takes_more(link):
                    receiving = asyncio.ensure_future(reader.read(READ_BYTES))
                data = await self._wait_for(receiving)
                if data is None:
                    continue
                receiving = None
                if not data:
                    return None
                self.app.receive(data, time.monotonic_ns(), link)
        except OSError:
            return None
        finally:
            if receiving is not None:
                receiving.cancel()
                with contextlib.suppress(asyncio.CancelledError, OSError):
                    await receiving

    async def _wait_for(self, receiving: "asyncio.Future[bytes] | None") -> bytes | None:
        """Return the bytes read, or None when a packet is due first."""
        if receiving is None:
            await asyncio.sleep(self._pause_s())
            return None
        await asyncio.wait({receiving}, timeout=self._pause_s())
        return receiving.result() if receiving.done() else None

    def _send_due(self, writer: asyncio.StreamWriter, link: int) -> LinkOrder | None:
        """Write what is due, one packet per send; return the action a fault requires, if any.

        One packet per send, because some stations take a read for a packet.
        """
        packets = self.app.advance(time.monotonic_ns(), link)
        # `advance` was called all the same: time continues for an app whose packets are dropped.
        if writer.transport.get_write_buffer_size() < WRITE_BUFFER_BYTES:
            for packet in packets:
                writer.write(packet)
        for line in self.app.take_log():
            self._log(line)
        for shot in self.app.take_shots():
            self._start(self._render(shot))
        if link != MAIN_LINK:
            return None
        for order in self.app.take_link_orders():
            if order.kind is not LinkOrderKind.SECOND:
                return order
            self._start(self._serve_second(order.seconds))
        return None

    def _pause_s(self) -> float:
        due_s = (self.app.next_due_ns - time.monotonic_ns()) / NS_PER_S
        return min(max(0.0, due_s), LONGEST_WAIT_S)

    async def _render(self, shot: Shot) -> None:
        try:
            packet = await asyncio.to_thread(shot.packet)
        except ReconError as problem:
            self._log(f"frame lost: {problem}")
            self.app.add_image(shot, None)
        else:
            self.app.add_image(shot, packet)

    async def _serve_second(self, seconds: float) -> None:
        try:
            reader, writer = await asyncio.open_connection(self.host, self.port)
        except OSError as problem:
            self._log(f"no second connection ({problem})")
            return
        self._log("second connection with the same serial")
        try:
            async with asyncio.timeout(seconds):
                await self._serve(reader, writer, SECOND_LINK)
        except TimeoutError:
            self._log("second connection closed")
        finally:
            self.app.disconnected(SECOND_LINK)
            await close(writer)

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._side_tasks.add(task)
        task.add_done_callback(self._side_tasks.discard)

    def _log(self, line: str) -> None:
        """Say a line; of ten stick commands a second only the first one."""
        if line != STICK or self._newest_line != STICK:
            self.say(f"{self.app.settings.serial}: {line}")
        self._newest_line = line


async def _hold_open(writer: asyncio.StreamWriter, seconds: float) -> None:
    """Keep a socket open without reading from it or writing to it, then close it.

    The stream's own small buffer fills, then TCP flow control stops the peer.
    """
    try:
        await asyncio.sleep(seconds)
    finally:
        await close(writer)
