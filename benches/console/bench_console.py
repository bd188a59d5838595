"""The console's speed in headless Chromium without a GPU, with a real station and drones that move.

    python -m benches.console.bench_console [--drones 8 20 64] [--seconds 30] [--heap-minutes 3]

Prints a table beside the limits:

    stamp to frame     from a state's `time_ns` to the presentation of the frame that shows it
    first screen       from the navigation, nothing cached, until all drones are on the map and in
                       the list; the median of three
    main thread        share of the time it is in tasks
    first load         bytes of page, scripts and styles as sent
    stream             bytes a second of one reader, with changes and permessage-deflate
    heap               growth after collections; a track of ten minutes fills meanwhile
    videos             the demonstration, which surveys under cloud with its shade maps, and two
                       cameras in view: the imaging drone's and one of another drone

The machine must be idle: its load is printed. Skips itself without a Chromium or a built console.
"""

import argparse
import json
import os
import socket
import statistics
import struct
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benches.console.browser import Browser, Page, find_chromium, running_browser
from benches.station.bench_all_stop import wait_until_flying
from benches.station.started import PATIENCE_S, start_apps, start_recon, start_station
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

PROBE = Path(__file__).with_name("probe.js")
PROJECT = Path(__file__).parents[2]
SETTLED_S = 5.0
HEAP_PERIOD_S = 15.0
STREAM_SECONDS = 15.0
STREAM_DRONES = (10, 64)
HEAP_DRONES = 8
HEAP_WARM_S = 45.0

P95_MS = {8: 150.0, 20: 200.0, 64: 400.0}
FIRST_SCREEN_S = {8: 1.5, 64: 2.5}
STREAM_KB_S = {10: 32.0, 64: 200.0}
FIRST_LOAD_KB = 600.0
VIDEOS_BUSY = 50.0
"""Per cent of a core, of the main thread."""
CAMERAS_OPEN = "localStorage.setItem('recon.panels', 'survey,cameras');"
ALL_SHOWN = (
    "document.querySelectorAll('.cameras img').length === 2 && document.querySelector('.time')"
    " !== null"
)
HEAP_KB_MIN = 100.0
"""A third of it is the tracks of eight drones, which end with ten minutes."""
TCP_INFO_BYTES = 192
BYTES_RECEIVED_AT = 128
"""`tcpi_bytes_received` in Linux's `struct tcp_info`."""


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table."""

    name: str
    value: str
    wanted: str
    is_good: bool


def most(name: str, value: float, unit: str, limit: float | None) -> Row:
    """Return the row of a figure with its greatest wanted value; None: there is none."""
    digits = 0 if value >= 100 else 1
    wanted = "" if limit is None else f"< {limit:g} {unit}"
    return Row(name, f"{value:.{digits}f} {unit}", wanted, limit is None or value < limit)


@contextmanager
def flying(drones: int) -> Iterator[int]:
    """Run a station with so many drones in the air; yield the console's port."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        station, link_port, http_port = start_station(folder, stack)
        apps = start_apps(link_port, stack, "--flight", "circle", "--apps", drones)
        wait_until_flying(http_port, drones)
        time.sleep(SETTLED_S)
        yield http_port
        apps.kill()
        apps.wait(PATIENCE_S)
        station.terminate()
        station.wait(PATIENCE_S)


def open_console(browser: Browser, http_port: int, drones: int) -> Page:
    """Open the console, and wait for its first useful screen."""
    probe = f"window.reconDrones = {drones};\n{PROBE.read_text(encoding='utf-8')}"
    page = browser.open(f"http://127.0.0.1:{http_port}/", probe)
    page.wait_for("window.reconProbe?.useful_ms ?? 0")
    return page


def first_screens(browser: Browser, http_port: int, drones: int) -> tuple[float, float]:
    """Return the median time to the first useful screen, s, and the bytes that it loads, kB."""
    times_s, load_kb = [], 0.0
    for _ in range(3):
        page = open_console(browser, http_port, drones)
        times_s.append(page.evaluate("reconProbe.useful_ms") / 1e3)
        time.sleep(1.0)
        load_kb = page.evaluate(
            "[...performance.getEntriesByType('navigation'),"
            " ...performance.getEntriesByType('resource')]"
            ".filter(({name}) => !name.includes('/api/'))"
            ".reduce((sum, {transferSize}) => sum + transferSize, 0)"
        )
        page.close()
    return statistics.median(times_s), load_kb / 1e3


PARTS = {"scripts": "ScriptDuration", "styles": "RecalcStyleDuration", "layout": "LayoutDuration"}


def main_thread(page: Page, seconds: float) -> tuple[float, str]:
    """Return for how much of some time the main thread is busy, per cent, and with what."""
    before, began_s = page.metrics(), time.monotonic()
    time.sleep(seconds)
    after, took_s = page.metrics(), time.monotonic() - began_s

    def busy(name: str) -> float:
        return 100.0 * (after[name] - before[name]) / took_s

    return busy("TaskDuration"), ", ".join(f"{part} {busy(PARTS[part]):.0f}" for part in PARTS)


def frames(page: Page, drones: int, seconds: float) -> list[Row]:
    """Watch the states arrive and be shown for some time."""
    time.sleep(SETTLED_S)
    page.evaluate("reconProbe.received.length = reconProbe.painted.length = 0")
    began_s = time.monotonic()
    busy, parts = main_thread(page, seconds)
    took_s = time.monotonic() - began_s
    received, painted = page.evaluate("[reconProbe.received, reconProbe.painted]")
    receipt_ms = [at - stamp for stamp, at in received]
    shown_ms = [at - stamp for stamp, at in painted]
    p50, p95 = np.percentile(shown_ms, (50, 95))
    label = f"{drones} drones: "
    return [
        most(label + "stamp to frame, p50", p50, "ms", None),
        most(label + "stamp to frame, p95", p95, "ms", P95_MS.get(drones)),
        most(label + "stamp to receipt, p95", float(np.percentile(receipt_ms, 95)), "ms", None),
        most(label + "states shown a second", len(painted) / took_s, "", None),
        Row(label + "main thread busy", f"{busy:.0f} % ({parts})", "", True),
    ]


def videos(program: str, seconds: float) -> Row:
    """Return how busy the main thread is with the demonstration and two cameras in view."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        station, link_port, http_port = start_recon(("demo", "--no-record"), folder, stack)
        start_apps(link_port, stack, "--flight", "circle", "--apps", 1, "--streams", 1)
        browser = stack.enter_context(running_browser(program))
        page = browser.open(f"http://127.0.0.1:{http_port}/", CAMERAS_OPEN)
        page.wait_for(ALL_SHOWN)
        time.sleep(SETTLED_S)
        busy, parts = main_thread(page, seconds)
        station.terminate()
        station.wait(PATIENCE_S)
    limit = VIDEOS_BUSY
    value = f"{busy:.0f} % ({parts})"
    return Row("shade map and two videos: main thread busy", value, f"< {limit:g} %", busy < limit)


def stream_kb_s(http_port: int) -> float:
    """Return what one reader receives as the console does, kB a second."""
    address = f"ws://127.0.0.1:{http_port}/api/stream?changes=2"
    with suppress(ConnectionClosed), connect(address, max_size=None) as stream:
        stream.recv(PATIENCE_S)
        before, began_s = received_bytes(stream.socket), time.monotonic()
        while time.monotonic() - began_s < STREAM_SECONDS:
            stream.recv(PATIENCE_S)
        took_s = time.monotonic() - began_s
        return (received_bytes(stream.socket) - before) / 1e3 / took_s
    raise RuntimeError("expected a stream, got its end")


def received_bytes(connection: socket.socket) -> int:
    """Return the payload that a TCP connection has received since it began."""
    info = connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, TCP_INFO_BYTES)
    return int(struct.unpack_from("=Q", info, BYTES_RECEIVED_AT)[0])


def heap(page: Page, minutes: float) -> Row:
    """Collect the garbage again and again; return how the rest grows."""
    time.sleep(HEAP_WARM_S)
    times_s, kb = [], []
    began_s = time.monotonic()
    while not times_s or times_s[-1] < 60 * minutes:
        times_s.append(time.monotonic() - began_s)
        kb.append(page.heap_bytes() / 1e3)
        time.sleep(HEAP_PERIOD_S)
    growth_kb_min = 60 * float(np.polyfit(times_s, kb, 1)[0])
    name = f"{HEAP_DRONES} drones: heap of {kb[0] / 1e3:.1f} MB grows by"
    return most(name, growth_kb_min, "kB/min", HEAP_KB_MIN)


def measure(program: str, drones: list[int], seconds: float, heap_minutes: float) -> list[Row]:
    """Run everything; return the table."""
    rows: list[Row] = []
    for count in drones:
        with flying(count) as http_port, running_browser(program) as browser:
            screen_s, load_kb = first_screens(browser, http_port, count)
            page = open_console(browser, http_port, count)
            rows += frames(page, count, seconds)
            limit_s = FIRST_SCREEN_S.get(count)
            rows.append(most(f"{count} drones: first screen", screen_s, "s", limit_s))
            if count == drones[0]:
                rows.append(most("first load, compressed", load_kb, "kB", FIRST_LOAD_KB))
            if count == HEAP_DRONES and heap_minutes > 0:
                rows.append(heap(page, heap_minutes))
    rows.append(videos(program, seconds))
    for count in STREAM_DRONES:
        with flying(count) as http_port:
            rows.append(
                most(f"{count} drones: stream", stream_kb_s(http_port), "kB/s", STREAM_KB_S[count])
            )
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drones", type=int, nargs="+", default=[8, 20, 64])
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--heap-minutes", type=float, default=3.0)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    asked = parser.parse_args()
    program = find_chromium()
    if program is None or not (PROJECT / "web" / "dist" / "index.html").exists():
        print("skipped: needs a Chromium (RECON_CHROMIUM names one) and a console: make web")
        return 0
    print(f"load before: {os.getloadavg()[0]:.2f} on {os.cpu_count()} cores", flush=True)
    rows = measure(program, asked.drones, asked.seconds, asked.heap_minutes)
    if asked.json:
        print(json.dumps([(row.name, row.value, row.wanted, row.is_good) for row in rows]))
    for row in rows:
        verdict = "" if row.wanted == "" else "good" if row.is_good else "FAILED"
        print(f"{row.name:<44} {row.value:<52} {row.wanted:<12} {verdict}")
    return 0 if all(row.is_good for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
