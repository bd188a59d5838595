"""The guard's process: the line to the station, duplicates of the apps' sockets, the stop port.

    python -m recon.guard.process LINE_FD STOP_FD CONSOLE_ORIGIN

`LINE_FD` is one end of a socket pair with the station, `STOP_FD` a listening socket on loopback.
It ends when the station ends in order, or, after the station's death, when every app has gone, the
next station asks it to give way, or half a minute is over.
"""

import asyncio
import signal
import socket
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from recon import wire
from recon.guard import messages, watch
from recon.guard.stop_port import StopPort
from recon.guard.watch import CoreRead, GuardEvent, GuardState, Intervention, LinkGone, StationEnded
from recon.model.event import AllStopped, Tick
from recon.model.report import CoreReport
from recon.safety import ApprovedCommand
from recon.vehicles.packets import to_packet
from recon.vehicles.reports import to_report

TICK_S = 0.05
ORPHAN_S = 30.0
"""Time after the station's death for a person to stop all here. Then the connections close, and the
apps know: what they do without a station is their own setting."""
READ_BYTES = 256 * 1024
MOST_SOCKETS = 16
"""Duplicates that may come with one read."""


class GuardProcess:
    """Carries out what `watch` decides."""

    def __init__(self, line: socket.socket, now_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self.state = GuardState()
        self.now_ns = now_ns
        self.is_over = asyncio.Event()
        self._line: socket.socket | None = line
        self._lines = messages.Lines()
        self._duplicates: list[int] = []
        self._apps: dict[int, socket.socket] = {}
        self._deframers: dict[int, wire.Deframer] = {}

    async def run(self) -> None:
        """Watch until there is nothing left to watch."""
        assert self._line is not None
        self._line.setblocking(False)
        asyncio.get_running_loop().add_reader(self._line, self._read_line)
        while not self.is_over.is_set():
            await asyncio.sleep(TICK_S)
            self._handle(Tick())

    def stop_all(self, by: str) -> Intervention:
        """Hold every vehicle that may fly, on a person's word; return what was done."""
        self._handle(AllStopped(by))
        return self.state.interventions[-1]

    def yield_to_next(self) -> tuple[Intervention, ...]:
        """End, because the next station starts; return what its operators must know."""
        self.is_over.set()
        return self.state.interventions

    @property
    def is_orphan(self) -> bool:
        """Whether the station has ended."""
        return self._line is None

    def _handle(self, event: GuardEvent) -> None:
        known = len(self.state.interventions)
        self.state, hovers = watch.step(self.state, event, self.now_ns())
        for hover in hovers:
            self._write(hover)
        for intervention in self.state.interventions[known:]:
            self._say(messages.intervention_line(intervention))

    def _write(self, approved: ApprovedCommand) -> None:
        """Write a hover past everything: its bytes are few, and the station's packets whole."""
        data = wire.encode(to_packet(approved.command.body, 0.0))
        for link_id in approved.link_ids:
            app = self._apps.get(link_id)
            if app is not None:
                with suppress(OSError):
                    app.send(data)

    def _say(self, line: bytes) -> None:
        if self._line is not None:
            with suppress(OSError):
                self._line.send(line)

    def _read_line(self) -> None:
        assert self._line is not None
        try:
            data, duplicates, _, _ = socket.recv_fds(self._line, READ_BYTES, MOST_SOCKETS)
        except BlockingIOError:
            return
        except OSError:
            data, duplicates = b"", []
        self._duplicates += duplicates
        if not data:
            self._station_ended()
            return
        for message in self._lines.feed(data):
            self._take(message)

    def _take(self, message: dict[str, Any]) -> None:
        match message["is"]:
            case messages.SOCKET:
                self._apps[message["link"]] = socket.socket(fileno=self._duplicates.pop(0))
            case messages.CLOSED:
                self._forget(message["link"])
            case messages.NOTED:
                self.state = watch.noted(self.state)
            case messages.PICTURE:
                self._handle(messages.picture_of(message, self.now_ns()))
                self._say(messages.alive_line())
            case messages.OVER:
                self.is_over.set()

    def _station_ended(self) -> None:
        assert self._line is not None
        loop = asyncio.get_running_loop()
        loop.remove_reader(self._line)
        self._line.close()
        self._line = None
        if self.is_over.is_set():
            return
        self._handle(StationEnded())
        for link_id, app in self._apps.items():
            self._deframers[link_id] = wire.Deframer()
            loop.add_reader(app, self._read_app, link_id)
        loop.call_later(ORPHAN_S, self.is_over.set)
        self._end_without_apps()

    def _read_app(self, link_id: int) -> None:
        """The station reads it no longer."""
        try:
            data = self._apps[link_id].recv(READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._forget(link_id)
            self._end_without_apps()
            return
        for packet in self._deframers[link_id].feed(data):
            report = to_report(packet)
            if isinstance(report, CoreReport):
                self._handle(CoreRead(link_id, report))

    def _forget(self, link_id: int) -> None:
        app = self._apps.pop(link_id, None)
        if app is not None:
            asyncio.get_running_loop().remove_reader(app)
            app.close()
        self._handle(LinkGone(link_id))

    def _end_without_apps(self) -> None:
        if not self._apps:
            self.is_over.set()


async def serve(line_fd: int, stop_fd: int, console_origin: str) -> None:
    """Run the guard with its stop port."""
    guard = GuardProcess(socket.socket(fileno=line_fd))
    stops = socket.socket(fileno=stop_fd)
    loop = asyncio.get_running_loop()
    server = await loop.create_server(lambda: StopPort(guard, console_origin), sock=stops)
    async with server:
        await guard.run()
        await asyncio.sleep(TICK_S)  # a last answer may be on its way


def main() -> None:
    """Ignore the signals that end the station: the guard outlives it."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    asyncio.run(serve(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]))


if __name__ == "__main__":
    main()
