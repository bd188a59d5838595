"""Recon as a process of its own: started, read, stopped by a signal.

They are forked from one that has imported what a station, a simulator and a demo need: importing
that costs two seconds of a core each time. `test_startup.py`, the tests of the docs and those of
the console start `recon` from its first instruction.
"""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from queue import Empty, Queue
from threading import Thread

PATIENCE_S = 120.0

_FORKING = get_context("forkserver")
_FORKING.set_forkserver_preload(["recon.cli.commands", "recon.cli.demo"])


def _run(options: tuple[str, ...], environment: dict[str, str], output: Connection) -> None:
    """In the new process: be `python -m recon`, with this output."""
    os.setsid()
    for descriptor in (1, 2):
        os.dup2(output.fileno(), descriptor)
    output.close()
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["recon", *options]
    from recon.cli import main

    main()


class Started:
    """A running process whose lines are read as they come."""

    def __init__(self, *options: str) -> None:
        self._output, written = os.pipe()
        with Connection(written, readable=False) as output:
            given = (options, dict(os.environ), output)
            self._process = _FORKING.Process(target=_run, args=given)
            self._process.start()
        assert self._process.pid is not None
        self.pid = self._process.pid
        self.lines: list[str] = []
        self._arriving: Queue[str | None] = Queue()
        self._thread = Thread(target=self._read, daemon=True)
        self._thread.start()

    def line_with(self, words: str) -> str:
        """Wait for a line that contains these words."""
        for line in self.lines:
            if words in line:
                return line
        while (line := self._next()) is not None:
            if words in line:
                return line
        raise AssertionError(f"it ended without printing {words!r}: {self.text}")

    def end(self, signal_number: int) -> int:
        """Send a signal and wait; return the exit code."""
        self.send(signal_number)
        return self.wait()

    def send(self, signal_number: int) -> None:
        """Send a signal; one that has ended since it was looked at gets none."""
        with suppress(ProcessLookupError):
            os.kill(self.pid, signal_number)

    @property
    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._process.is_alive()

    def wait(self) -> int:
        """Wait for its end; return the exit code."""
        self._process.join(PATIENCE_S)
        code = self._process.exitcode
        assert code is not None, self.text
        while self._next() is not None:
            pass
        return code

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    def close(self) -> None:
        # With all that it started: what lives on would hold its output open.
        with suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.kill()
        self._process.join()
        self._process.close()
        self._thread.join()

    def _next(self) -> str | None:
        try:
            line = self._arriving.get(timeout=PATIENCE_S)
        except Empty:
            raise AssertionError(f"nothing more came after: {self.text}") from None
        if line is not None:
            self.lines.append(line)
        return line

    def _read(self) -> None:
        with open(self._output, encoding="utf-8") as lines:
            for line in lines:
                self._arriving.put(line.rstrip("\n"))
        self._arriving.put(None)


@contextmanager
def started(*options: str) -> Iterator[Started]:
    """Run `recon` with options; it is gone afterwards."""
    process = Started(*options)
    try:
        yield process
    finally:
        process.close()
