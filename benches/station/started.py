"""Processes of a measurement: the station as `recon run` starts it, and its companion apps."""

import asyncio
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from recon.site import demo_site_folder

PATIENCE_S = 60.0
APPS = (sys.executable, "-m", "benches.station.fake_apps")


def start_station(
    folder: Path, stack: ExitStack, *, records: bool = False, site: Path | None = None
) -> tuple[subprocess.Popen[str], int, int]:
    """Start `recon run`; return its process, and its ports for apps and for the console."""
    options = ["--site", str(site or demo_site_folder()), "--audit", str(folder / "audit")]
    options += ["--record", str(folder / "records")] if records else ["--no-record"]
    return start_recon(("run", *options), folder, stack)


def start_recon(
    words: Sequence[str], folder: Path, stack: ExitStack
) -> tuple[subprocess.Popen[str], int, int]:
    """Start a station on free ports; its output goes into a file, as under a service manager."""
    log = stack.enter_context((folder / "log").open("w+", encoding="utf-8"))
    process = subprocess.Popen(
        [sys.executable, "-m", "recon", *words, "--link-port", "0", "--http-port", "0"],
        stdout=log,
        stderr=subprocess.STDOUT,
        text=True,
    )
    stack.callback(process.kill)
    end_s = time.monotonic() + PATIENCE_S
    while "console: " not in (said := (folder / "log").read_text(encoding="utf-8")):
        if process.poll() is not None or time.monotonic() > end_s:
            raise RuntimeError(f"expected a station, got: {said}")
        time.sleep(0.05)
    facts = dict(line.split(": ", 1) for line in said.splitlines() if ": " in line)
    link_port = int(facts["companion apps"].rpartition(":")[2])
    return process, link_port, int(facts["console"].rpartition(":")[2])


def start_apps(port: int, stack: ExitStack, *options: object) -> subprocess.Popen[str]:
    """Start apps that fly until their input ends."""
    process = subprocess.Popen(
        [*APPS, str(port), *map(str, options)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    stack.callback(process.kill)
    return process


async def fly_apps(port: int, *options: object) -> dict[str, Any]:
    """Let apps fly for their `--seconds`; return what they sent and read."""
    command = [*APPS, str(port), *map(str, options)]
    process = await asyncio.create_subprocess_exec(*command, stdout=asyncio.subprocess.PIPE)
    said, _ = await process.communicate()
    if process.returncode != 0:
        raise RuntimeError(f"expected the apps to end well, got exit code {process.returncode}")
    told: dict[str, Any] = json.loads(said)
    return told
