"""The station's end of its guard: starts it, hands it every app's socket, and beats.

Theory of operation.

    starting --started--> watched: each new socket goes to the guard, a picture ten times a second
    watched  --the guard ends, or leaves pictures unanswered--> unwatched: an alarm; it is killed,
             and a new one started after `RESTART_S`
    watched  --the guard did something--> its hold is an alarm and ends the orders it held against;
             an all stop at its port is given here too, and latches

The picture is sent from the event loop: a loop that does not run sends none, which is what the
guard watches for. Nothing here waits for the guard: a line that takes nothing costs pictures.
"""

import asyncio
import http.client
import json
import socket
import subprocess
import sys
import time
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from recon.guard import messages
from recon.guard.messages import LinkPicture
from recon.guard.watch import Intervention
from recon.model.control import Commanded
from recon.model.errors import describe_fault
from recon.model.event import GuardActed, StationFaulted
from recon.model.person import Person, Role
from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleState
from recon.station.api_views.service import Service
from recon.station.kernel.driver import AsyncioDriver
from recon.station.state.station import Station

BEAT_S = 0.1
RESTART_S = 1.0
MOST_UNANSWERED = 50
"""Beats in 5 s, for which a busy computer may keep it from running."""
STARTS_WITHIN = 250
"""Beats, 25 s: from its start to its first answer."""
ENDS_WITHIN_S = 2.0
GIVE_WAY_S = 1.0
MOST_ANSWER_BYTES = 256 * 1024
PORT_FILE = "guard-port"
GUARD = "at its guard"
"""The place of a fault: the guard has ended."""


class GuardLine:
    """One guard after another, for as long as the station runs."""

    def __init__(
        self, driver: AsyncioDriver, service: Service, stop_socket: socket.socket, origin: str
    ) -> None:
        self._driver = driver
        self._service = service
        self._stop_socket = stop_socket
        self._origin = origin
        self._sockets: dict[int, Any] = {}
        self._line: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._unsent: deque[tuple[bytes, int | None]] = deque()
        self._lines = messages.Lines()
        self._unanswered = 0
        """Beats since the guard last answered one."""

    @property
    def stop_url(self) -> str:
        """Where a person stops all vehicles when the station does not answer."""
        return f"http://127.0.0.1:{self._stop_socket.getsockname()[1]}/all-stop"

    def write_port(self, folder: Path) -> None:
        """Leave the guard's port for the next station; without it apps reconnect later."""
        with suppress(OSError):
            port = self._stop_socket.getsockname()[1]
            (folder / PORT_FILE).write_text(str(port), encoding="ascii")

    async def run(self) -> None:
        """Beat until cancelled; start the guard again when it has ended."""
        while True:
            try:
                if self._line is None:
                    self._start()
                self._beat()
            except Exception as fault:
                self._driver.handle(StationFaulted(GUARD, describe_fault(fault)))
            await asyncio.sleep(BEAT_S if self._line is not None else RESTART_S)

    def opened(self, link_id: int, sock: Any) -> None:
        """Hand a new connection's socket to the guard."""
        self._sockets[link_id] = sock
        self._unsent.append((messages.socket_line(link_id), link_id))
        self._flush()

    def closed(self, link_id: int) -> None:
        """Tell the guard that a connection is over."""
        self._sockets.pop(link_id, None)
        self._unsent.append((messages.closed_line(link_id), None))
        self._flush()

    def close(self) -> None:
        """End the guard with the station."""
        self._unsent.append((messages.over_line(), None))
        self._flush()
        self._hang_up()
        if self._process is not None:
            try:
                self._process.wait(ENDS_WITHIN_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._stop_socket.close()

    def _start(self) -> None:
        mine, guards = socket.socketpair()
        options = [str(guards.fileno()), str(self._stop_socket.fileno()), self._origin]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "recon.guard.process", *options],
            # What it outlives must not wait for it at the other end of a pipe.
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=(guards.fileno(), self._stop_socket.fileno()),
            start_new_session=True,
        )
        guards.close()
        mine.setblocking(False)
        self._line, self._lines = mine, messages.Lines()
        asyncio.get_running_loop().add_reader(mine, self._read)
        self._unanswered = -STARTS_WITHIN
        self._unsent = deque((messages.socket_line(link), link) for link in self._sockets)

    def _beat(self) -> None:
        self._flush()
        if self._line is None:
            return
        # Counted, not timed: a station that was suspended has not asked either.
        self._unanswered += 1
        if self._unanswered > MOST_UNANSWERED:
            self._ended()
        if self._unsent or self._line is None:
            return
        now_ns = self._driver.now_ns()
        picture = messages.picture_line(link_pictures(self._driver.station, now_ns))
        self._unsent.append((picture, None))
        self._flush()

    def _flush(self) -> None:
        """Send what waits, in its order, as far as the line takes it."""
        while self._unsent and self._line is not None:
            data, link_id = self._unsent[0]
            sock = None if link_id is None else self._sockets.get(link_id)
            is_gone = link_id is not None and (sock is None or sock.fileno() < 0)
            try:
                if is_gone:
                    sent = len(data)
                elif sock is None:
                    sent = self._line.send(data)
                else:
                    sent = socket.send_fds(self._line, [data], [sock.fileno()])
            except BlockingIOError:
                return
            except OSError:
                self._ended()
                return
            self._unsent.popleft()
            if sent < len(data):
                self._unsent.appendleft((data[sent:], None))

    def _read(self) -> None:
        assert self._line is not None
        try:
            data = self._line.recv(64 * 1024)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._ended()
            return
        for message in self._lines.feed(data):
            if message["is"] == messages.ALIVE:
                self._unanswered = 0
                continue
            self.take(messages.intervention_of(message))
            self._unsent.append((messages.noted_line(), None))
        self._flush()

    def take(self, intervention: Intervention) -> None:
        """Take note of something that a guard did."""
        self._driver.handle(
            GuardActed(
                intervention.why,
                intervention.serials,
                intervention.names,
                intervention.refused,
                intervention.by,
            )
        )
        if intervention.by is not None:
            self._service.orders.all_stop(Person(intervention.by, Role.OPERATOR, "guard's port"))

    def _ended(self) -> None:
        self._hang_up()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        what = "it has ended; a new one is started. Without it only the station can stop vehicles"
        self._driver.handle(StationFaulted(GUARD, what))

    def _hang_up(self) -> None:
        if self._line is not None:
            asyncio.get_running_loop().remove_reader(self._line)
            self._line.close()
            self._line = None


def link_pictures(station: Station, now_ns: int) -> Iterator[LinkPicture]:
    """Yield what the station believes of each open link."""
    for link in station.fleet.links.values():
        vehicle = station.fleet.vehicle_of_link(link.id) if link.is_open else None
        if vehicle is None:
            continue
        at_ns = vehicle.core_received_at_ns
        yield LinkPicture(
            link_id=link.id,
            serial=vehicle.serial,
            name=vehicle.display_name,
            is_flying=vehicle.is_flying.value,
            reported_is_flying=vehicle.reported_is_flying.value,
            age_s=None if at_ns is None else ns_to_seconds(now_ns - at_ns),
            is_steered=_is_steered(station, vehicle),
        )


def _is_steered(station: Station, vehicle: VehicleState) -> bool:
    control = station.control(vehicle.serial)
    return control.stream is not None or control.intent.commanded is Commanded.STICK


def take_over_from_orphan(folder: Path) -> tuple[Intervention, ...]:
    """Have the guard of a station that has died here close its connections; return what it did."""
    try:
        port = int((folder / PORT_FILE).read_text(encoding="ascii"))
    except (OSError, ValueError):
        return ()
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=GIVE_WAY_S)
    try:
        connection.request("POST", "/give-way", headers={"Content-Length": "0"})
        answer = json.loads(connection.getresponse().read(MOST_ANSWER_BYTES))
        interventions = tuple(
            messages.intervention_of(intervention) for intervention in answer["interventions"]
        )
    except (OSError, ValueError, KeyError, TypeError, http.client.HTTPException):
        return ()
    finally:
        connection.close()
    _wait_until_free(port)
    return interventions


def _wait_until_free(port: int) -> None:
    """Wait until a guard that ends has closed its port."""
    end_s = time.monotonic() + GIVE_WAY_S
    while time.monotonic() < end_s:
        try:
            socket.create_connection(("127.0.0.1", port), GIVE_WAY_S).close()
        except OSError:
            return
        time.sleep(0.02)
