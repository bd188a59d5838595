"""Recon as a process of its own: started, read, stopped by a signal."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from queue import Empty, Queue
from threading import Thread

PATIENCE_S = 120.0


class Started:
    """A running process whose lines are read as they come."""

    def __init__(self, *options: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "recon", *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
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
        self.process.send_signal(signal_number)
        return self.wait()

    def wait(self) -> int:
        """Wait for its end; return the exit code."""
        code = self.process.wait(PATIENCE_S)
        while self._next() is not None:
            pass
        return code

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    def close(self) -> None:
        # With all that it started: what lives on would hold its output open.
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self._thread.join()
        assert self.process.stdout is not None
        self.process.stdout.close()

    def _next(self) -> str | None:
        try:
            line = self._arriving.get(timeout=PATIENCE_S)
        except Empty:
            raise AssertionError(f"nothing more came after: {self.text}") from None
        if line is not None:
            self.lines.append(line)
        return line

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
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
