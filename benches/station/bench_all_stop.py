"""How long "all stop" takes, from the operator's request to the last of 64 wires.

    python -m benches.station.bench_all_stop [--apps 64] [--streams 4] [--repeats 60] [--record]
        [--tile-readers 16]

A station as `recon run` starts it, with its audit, its log and, if asked for, its record, in a
process of its own; apps at 10 Hz core and 2 Hz extended telemetry in another, some with raw
1280x720 images at 5 fps that the station's worker projects on the ground; and a reader of the
stream of states, as a console; and, if asked for, readers of a base map. Again and again one HTTP
request orders an all stop. From just before the request is written, these are measured:

    on the wires   until the station has handed each packet to its socket, as its audit says
    read           until the last app has read its packet, as the apps' process says

beside plain loopback: as many bytes written on as many bare sockets by this process to that of the
apps, in the same moments of the same run.
"""

import argparse
import asyncio
import http.client
import json
import random
import shutil
import signal
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import numpy as np
from benches.station.started import PATIENCE_S, start_apps, start_station
from benches.station.tile_readers import TileReaders, write_orthophoto
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from recon.model.geo import GeoPoint
from recon.site import demo_site_folder, load_site

P99_LIMIT_MS = 100.0
STOP_BYTES = 10
SETTLED_S = 4.0
READ_WITHIN_S = 0.4
"""Telemetry confirms within half a second; the next all stop comes when that is over."""


@dataclass(slots=True)
class Measured:
    """Times in milliseconds, a row for each all stop."""

    on_wires_ms: list[float] = field(default_factory=list)
    read_ms: list[list[float]] = field(default_factory=list)
    plain_ms: list[list[float]] = field(default_factory=list)
    answered_ms: list[float] = field(default_factory=list)
    waited_share: float = 0.0
    cpu_share: float = 0.0
    lost: int = 0
    repeated: int = 0
    tiles_per_s: float = 0.0
    tile_ms: list[float] = field(default_factory=list)


def measure(
    apps: int, streams: int, repeats: int, seed: int, *, records: bool, tile_readers: int = 0
) -> Measured:
    """Run everything once."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        plain = PlainServer()
        stack.callback(plain.close)
        site = site_with_map(folder) if tile_readers else demo_site_folder()
        station, link_port, http_port = start_station(folder, stack, records=records, site=site)
        options = ("--plain-port", plain.port, "--apps", apps, "--streams", streams)
        flying = start_apps(link_port, stack, *options)
        stop_reading = threading.Event()
        reader = threading.Thread(target=read_states, args=(http_port, stop_reading))
        reader.start()
        stack.callback(lambda: (stop_reading.set(), reader.join()))
        plain.wait_for(apps)
        wait_until_flying(http_port, apps)
        time.sleep(SETTLED_S)
        tiles = TileReaders(http_port, middle_of(site), tile_readers)
        stack.callback(tiles.end)
        before, began_s = scheduled(station.pid), time.monotonic()
        ordered = order_again_and_again(http_port, plain, repeats, seed)
        after, took_s = scheduled(station.pid), time.monotonic() - began_s
        tiles_per_s, tile_ms = tiles.end()
        told, _ = flying.communicate("", timeout=PATIENCE_S)
        station.send_signal(signal.SIGTERM)
        station.wait(PATIENCE_S)
        measured = work_out(ordered, json.loads(told), folder / "audit")
        measured.cpu_share = (after[0] - before[0]) / 1e9 / took_s
        measured.tiles_per_s, measured.tile_ms = tiles_per_s, tile_ms
        measured.waited_share = (after[1] - before[1]) / max(1, after[0] - before[0])
        return measured


@dataclass(frozen=True, slots=True)
class Ordered:
    """One all stop: when it was asked for by both clocks, when answered, its commands' numbers;
    and when the plain sockets were written to."""

    at_s: float
    utc_s: float
    answered_s: float
    ids: tuple[int, ...]
    plain_at_s: float


def site_with_map(folder: Path) -> Path:
    """Return a copy of the demonstration's site with a large base map."""
    site = folder / "site"
    shutil.copytree(demo_site_folder(), site)
    write_orthophoto(site, middle_of(site))
    return site


def middle_of(site: Path) -> GeoPoint:
    """Return a site's origin."""
    frame = load_site(site).frame
    assert frame is not None
    return frame.origin


class PlainServer:
    """Bare sockets, written to one after the other on a loop of its own."""

    def __init__(self) -> None:
        self._writers: list[asyncio.StreamWriter] = []
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        server = asyncio.run_coroutine_threadsafe(self._start(), self._loop).result(PATIENCE_S)
        self._server = server
        self.port = int(server.sockets[0].getsockname()[1])

    async def _start(self) -> asyncio.Server:
        async def keep(_reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            self._writers.append(writer)

        return await asyncio.start_server(keep, "127.0.0.1", 0)

    def wait_for(self, count: int) -> None:
        """Wait until so many are connected."""
        end_s = time.monotonic() + PATIENCE_S
        while len(self._writers) < count and time.monotonic() < end_s:
            time.sleep(0.05)

    def write_all(self) -> float:
        """Write on every socket; return when that was asked for."""
        at_s = time.monotonic()
        asyncio.run_coroutine_threadsafe(self._write_all(), self._loop).result(PATIENCE_S)
        return at_s

    async def _write_all(self) -> None:
        for writer in self._writers:
            writer.write(b"\0" * STOP_BYTES)

    def close(self) -> None:
        """End the sockets and the loop."""
        self._loop.call_soon_threadsafe(self._server.close)
        for writer in self._writers:
            self._loop.call_soon_threadsafe(writer.close)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


def read_states(http_port: int, is_over: threading.Event) -> None:
    """Take every state, as a console does."""
    address = f"ws://127.0.0.1:{http_port}/api/stream"
    with (
        suppress(ConnectionClosed),
        connect(address, max_size=None, compression=None) as stream,
    ):
        while not is_over.is_set():
            stream.recv(PATIENCE_S)


def wait_until_flying(http_port: int, apps: int) -> None:
    """Wait until the station knows every app as a vehicle in the air."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        vehicles = json.loads(ask(http_port, "GET", "/api/vehicles"))
        flying = sum(v["is_flying"]["value"] is True and v["serial"] is not None for v in vehicles)
        if flying == apps:
            return
        time.sleep(0.2)
    raise RuntimeError(f"expected {apps} vehicles in the air, got {flying}")


def ask(http_port: int, method: str, path: str) -> bytes:
    """One request on a connection of its own, as the client's are."""
    connection = http.client.HTTPConnection("127.0.0.1", http_port, timeout=PATIENCE_S)
    connection.request(method, path, headers={"Content-Length": "0"})
    data = connection.getresponse().read()
    connection.close()
    return data


def order_again_and_again(
    http_port: int, plain: PlainServer, repeats: int, seed: int
) -> list[Ordered]:
    """Order all stops at moments that keep no step with anything."""
    rng, ordered = random.Random(seed), list[Ordered]()
    for _ in range(repeats):
        time.sleep(rng.uniform(0.1, 0.4))
        at_s, utc_s = time.monotonic(), time.time()
        answer = json.loads(ask(http_port, "POST", "/api/all-stop"))
        answered_s = time.monotonic()
        ids = tuple(r["command_id"] for r in answer["results"] if r["accepted"])
        time.sleep(READ_WITHIN_S)
        plain_at_s = plain.write_all()
        time.sleep(READ_WITHIN_S)
        ordered.append(Ordered(at_s, utc_s, answered_s, ids, plain_at_s))
    return ordered


def scheduled(pid: int) -> tuple[int, int]:
    """What Linux says of a process's first thread: ns on a core, ns in the queue for one."""
    ran, waited, _ = Path(f"/proc/{pid}/task/{pid}/schedstat").read_text().split()
    return int(ran), int(waited)


def work_out(ordered: list[Ordered], told: dict[str, list[list[float]]], audit: Path) -> Measured:
    """Bring the three processes' times together."""
    measured, sent_utc_s = Measured(), first_sent_utc_s(audit)
    for order in ordered:
        wires = [sent_utc_s[number] for number in order.ids if number in sent_utc_s]
        measured.lost += len(told["stops"]) - len(wires)
        measured.on_wires_ms.append(1e3 * (max(wires) - order.utc_s))
        measured.answered_ms.append(1e3 * (order.answered_s - order.at_s))
        read = [within(times, order.at_s, order.plain_at_s) for times in told["stops"]]
        measured.lost += sum(not times for times in read)
        measured.repeated += sum(len(times) > 1 for times in read)
        measured.read_ms.append([1e3 * (times[0] - order.at_s) for times in read if times])
        end_s = order.plain_at_s + READ_WITHIN_S
        plain = [within(times, order.plain_at_s, end_s) for times in told["plain"]]
        measured.plain_ms.append([1e3 * (times[0] - order.plain_at_s) for times in plain if times])
    return measured


def within(times_s: list[float], begin_s: float, end_s: float) -> list[float]:
    """Return the times of a span."""
    return [at_s for at_s in times_s if begin_s <= at_s < end_s]


def first_sent_utc_s(audit: Path) -> dict[int, float]:
    """When each command's packet was handed to its socket, as the audit says (to microseconds)."""
    sent: dict[int, float] = {}
    for path in sorted(audit.glob("*.jsonl")):
        for line in map(json.loads, path.read_text(encoding="ascii").splitlines()):
            if line["kind"] == "order.sent":
                moment = datetime.fromisoformat(line["utc"]).timestamp()
                sent.setdefault(line["details"]["id"], moment)
    return sent


def report(measured: Measured, apps: int, streams: int) -> bool:
    """Print every figure; return whether they are good."""
    last_read_ms = [max(row) for row in measured.read_ms]
    every_read_ms = [ms for row in measured.read_ms for ms in row]
    last_plain_ms = [max(row) for row in measured.plain_ms]
    print(f"{len(last_read_ms)} all stops to {apps} apps, {streams} of them with image streams")
    show("on the last wire, by the audit", measured.on_wires_ms)
    show("read by the last app", last_read_ms)
    show("read by each app", every_read_ms)
    show("the operator has the answer", measured.answered_ms)
    show(f"baseline: {apps} plain writes, read by the last", last_plain_ms)
    print(
        f"lost: {measured.lost}; twice: {measured.repeated}; the station's loop took "
        f"{100 * measured.cpu_share:.0f} % of a core, and waited "
        f"{100 * measured.waited_share:.0f} % as long for one: other programs' share"
    )
    if measured.tile_ms:
        show(f"a tile of the base map, {measured.tiles_per_s:.0f} a second", measured.tile_ms)
    p99_ms = float(np.percentile(measured.on_wires_ms, 99))
    return measured.lost == 0 and measured.repeated == 0 and p99_ms < P99_LIMIT_MS


def show(what: str, times_ms: list[float]) -> None:
    """Print one row."""
    p50, p99, most = (float(np.percentile(times_ms, p)) for p in (50, 99, 100))
    print(f"{what:<48} p50 {p50:7.2f} ms   p99 {p99:7.2f} ms   most {most:7.2f} ms")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", action="store_true", help="with a flight record")
    parser.add_argument("--tile-readers", type=int, default=0, help="of a base map, without pause")
    asked = parser.parse_args()
    measured = measure(
        asked.apps, asked.streams, asked.repeats, asked.seed, records=asked.record,
        tile_readers=asked.tile_readers,
    )  # fmt: skip
    is_good = report(measured, asked.apps, asked.streams)
    wanted = f"each app stopped once, and on every wire within {P99_LIMIT_MS:g} ms p99, expected"
    print("good" if is_good else f"FAILED: {wanted}")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
