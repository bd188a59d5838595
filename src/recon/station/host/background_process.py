"""A process beside the station for work that is long or may fail: everything else comes first.

It has low priority and half of the memory at most, and is the first that the system ends when
memory is short. Use on a thread: the event loop's own way copies the page tables of all of the
station's memory.
"""

import contextlib
import os
import selectors
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

NICENESS = 15
LEAST_MEMORY_BYTES = 2 * 1024**3
"""Limit on a computer with less than twice as much."""
FIRST_TO_END = b"1000"
"""Of Linux's `oom_score_adj`."""
TICK_S = 0.5
LONGEST_LINE = 64 * 1024


@contextlib.contextmanager
def background_process(
    command: Sequence[str], environment: Mapping[str, str] | None = None, *, merged: bool = False
) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a command until the block ends; its errors are piped, `merged` with its output."""
    nothing, pipe = subprocess.DEVNULL, subprocess.PIPE
    with subprocess.Popen(
        command,
        stdin=nothing,
        stdout=pipe if merged else nothing,
        stderr=subprocess.STDOUT if merged else pipe,
        env=environment,
    ) as process:
        try:
            _hold_back(process.pid)
            yield process
        finally:
            process.kill()


def lines_of(process: "subprocess.Popen[bytes]") -> Iterator[str]:
    """Yield the lines of a process's output as they come, and empty ones at least each `TICK_S`."""
    assert process.stdout is not None
    fd, rest = process.stdout.fileno(), b""
    with selectors.DefaultSelector() as selector:
        selector.register(fd, selectors.EVENT_READ)
        while True:
            if not selector.select(TICK_S):
                yield ""
                continue
            data = os.read(fd, LONGEST_LINE)
            *lines, rest = (rest + data).split(b"\n")
            rest = rest[-LONGEST_LINE:]
            yield from (line.decode(errors="replace") for line in lines)
            yield ""
            if not data:
                yield rest.decode(errors="replace")
                return


def _hold_back(pid: int) -> None:
    """Limit a process that has just been started, as far as this system can."""
    with contextlib.suppress(OSError, AttributeError):
        os.setpriority(os.PRIO_PROCESS, pid, NICENESS)
    with contextlib.suppress(OSError):
        Path(f"/proc/{pid}/oom_score_adj").write_bytes(FIRST_TO_END)
    with contextlib.suppress(OSError, AttributeError, ImportError, ValueError):
        import resource

        half = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
        most = max(LEAST_MEMORY_BYTES, half)
        resource.prlimit(pid, resource.RLIMIT_DATA, (most, most))
