"""The processes of a soak, on loopback: a station, simulated apps and a gateway, by their roles."""

import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
from benches.station.bench_all_stop import ask
from benches.station.tile_readers import write_orthophoto

from studies.soak.field import ORIGIN, drones_and_imagers, write_faults, write_site
from studies.soak.figures import ProcessSample

PATIENCE_S = 120.0
ENDS_WITHIN_S = 20.0
CHILD_ROLES = (
    ("recon.record.mcap.record_process", "record"),
    ("recon.guard.process", "guard"),
    ("recon.basemap.map_process", "maps"),
    ("resource_tracker", "tracker"),
    ("multiprocessing", "method"),
)
"""What a child of the station is, by a word of its command."""


@dataclass(slots=True)
class World:
    """One site and what runs on it; every process is one that this started."""

    folder: Path
    vehicles: int
    minutes: float
    faults_per_hour: float
    processes: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)
    link_port: int = field(default_factory=lambda: free_port())
    http_port: int = field(default_factory=lambda: free_port())
    gateway_port: int = field(default_factory=lambda: free_port())

    @property
    def audit(self) -> Path:
        """The folder of the audit and of the recovery snapshot."""
        return self.folder / "audit"

    @property
    def records(self) -> Path:
        """The folder of the flight records."""
        return self.folder / "records"

    @property
    def serials(self) -> list[str]:
        """The survey drones."""
        return drones_and_imagers(self.vehicles)[0]

    def write(self) -> None:
        """Write site, base map and faults."""
        self.folder.mkdir(parents=True, exist_ok=True)
        write_site(self.folder / "site", self.vehicles)
        write_orthophoto(self.folder / "site", ORIGIN)
        write_faults(self.folder / "faults.toml", self.minutes, self.faults_per_hour)

    def start_all(self) -> None:
        """Start station, apps and gateway; return when every vehicle has reported its serial."""
        self.start_station()
        self.start_simulator()
        self.start_gateway()
        self.wait_for_vehicles()

    def start_station(self) -> None:
        """Start the station on its ports, again after a kill; return when its console answers."""
        places = {"site": self.folder / "site", "audit": self.audit, "record": self.records}
        ports = {"link-port": self.link_port, "http-port": self.http_port, "stop-port": 0}
        self._start("station", ("run",), places | ports)
        wait_until(lambda: self.answers, f"a console on port {self.http_port}", self._said)

    def start_simulator(self) -> None:
        """Start the simulated vehicles and their apps."""
        options = {
            "station": f"127.0.0.1:{self.link_port}",
            "site": self.folder / "site",
            "vehicles": self.vehicles,
            "faults": self.folder / "faults.toml",
            "image-format": "jpeg",
            "imager-endurance-min": 60_000,
            "battery-swap-min": 3,
            "wind-mps": 3,
        }
        self._start("simulator", ("sim",), options)

    def start_gateway(self) -> None:
        """Start the gateway for MAVLink clients."""
        station, tcp = f"http://127.0.0.1:{self.http_port}", f"127.0.0.1:{self.gateway_port}"
        self._start("gateway", ("gateway", "mavlink"), {"station": station, "tcp": tcp})

    def wait_for_vehicles(self) -> None:
        """Wait until the telemetry of all vehicles is live."""
        wait_until(
            lambda: len(self.live_serials()) >= self.vehicles,
            f"{self.vehicles} vehicles with telemetry",
            self._said,
        )

    def live_serials(self) -> set[str]:
        """Return the serials of the vehicles with live telemetry."""
        return {v["serial"] for v in self.get("/api/vehicles") if v["staleness"] == "live"}

    @property
    def answers(self) -> bool:
        """Whether the console answers now."""
        with suppress(OSError):
            return bool(self.get("/api/state"))
        return False

    def get(self, path: str) -> Any:
        """Return an answer of the API."""
        return json.loads(ask(self.http_port, "GET", path))

    def children(self) -> Iterator[tuple[str, psutil.Process]]:
        """Yield the station's own processes, by role; not those that are as short as one task."""
        with suppress(psutil.NoSuchProcess):
            for child in psutil.Process(self.processes["station"].pid).children(recursive=True):
                with suppress(psutil.NoSuchProcess, psutil.ZombieProcess):
                    words = " ".join(child.cmdline())
                    role = next((role for word, role in CHILD_ROLES if word in words), None)
                    if role is not None:
                        yield role, child

    def samples(self, at_s: float) -> Iterator[ProcessSample]:
        """Yield a look at each process."""
        started = ((role, psutil.Process(p.pid)) for role, p in self.processes.items())
        for role, process in (*started, *self.children()):
            with suppress(psutil.NoSuchProcess, psutil.ZombieProcess), process.oneshot():
                yield ProcessSample(
                    at_s,
                    role,
                    process.pid,
                    process.memory_info().rss,
                    process.num_fds(),
                    process.num_threads(),
                )

    def ended(self) -> list[str]:
        """Return a sentence for each process that has ended without being asked to."""
        return [
            f"{role} has ended with {process.returncode}: {self._said(role)[-800:]}"
            for role, process in self.processes.items()
            if process.poll() is not None
        ]

    def kill(self, role: str) -> None:
        """End a process as a power cut would; it was started here."""
        process = self.processes.pop(role)
        process.kill()
        process.wait()

    def close(self) -> None:
        """End everything in order, the station last."""
        for role in sorted(self.processes, key=lambda role: role == "station"):
            process = self.processes.pop(role)
            process.terminate()
            try:
                process.wait(ENDS_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def _start(self, role: str, command: Sequence[str], options: Mapping[str, object]) -> None:
        words = [f"--{name}={value}" for name, value in options.items()]
        environment = os.environ | {"XDG_STATE_HOME": str(self.folder / "state")}
        with (self.folder / f"{role}.log").open("ab") as log:
            self.processes[role] = subprocess.Popen(
                [sys.executable, "-m", "recon", *command, *words],
                stdout=log,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                env=environment,
            )

    def _said(self, role: str = "station") -> str:
        return (self.folder / f"{role}.log").read_text(encoding="utf-8", errors="replace")


def free_port() -> int:
    """Return a port of loopback that is free now: a restarted station needs the same one."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def wait_until(
    holds: Callable[[], bool],
    what: str,
    said: Callable[[], str] = lambda: "",
    within_s: float = PATIENCE_S,
) -> None:
    """Wait until something holds; raises RuntimeError with what was waited for."""
    end_s = time.monotonic() + within_s
    while not holds():
        if time.monotonic() > end_s:
            raise RuntimeError(f"expected {what} within {within_s:g} s; {said()[-800:]}")
        time.sleep(0.2)


def size_of(folder: Path) -> int:
    """Return the bytes of all files in a folder."""
    total = 0
    for path in folder.rglob("*"):
        with suppress(OSError):
            total += path.stat().st_size
    return total
