"""Writes the list of apps after a pairing; trouble with its file is an alarm."""

from collections.abc import Callable
from pathlib import Path

from recon.model.event import AppListFailed, Event
from recon.site.app_list import app_list_text
from recon.station.host.rewritten_file import RewrittenFile
from recon.station.state.steps import StepTaken


class AppListWriter:
    """Keeps the file of a running station's list up to date; `report` is called on its thread."""

    def __init__(self, path: Path, report: Callable[[Event], None]) -> None:
        self._file = RewrittenFile(path, lambda problem: report(AppListFailed(problem)))
        self.start, self.close = self._file.start, self._file.close

    def observe(self, step: StepTaken) -> None:
        """Take the entries when a step changed them; never waits."""
        listed = step.after.fleet.admission.listed
        if listed is not step.before.fleet.admission.listed and listed is not None:
            self._file.put(app_list_text(listed).encode())
