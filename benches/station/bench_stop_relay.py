"""What a process of its own for stops would cost and buy, by a prototype (`stop_relay`).

    python -m benches.station.bench_stop_relay [--apps 64] [--streams 4] [--repeats 40]

The station of `bench_all_stop` under the same load, once with its apps connected to it and once
through the relay; in the same run. Told are, of both,

    all stop        from the request to the reading of each app: by the station's API, and by the
                    relay's own stop port
    station halted  the same while the station's process is stopped for 3 s (SIGSTOP), as by a
                    page fault on a slow disk, a debugger or a computer out of memory
    station killed  the same after SIGKILL
    cost            the processor time of both processes, and the telemetry's way
"""

import argparse
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from benches.station.bench_all_stop import (
    PATIENCE_S,
    READ_WITHIN_S,
    SETTLED_S,
    PlainServer,
    ask,
    read_states,
    scheduled,
    start_apps,
    start_station,
    wait_until_flying,
    within,
)

HALTED_S = 3.0
HALTED_REPEATS = 5
AFTER_HALT_S = 2.5
"""Until a station that goes on has telemetry again, and has sent what waited for it."""


@dataclass(slots=True)
class Asked:
    """One all stop: when it was asked for, and until when its packets count."""

    way: str
    at_s: float
    end_s: float


@dataclass(slots=True)
class Measured:
    """The all stops of one setup, and what it cost."""

    asked: list[Asked] = field(default_factory=list)
    reads_s: list[list[float]] = field(default_factory=list)
    cpu_shares: dict[str, float] = field(default_factory=dict)

    def last_ms(self, way: str) -> list[float]:
        """Until the last app had read each all stop of a way; infinite when one never did."""
        rows = []
        for one in self.asked:
            if one.way == way:
                first = [within(times, one.at_s, one.end_s)[:1] for times in self.reads_s]
                rows.append(
                    max(1e3 * (times[0] - one.at_s) if times else float("inf") for times in first)
                )
        return rows


class RelayProcess:
    """The relay in a process of its own."""

    def __init__(self, station_port: int, stack: ExitStack) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "benches.station.stop_relay", str(station_port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        stack.callback(self.process.kill)
        assert self.process.stdout is not None
        self.link_port, stop_port = map(int, self.process.stdout.readline().split())
        self.stops = socket.create_connection(("127.0.0.1", stop_port))
        stack.callback(self.stops.close)

    def stop_all(self) -> None:
        """Ask for an all stop; return when the relay has answered."""
        self.stops.sendall(b"stop\n")
        self.stops.recv(64)


def measure(apps: int, streams: int, repeats: int, seed: int, has_relay: bool) -> Measured:
    """Run one setup."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        plain = PlainServer()
        stack.callback(plain.close)
        station, link_port, http_port = start_station(folder, stack)
        relay = RelayProcess(link_port, stack) if has_relay else None
        link_port = link_port if relay is None else relay.link_port
        flying = start_apps(link_port, plain.port, apps, streams, stack)
        is_over = threading.Event()
        reader = threading.Thread(target=read_states, args=(http_port, is_over))
        reader.start()
        stack.callback(lambda: (is_over.set(), reader.join()))
        wait_until_flying(http_port, apps)
        time.sleep(SETTLED_S)
        measured, rng = Measured(), random.Random(seed)
        pids = {"station": station.pid} | ({} if relay is None else {"relay": relay.process.pid})
        before, began_s = {who: scheduled(pid)[0] for who, pid in pids.items()}, time.monotonic()
        for _ in range(repeats):
            time.sleep(rng.uniform(0.1, 0.4))
            _ask(measured, "all stop, station", partial(_stop_all, http_port))
            if relay is not None:
                _ask(measured, "all stop, relay", relay.stop_all)
        took_ns = 1e9 * (time.monotonic() - began_s)
        for who, pid in pids.items():
            measured.cpu_shares[who] = (scheduled(pid)[0] - before[who]) / took_ns
        _halt_and_kill(measured, station, http_port, relay)
        is_over.set()
        told, _ = flying.communicate("", timeout=PATIENCE_S)
        measured.reads_s = json.loads(told)["stops"]
        return measured


def _stop_all(http_port: int) -> None:
    ask(http_port, "POST", "/api/all-stop")


def _ask(
    measured: Measured, way: str, ask_for: Callable[[], None], within_s: float = READ_WITHIN_S
) -> None:
    at_s = time.monotonic()
    ask_for()
    time.sleep(within_s)
    measured.asked.append(Asked(way, at_s, time.monotonic()))


def _halt_and_kill(
    measured: Measured,
    station: "subprocess.Popen[str]",
    http_port: int,
    relay: RelayProcess | None,
) -> None:
    for _ in range(HALTED_REPEATS):
        os.kill(station.pid, signal.SIGSTOP)
        going_on = threading.Timer(HALTED_S, os.kill, (station.pid, signal.SIGCONT))
        going_on.start()
        if relay is None:
            _ask(measured, "station halted, station", partial(_stop_all, http_port), AFTER_HALT_S)
        else:
            _ask(measured, "station halted, relay", relay.stop_all)
        going_on.join()
        time.sleep(1.0)
    if relay is not None:
        at_s = time.monotonic()
        station.kill()
        relay.stop_all()
        time.sleep(READ_WITHIN_S)
        measured.asked.append(Asked("station killed, relay", at_s, time.monotonic()))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    for has_relay in (False, True):
        measured = measure(asked.apps, asked.streams, asked.repeats, asked.seed, has_relay)
        print("through the relay:" if has_relay else "the station alone:")
        for way in dict.fromkeys(one.way for one in measured.asked):
            times = measured.last_ms(way)
            p50, p99 = (float(np.percentile(times, p, method="nearest")) for p in (50, 99))
            print(f"  {way:<26} read by the last app   p50 {p50:8.1f} ms   p99 {p99:8.1f} ms")
        shares = ", ".join(f"{who} {100 * s:.0f} %" for who, s in measured.cpu_shares.items())
        print(f"  cost: {shares} of a core")
    return 0


if __name__ == "__main__":
    sys.exit(main())
