"""The station, its proxy and the companions, as the processes that a user starts."""

import asyncio
import os
import re
import signal
import sys
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

from tests.android.field import GO_HOME_M, ORIGIN, SPACING_M

P = ParamSpec("P")
JAR = os.environ.get("RECON_COMPANION_JAR", "")
IS_THOROUGH = os.environ.get("RECON_THOROUGH") == "1"
"""In `make study-android`: minutes more of the same."""
RECON = str(Path(sys.executable).with_name("recon"))
PATIENCE_S = 60.0


@dataclass(slots=True)
class Running:
    """A process and the lines it has printed."""

    process: asyncio.subprocess.Process
    lines: list[str] = field(default_factory=list)
    _news: asyncio.Condition = field(default_factory=asyncio.Condition)

    async def line(self, pattern: str, after: int = 0) -> re.Match[str]:
        """Wait for a line that contains `pattern`, of those after the first `after`."""
        try:
            async with asyncio.timeout(PATIENCE_S), self._news:
                while True:
                    for line in self.lines[after:]:
                        found = re.search(pattern, line)
                        if found is not None:
                            return found
                    await self._news.wait()
        except TimeoutError:
            printed = "\n".join(self.lines[-30:])
            raise AssertionError(f"no line with {pattern!r} in:\n{printed}") from None

    async def collect(self) -> None:
        """Collect lines until the process ends."""
        assert self.process.stdout is not None
        async for line in self.process.stdout:
            async with self._news:
                self.lines.append(line.decode(errors="replace").rstrip())
                self._news.notify_all()

    def suspend(self) -> None:
        """Stop the process as if the phone slept; its sockets stay open."""
        self.process.send_signal(signal.SIGSTOP)

    def resume(self) -> None:
        """Let a suspended process go on."""
        self.process.send_signal(signal.SIGCONT)


@asynccontextmanager
async def running(*command: str) -> AsyncIterator[Running]:
    """Run a command; end it, and only it, at the end."""
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    process = await asyncio.create_subprocess_exec(
        *command, env=environment, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT
    )
    started = Running(process)
    collector = asyncio.create_task(started.collect())
    try:
        yield started
    finally:
        if process.returncode is None:
            started.resume()
            process.terminate()
            try:
                await asyncio.wait_for(process.wait(), 15.0)
            except TimeoutError:
                process.kill()
        await collector


@dataclass(frozen=True, slots=True)
class RunningStation:
    """A station's process with the addresses it printed."""

    url: str
    link_port: int
    process: Running


@asynccontextmanager
async def station(site: Path, *options: str, link_port: int = 0) -> AsyncIterator[RunningStation]:
    """Run `recon run` on ports that the system chooses."""
    ports = ("--link-port", str(link_port), "--http-port", "0", "--no-guard")
    command = (RECON, "run", "--site", str(site))
    async with running(*command, *ports, *options) as process:
        link = await process.line(r"companion apps: 127\.0\.0\.1:(\d+)")
        console = await process.line(r"console: (http://127\.0\.0\.1:\d+)")
        yield RunningStation(console[1], int(link[1]), process)


@asynccontextmanager
async def proxy(link_port: int, *options: str) -> AsyncIterator[int]:
    """Run `recon sim proxy` before a station; yield the port for apps."""
    command = (RECON, "sim", "proxy")
    addresses = ("--listen", "127.0.0.1:0", "--station", f"127.0.0.1:{link_port}")
    async with running(*command, *addresses, *options) as process:
        yield int((await process.line(r"listening on 127\.0\.0\.1:(\d+)"))[1])


def companion_command(link_port: int, *options: str) -> tuple[str, ...]:
    """Return the command of companions with pads as in `field`."""
    home = f"{ORIGIN.latitude_deg},{ORIGIN.longitude_deg},{ORIGIN.ellipsoid_height_m}"
    places = ("--home", home, "--spacing-m", f"{SPACING_M:g}", "--go-home-m", f"{GO_HOME_M:g}")
    return ("java", "-jar", JAR, "--station", f"127.0.0.1:{link_port}", *places, *options)


def in_loop(test: Callable[P, Coroutine[Any, Any, None]]) -> Callable[P, None]:
    """Run an asynchronous test in an event loop of its own."""

    @wraps(test)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        asyncio.run(test(*args, **kwargs))

    return run


async def until(is_so: Callable[[], bool], what: str, patience_s: float = PATIENCE_S) -> None:
    """Wait for a state."""
    try:
        async with asyncio.timeout(patience_s):
            while not is_so():
                await asyncio.sleep(0.02)
    except TimeoutError:
        raise AssertionError(f"not seen within {patience_s:g} s: {what}") from None
