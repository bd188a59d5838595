"""A station and simulated drones as separate processes, and `recon` commands."""

import json
import os
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any
from unittest.mock import patch

from tests.cli.processes import PATIENCE_S, Started, started
from websockets.sync.client import connect

from recon.cli import main
from recon.site import demo_site_folder

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class CommandResult:
    """Output and exit code of a command."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@dataclass(slots=True)
class StationProcess:
    """A running station, its simulator, and `recon` commands that connect to it."""

    station: Started
    simulator: Started | None
    url: str
    link_port: int
    audit: Path

    def recon(self, *words: object, address: str | None = None) -> CommandResult:
        """Run a command to its end, in this process: starting one takes a second of a core.

        `test_startup.py` and the tests of the docs start real ones.
        """
        out, err, code = StringIO(), StringIO(), 0
        with (
            patch.dict(os.environ, RECON_STATION=address or self.url),
            patch.object(sys, "argv", ["recon", *map(str, words)]),
            redirect_stdout(out),
            redirect_stderr(err),
        ):
            try:
                main()
            except SystemExit as ended:
                code = int(ended.code or 0)
        return CommandResult(code, out.getvalue(), err.getvalue())

    def audited(self, kind: str, entries: int = 1) -> list[str]:
        """The audit's lines of a kind, once that many are in its file: a thread writes them."""
        given_up_s = time.monotonic() + PATIENCE_S
        while True:
            shown = self.recon("audit", "show", self.audit, "--kind", kind)
            if len(lines := shown.out.splitlines()) >= entries:
                return lines
            assert time.monotonic() < given_up_s, f"{shown.out}{shown.err}"
            time.sleep(0.02)

    def get(self, path: str) -> Any:
        """Return a resource of the API."""
        with urllib.request.urlopen(f"{self.url}{path}", timeout=PATIENCE_S) as response:
            return json.load(response)

    def until(self, condition: Callable[[list[dict[str, Any]]], bool]) -> list[dict[str, Any]]:
        """Wait until the vehicles meet a condition; checks every state of the stream."""
        with connect(self.url.replace("http", "ws") + "/api/stream") as stream:
            for _ in range(round(10 * PATIENCE_S)):
                vehicles: list[dict[str, Any]] = json.loads(stream.recv(PATIENCE_S))["vehicles"]
                if condition(vehicles):
                    return vehicles
        raise AssertionError(f"condition never met; last: {vehicles}")


def run_options(audit: Path, link_port: int = 0, *, guard: bool = False) -> tuple[str, ...]:
    """Options of a station; a guard and a record each take half a second of a core to start."""
    ports = ("--link-port", str(link_port), "--http-port", "0")
    more = ("--audit", str(audit), "--guard" if guard else "--no-guard")
    return ("run", *ports, "--no-record", "--site", str(demo_site_folder()), *more)


def sim_options(link_port: int, vehicles: int, *more: str) -> tuple[str, ...]:
    station = ("--station", f"127.0.0.1:{link_port}", "--site", str(demo_site_folder()))
    return ("sim", *station, "--vehicles", str(vehicles), "--no-imager", *more)


def addresses(station: Started) -> tuple[str, int]:
    """The console's address and the link port that a station prints."""
    port = int(station.line_with("companion apps: 127.0.0.1:").rpartition(":")[2])
    return station.line_with("console: http://127.0.0.1:").partition(": ")[2], port


@contextmanager
def station_process(
    audit: Path, vehicles: int, *more: str, guard: bool = False
) -> Iterator[StationProcess]:
    """Run a station and simulated drones; both are stopped afterwards."""
    with ExitStack() as stack:
        process = stack.enter_context(started(*run_options(audit, guard=guard)))
        url, link_port = addresses(process)
        simulator = None
        if vehicles:
            simulator = stack.enter_context(started(*sim_options(link_port, vehicles, *more)))
        station = StationProcess(process, simulator, url, link_port, audit)
        if vehicles:
            station.until(
                lambda states: sum(bool(v["flight_mode"]["value"]) for v in states) == vehicles
            )
        yield station
