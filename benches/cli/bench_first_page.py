"""Time of `recon run` from its start to the console's first page, beside another checkout's.

    python -m benches.cli.bench_first_page [--against PATH/src] [--rounds 5] [--site FOLDER]

The two are started in turn. The processor time is that of the station with all its processes: other
programs on the machine change it less than the elapsed time.
"""

import argparse
import http.client
import os
import socket
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

OWN_SOURCE = Path(__file__).parents[2] / "src"
WAIT_S = 60.0
POLL_S = 0.005


@dataclass(frozen=True, slots=True)
class Start:
    """What one start took until `GET /` was answered with 200."""

    elapsed_s: float
    processor_s: float


def start_of(source: Path, site: Path | None) -> Start:
    """Start a station from a checkout's source, ask for the page, and end the station."""
    port = free_port()
    with TemporaryDirectory() as folder:
        words = ["--link-port", "0", "--http-port", str(port), "--stop-port", "0"]
        words += ["--record", f"{folder}/records", "--audit", f"{folder}/audit"]
        words += [] if site is None else ["--site", str(site)]
        began_s = time.monotonic()
        station = subprocess.Popen(
            [sys.executable, "-m", "recon", "run", *words],
            stdout=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": str(source), "XDG_STATE_HOME": folder},
        )
        try:
            wait_for_page(station, port)
            elapsed_s = time.monotonic() - began_s
            return Start(elapsed_s, processor_s(station.pid))
        finally:
            station.terminate()
            station.wait(WAIT_S)


def free_port() -> int:
    """Return a port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
        return port


def wait_for_page(station: subprocess.Popen[bytes], port: int) -> None:
    """Ask for the console until it is there. Raises `ChildProcessError` without a station."""
    while station.poll() is None:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=WAIT_S)
        try:
            connection.request("GET", "/")
            if connection.getresponse().status == http.HTTPStatus.OK:
                return
        except ConnectionError:
            pass
        finally:
            connection.close()
        time.sleep(POLL_S)
    raise ChildProcessError("the station has ended before its first page")


def processor_s(pid: int) -> float:
    """Return the user and system time of a process and of all below it, ended or not."""
    stat = Path(f"/proc/{pid}/stat").read_text(encoding="ascii")
    times = stat.rpartition(")")[2].split()[11:15]
    own_s = sum(map(int, times)) / os.sysconf("SC_CLK_TCK")
    threads = Path(f"/proc/{pid}/task").iterdir()
    children = " ".join((thread / "children").read_text(encoding="ascii") for thread in threads)
    return own_s + sum(processor_s(int(child)) for child in children.split())


def shown(name: str, starts: list[Start]) -> Start:
    """Print and return the medians of all starts of a checkout."""
    median = Start(
        statistics.median(start.elapsed_s for start in starts),
        statistics.median(start.processor_s for start in starts),
    )
    print(
        f"{name:<9} {median.elapsed_s:.2f} s to the page, {median.processor_s:.2f} s of processor"
    )
    return median


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", type=Path, help="Folder src of another checkout.")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--site", type=Path, help="Folder of a site; default: a run without one.")
    options = parser.parse_args()
    sources = [OWN_SOURCE] + ([options.against] if options.against else [])
    # The first start of a checkout compiles its modules.
    for source in sources:
        start_of(source, options.site)
    rounds = [[start_of(source, options.site) for source in sources] for _ in range(options.rounds)]
    own = shown("this", [starts[0] for starts in rounds])
    if options.against:
        other = shown("the other", [starts[1] for starts in rounds])
        elapsed, processor = own.elapsed_s / other.elapsed_s, own.processor_s / other.processor_s
        print(f"ratio     {elapsed:.2f} of the time, {processor:.2f} of the processor time")
    return 0


if __name__ == "__main__":
    sys.exit(main())
