"""Uses an installed Recon as its user does, and prints how long each part took.

    python3 tools/try_install.py BIN             # the demonstration's page and console files
    python3 tools/try_install.py BIN --flight    # and a survey, another one from the shell, a score

BIN is the folder of `recon`; BEGAN in the environment is when its installation began, in seconds
of Unix time. Needs Python alone: it runs where nothing else is installed.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.request import ProxyHandler, build_opener

PATIENCE_S, FLIGHT_S = 60.0, 900.0
LOG = Path("demo.log")
ADDRESS = re.compile(r"^console: (\S+)$", re.MULTILINE)
RECORDS = re.compile(r"^records: (.+)$", re.MULTILINE)
FAULT = re.compile(r"Traceback|Error\b")
NAMED = re.compile(r"""(?:src|href)=["']([^"':]+)["']""")
READS_NO_GEOPACKAGE = "pip install 'recon-gcs[imports]'"
fetch = build_opener(ProxyHandler({})).open


def main() -> None:
    """Run all parts; ends with exit code 1 and a sentence at the first that fails."""
    recon, flies = Path(sys.argv[1]).resolve() / "recon", "--flight" in sys.argv
    with TemporaryDirectory(prefix="recon-try-") as folder:
        os.chdir(folder)
        with demonstration(recon) as url:
            if flies:
                survey(recon, url)
        if flies:
            with timed("the flight again, compared to the bit"):
                run(recon, "replay", "--check", str(newest_record()))
            extras_are_named(recon)
            with timed("score of one seed"):
                run(recon, "score", "clear-sky", "--seeds", "1", "--surveys-only")


@contextmanager
def timed(what: str) -> Iterator[None]:
    """Print how long the work inside took."""
    began_s = time.monotonic()
    yield
    print(f"{what}: {time.monotonic() - began_s:.1f} s", flush=True)


@contextmanager
def demonstration(recon: Path) -> Iterator[str]:
    """Run `recon demo`; give the console's address when its files are served."""
    ports = ("--http-port", "0", "--link-port", "0")
    began_s = time.monotonic()
    with LOG.open("w") as printed:
        demo = subprocess.Popen([recon, "demo", *ports], stdout=printed)
    try:
        until(lambda: demo.poll() is not None or ADDRESS.search(LOG.read_text()), PATIENCE_S)
        (url,) = ADDRESS.findall(LOG.read_text()) or sys.exit("try_install: no console's address")
        page = read(f"{url}/")
        print(f"demo to first page: {time.monotonic() - began_s:.1f} s", flush=True)
        if "BEGAN" in os.environ:
            since_s = time.time() - float(os.environ["BEGAN"])
            print(f"installation to first page: {since_s:.1f} s", flush=True)
        files = [name.removeprefix("./").lstrip("/") for name in NAMED.findall(page.decode())]
        require(len(files) > 2, f"expected a page that names its files, got {files}")
        sizes = [len(read(f"{url}/{name}")) for name in files]
        print(f"console: {len(files)} files, {sum(sizes) / 1e6:.1f} MB", flush=True)
        yield url
        children = children_of(demo.pid)
    finally:
        demo.send_signal(signal.SIGINT)
        try:
            code = demo.wait(PATIENCE_S)
        finally:
            demo.kill()
    require(code == 0, f"recon demo: expected exit code 0, got {code}")
    wrong = [line for line in LOG.read_text().splitlines() if FAULT.search(line)]
    require(not wrong, f"recon demo: expected no fault, got: {wrong}")
    require(bool(children), "recon demo: expected processes beside the station, got none")
    until(lambda: not any(Path(f"/proc/{each}").exists() for each in children), PATIENCE_S)


def newest_record() -> Path:
    """Return the demonstration's last flight record."""
    (folder,) = RECORDS.findall(LOG.read_text()) or sys.exit("try_install: no folder of records")
    return max(Path(folder).glob("*.mcap"), key=lambda path: path.stat().st_mtime)


def read(url: str) -> bytes:
    """Return what the station sends for an address."""
    with fetch(url, timeout=PATIENCE_S) as answer:
        return bytes(answer.read())


def children_of(pid: int) -> list[str]:
    """Return the processes that a process has started."""
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def survey(recon: Path, url: str) -> None:
    """Wait for the first row of the demonstration's survey, then fly one from the shell."""
    with timed("first imaged row of the demonstration"):
        until(lambda: has_row(recon, url, 1), FLIGHT_S)
    run(recon, "survey", "abort", "1", station=url)
    region = ("west field", "--height", "40", "--json")
    number = json.loads(run(recon, "survey", "create", *region, station=url))["id"]
    with timed("first imaged row of a survey from the shell"):
        run(recon, "survey", "start", str(number), "SIM-1", "SIM-2", "--takeoff", station=url)
        until(lambda: has_row(recon, url, number), FLIGHT_S)
    run(recon, "fleet-return", "--wait", "0", station=url)


def has_row(recon: Path, url: str, number: int) -> bool:
    """Whether a survey has imaged as much ground as one row has; a busy computer is asked again."""
    surveys = json.loads(run(recon, "survey", "status", "--json", station=url, otherwise="[]"))
    of_number: dict[str, Any] = next((s for s in surveys if s["id"] == number), {})
    figures = of_number.get("figures")
    if figures is None:
        return False
    reached_m2 = figures["reached_m2"]
    return bool(reached_m2 - figures["not_yet_m2"] >= reached_m2 / of_number["rows"] > 0.0)


def extras_are_named(recon: Path) -> None:
    """Check that a file which only an extra reads is refused with the extra's name."""
    Path("field.gpkg").write_bytes(b"SQLite format 3\x00" + bytes(1000))
    words = (recon, "plan", "field.gpkg", "--height", "40")
    refused = subprocess.run(words, capture_output=True, text=True, check=False)
    said = " ".join(refused.stderr.split())
    require(READS_NO_GEOPACKAGE in said, f"expected {READS_NO_GEOPACKAGE}, got {said}")


def run(recon: Path, *words: str, station: str = "", otherwise: str | None = None) -> str:
    """Return what a command prints, or `otherwise`; without it one that fails ends everything."""
    environment = {**os.environ, "RECON_STATION": station} if station else None
    ended = subprocess.run(
        (recon, *words), env=environment, capture_output=True, text=True, check=False
    )
    if ended.returncode != 0 and otherwise is not None:
        return otherwise
    said = (ended.stderr or ended.stdout)[-500:]
    require(ended.returncode == 0, f"recon {' '.join(words)}: exit code {ended.returncode}: {said}")
    return ended.stdout


def until(is_so: Callable[[], object], within_s: float) -> None:
    """Wait until something is so."""
    give_up_at_s = time.monotonic() + within_s
    while not is_so():
        require(time.monotonic() < give_up_at_s, f"expected it within {within_s:g} s")
        time.sleep(0.2)


def require(is_so: bool, otherwise: str) -> None:
    """End with a sentence where something is not so."""
    if not is_so:
        sys.exit(f"try_install: {otherwise}")


if __name__ == "__main__":
    main()
