"""Writes the list of apps after a pairing, on a thread of its own.

The event loop only hands over the new entries. What cannot be written is tried again every few
seconds, with an alarm meanwhile. A file that was changed by hand since it was read is left alone:
the station would undo that change.
"""

import threading
from collections.abc import Callable
from pathlib import Path

from recon.fleet.admission import AllowedApp
from recon.model.errors import describe_fault
from recon.model.event import AppListFailed, Event
from recon.record.atomic_file import replace_file
from recon.site.app_list import LARGEST_FILE_BYTES, app_list_text
from recon.station.state.station import Station

RETRY_S = 5.0
CLOSE_WITHIN_S = 3.0
"""A disk that hangs must not keep a stopped station from ending."""


class AppListWriter:
    """Keeps the file of a running station's list up to date; `report` is called on its thread."""

    def __init__(self, path: Path, report: Callable[[Event], None]) -> None:
        self._path = path
        self._report = report
        self._known = _content(path)
        self._latest: tuple[AllowedApp, ...] | None = None
        self._is_failing = self._is_ending = False
        self._wakes = threading.Event()
        self._thread = threading.Thread(target=self._run, name="app list", daemon=True)

    def start(self) -> None:
        """Begin to wait for changes."""
        self._thread.start()

    def observe(self, before: Station, after: Station, _event: Event) -> None:
        """Take the entries when a step changed them; never waits."""
        listed = after.fleet.admission.listed
        if listed is not before.fleet.admission.listed and listed is not None:
            self._latest = listed
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
            listed = self._latest
            if listed is not None:
                self._try_to_write(listed)

    def _try_to_write(self, listed: tuple[AllowedApp, ...]) -> None:
        problem = self._problem_of_writing(listed)
        if problem is None and self._latest is listed:
            self._latest = None
        if problem is not None or self._is_failing:
            self._is_failing = problem is not None
            self._report(AppListFailed(problem))

    def _problem_of_writing(self, listed: tuple[AllowedApp, ...]) -> str | None:
        data = app_list_text(listed).encode()
        try:
            if _content(self._path) != self._known:
                return f"{self._path} was changed by hand; restart the station to read it"
            replace_file(self._path, data)
        except OSError as problem:
            return f"{self._path} cannot be written: {problem.strerror or problem}"
        except Exception as fault:
            # This thread must survive whatever is wrong with the file: the next pairing needs it.
            return f"{self._path} cannot be written: {describe_fault(fault)}"
        self._known = data
        return None


def _content(path: Path) -> bytes | None:
    """Return the beginning of a file, enough to notice a change; None without one."""
    try:
        with path.open("rb") as file:
            return file.read(LARGEST_FILE_BYTES + 1)
    except FileNotFoundError:
        return None
