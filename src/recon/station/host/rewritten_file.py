"""A file of the site that the station rewrites while it runs, on a thread of its own.

The event loop only hands over the newest content. What cannot be written is tried again every few
seconds, and reported meanwhile. A file that was changed by hand since it was read is left alone:
the station would undo that change.
"""

import threading
from collections.abc import Callable
from pathlib import Path

from recon.model.errors import describe_fault
from recon.record.files.atomic_file import replace_file

RETRY_S = 5.0
CLOSE_WITHIN_S = 3.0
"""A disk that hangs must not keep a stopped station from ending."""

COMPARED_BYTES = 1024 * 1024
"""The beginning of a file, enough to notice a change: the site's lists are smaller."""


class RewrittenFile:
    """Keeps a file up to date."""

    def __init__(self, path: Path, report: Callable[[str | None], None], mode: int = 0o600) -> None:
        """Take the file as it is now; `report` is called on the writer's thread, with a problem, or
        with None once it has ended."""
        self._path = path
        self._report = report
        self._mode = mode
        self._known = _content(path)
        self._latest: bytes | None = None
        self._problem: str | None = None
        self._is_ending = False
        self._wakes = threading.Event()
        self._thread = threading.Thread(target=self._run, name=path.name, daemon=True)

    def start(self) -> None:
        """Begin to wait for content."""
        self._thread.start()

    def put(self, data: bytes) -> None:
        """Take the newest content; never waits."""
        self._latest = data
        self._wakes.set()

    def close(self) -> None:
        """Write what is not written yet, as far as the disk takes it in time, and end."""
        self._is_ending = True
        self._wakes.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_WITHIN_S)

    def _run(self) -> None:
        is_last = False
        while not is_last:
            self._wakes.wait(RETRY_S if self._latest is not None else None)
            self._wakes.clear()
            is_last = self._is_ending
            latest = self._latest
            if latest is not None:
                self._try_to_write(latest)

    def _try_to_write(self, data: bytes) -> None:
        problem = self._problem_of_writing(data)
        if problem is None and self._latest is data:
            self._latest = None
        if problem != self._problem:
            self._problem = problem
            self._report(problem)

    def _problem_of_writing(self, data: bytes) -> str | None:
        try:
            if _content(self._path) != self._known:
                return f"{self._path} was changed by hand; restart the station to read it"
            replace_file(self._path, data, self._mode)
        except OSError as problem:
            return f"{self._path} cannot be written: {problem.strerror or problem}"
        except Exception as fault:
            # This thread must survive whatever is wrong with the file: the next change needs it.
            return f"{self._path} cannot be written: {describe_fault(fault)}"
        self._known = data
        return None


def _content(path: Path) -> bytes | None:
    try:
        with path.open("rb") as file:
            return file.read(COMPARED_BYTES)
    except FileNotFoundError:
        return None
