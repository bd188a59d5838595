"""The vehicles' numbers in a running station, kept in a file so that they survive restarts."""

import threading
from collections.abc import Mapping
from pathlib import Path

import structlog

from recon.fleet.state import Fleet
from recon.record.atomic_file import replace_file
from recon.site.vehicle_numbers import LARGEST_FILE_BYTES, numbers_text, read_numbers, with_new

_log = structlog.get_logger("recon")


class VehicleNumbers:
    """Gives each serial its number, once; a new one is written by a thread, never by the caller.

    What cannot be written is tried again with the next new vehicle. A file that was changed by hand
    since it was read is left alone: the station would undo that change.
    """

    def __init__(self, path: Path | None = None) -> None:
        """Read the numbers from `path`; None keeps them for this run. Raises `SiteError`."""
        self._path = path
        self._numbers: Mapping[str, int] = {} if path is None else read_numbers(path)
        self._known = None if path is None else _content(path)
        self._writing = threading.Lock()

    def of(self, fleet: Fleet) -> Mapping[str, int]:
        """Return the number of each serial: the site's vehicles first, then by first contact."""
        named = [(serial, profile.display_name) for serial, profile in fleet.profiles.items()]
        named += [(serial, vehicle.display_name) for serial, vehicle in fleet.vehicles.items()]
        numbers = with_new(self._numbers, named)
        if numbers is not self._numbers:
            self._numbers = numbers
            if self._path is not None:
                threading.Thread(target=self.write, name="vehicle numbers", daemon=True).start()
        return numbers

    def write(self) -> None:
        """Write the newest numbers; a problem is logged."""
        path = self._path
        if path is None:
            return
        with self._writing:
            data = numbers_text(self._numbers).encode()
            try:
                if _content(path) != self._known:
                    _log.warning(f"{path} was changed by hand; restart the station to read it")
                    return
                replace_file(path, data, 0o644)
            except OSError as problem:
                _log.warning(f"{path} cannot be written: {problem.strerror or problem}")
                return
            self._known = data


def _content(path: Path) -> bytes | None:
    """Return the beginning of a file, enough to notice a change; None without one."""
    try:
        with path.open("rb") as file:
            return file.read(LARGEST_FILE_BYTES + 1)
    except FileNotFoundError:
        return None
