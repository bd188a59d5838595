"""What the guard costs and buys: all stops by the station, and by its guard, in the same run.

    python -m benches.station.bench_guard [--apps 64] [--streams 4] [--repeats 40]

The station of `bench_all_stop` under the same load. Told are, from just before the request is
written until the last app has read its hover,

    all stop         by the station's API, and at the guard's port
    station halted   the same while the station's process is stopped for 3 s (SIGSTOP), as by a slow
                     disk, a debugger, or a computer out of memory
    station killed   at the guard's port, after SIGKILL

and the share of a core that each of the two processes takes.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from benches.station.bench_all_stop import (
    READ_WITHIN_S,
    SETTLED_S,
    ask,
    read_states,
    scheduled,
    wait_until_flying,
    within,
)
from benches.station.started import PATIENCE_S, start_apps, start_station

HALTED_S = 3.0
HALTED_REPEATS = 5
AFTER_HALT_S = 2.5
"""Until a station that goes on has telemetry again, and has sent what waited for it."""
STOP_LINE = "all stop by the guard: curl -X POST "


@dataclass(slots=True)
class Asked:
    """One all stop: when it was asked for, and until when its packets count."""

    way: str
    at_s: float
    end_s: float


@dataclass(slots=True)
class Measured:
    """All stops, and what the two processes took."""

    asked: list[Asked] = field(default_factory=list)
    reads_s: list[list[float]] = field(default_factory=list)
    cpu_shares: dict[str, float] = field(default_factory=dict)

    def ask(self, way: str, ask_for: Callable[[], object], within_s: float = READ_WITHIN_S) -> None:
        """Ask for an all stop, and leave it time."""
        at_s = time.monotonic()
        ask_for()
        time.sleep(within_s)
        self.asked.append(Asked(way, at_s, time.monotonic()))

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


def measure(apps: int, streams: int, repeats: int, seed: int) -> Measured:
    """Run everything once."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        station, link_port, http_port = start_station(folder, stack)
        flying = start_apps(link_port, stack, "--apps", apps, "--streams", streams)
        is_over = threading.Event()
        reader = threading.Thread(target=read_states, args=(http_port, is_over))
        reader.start()
        stack.callback(lambda: (is_over.set(), reader.join()))
        wait_until_flying(http_port, apps)
        time.sleep(SETTLED_S)
        by_station = partial(ask, http_port, "POST", "/api/all-stop")
        by_guard = partial(ask_guard, stop_url(folder))
        measured, rng = Measured(), random.Random(seed)
        pids = {"station": station.pid, "guard": guard_of(station.pid)}
        before, began_s = {who: scheduled(pid)[0] for who, pid in pids.items()}, time.monotonic()
        for _ in range(repeats):
            time.sleep(rng.uniform(0.1, 0.4))
            measured.ask("all stop, station", by_station)
            time.sleep(rng.uniform(0.1, 0.4))
            measured.ask("all stop, guard", by_guard)
        took_ns = 1e9 * (time.monotonic() - began_s)
        for who, pid in pids.items():
            measured.cpu_shares[who] = (scheduled(pid)[0] - before[who]) / took_ns
        for _ in range(HALTED_REPEATS):
            halt(station)
            measured.ask("station halted, station", by_station, AFTER_HALT_S)
            halt(station)
            measured.ask("station halted, guard", by_guard)
            time.sleep(HALTED_S + AFTER_HALT_S)
        station.kill()
        measured.ask("station killed, guard", by_guard)
        is_over.set()
        told, _ = flying.communicate("", timeout=PATIENCE_S)
        measured.reads_s = json.loads(told)["stops"]
        return measured


def stop_url(folder: Path) -> str:
    """Return the guard's address, as the station printed it."""
    lines = (folder / "log").read_text(encoding="utf-8").splitlines()
    return next(line for line in lines if line.startswith(STOP_LINE)).removeprefix(STOP_LINE)


def guard_of(pid: int) -> int:
    """Return the guard among a process's children."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    lines = {int(child): Path(f"/proc/{child}/cmdline").read_bytes() for child in children}
    return next(child for child, line in lines.items() if b"recon.guard.process" in line)


def ask_guard(url: str) -> None:
    """Stop all at the guard's port."""
    request = urllib.request.Request(url, b'{"by": "bench"}', method="POST")
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as response:
        response.read()


def halt(station: "subprocess.Popen[str]") -> None:
    """Stop the station's process for a while."""
    os.kill(station.pid, signal.SIGSTOP)
    threading.Timer(HALTED_S, os.kill, (station.pid, signal.SIGCONT)).start()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    measured = measure(asked.apps, asked.streams, asked.repeats, asked.seed)
    print(f"{asked.apps} apps, {asked.streams} of them with image streams; read by the last app")
    ways = list(dict.fromkeys(one.way for one in measured.asked))
    for way in ways:
        times = measured.last_ms(way)
        p50, p99 = (float(np.percentile(times, p, method="nearest")) for p in (50, 99))
        print(f"  {way:<26} {len(times):3} times   p50 {p50:8.1f} ms   p99 {p99:8.1f} ms")
    shares = ", ".join(f"{who} {100 * s:.0f} %" for who, s in measured.cpu_shares.items())
    print(f"  {shares} of a core")
    is_good = all(max(measured.last_ms(way)) < float("inf") for way in ways)
    print("good" if is_good else "FAILED: expected every app to read every all stop")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
