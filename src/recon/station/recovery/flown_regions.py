"""Keeps what is flown of the site's regions: rows, camera, and when each cell was imaged.

The event loop only hands over the newest station, which is an immutable value. A thread compares
each started survey of a named region with what it saw last, notes the time of every cell that has
risen, and writes the region's file: at most every two seconds, so that a killed process loses
seconds. Surveys in flight are not continued from it: it is read for the next one that an operator
asks for. A survey that simulated drones fly has a file of its own.
"""

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from recon.geo.grid_cells import nearest_cells
from recon.guidance.survey import SurveyState
from recon.guidance.survey.again import kept_lattice, origin_fault
from recon.guidance.survey.progress import first_progress
from recon.model.errors import describe_fault
from recon.model.flown_before import StateArray
from recon.model.flown_region import FlownRegion, region_key
from recon.model.units import NS_PER_S
from recon.record.files.flown_region_file import read_regions, write_region
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken
from recon.station.state.survey_record import SurveyRecord

WRITE_EVERY_S = 2.0
CLOSE_WITHIN_S = 3.0
"""A disk that hangs must not keep a stopped station from ending."""

Write = Callable[[Path, FlownRegion], None]


class FlownRegions:
    """The surveyed regions of a station's site, by key; without a folder they last for its run."""

    def __init__(self, folder: Path | None = None, write: Write = write_region) -> None:
        found, troubles = ((), ()) if folder is None else read_regions(folder)
        self.troubles: Sequence[str] = troubles
        """A sentence for each file that could not be read."""
        self.problem: str | None = None
        """Why they cannot be written, while that is so."""
        self._folder = folder
        self._write = write
        self._regions: Mapping[str, FlownRegion] = {each.key: each for each in found}
        self._seen: dict[int, StateArray] = {}
        """The states of each started survey's cells that have counted so far, by its id."""
        self._unwritten: set[str] = set()
        self._latest: tuple[Station, int] | None = None
        self._taken: tuple[Station, int] | None = None
        self._turn = threading.Lock()
        self._wakes = threading.Event()
        self._is_ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="flown regions", daemon=True)

    @property
    def all(self) -> Sequence[FlownRegion]:
        """All of them, the one flown last first."""
        return sorted(self._regions.values(), key=lambda each: each.started_s, reverse=True)

    def get(self, key: str) -> FlownRegion | None:
        """Return the region of a key."""
        return self._regions.get(key)

    def start(self) -> None:
        """Begin to take notes."""
        self._thread.start()

    def observe(self, step: StepTaken) -> None:
        """Take the newest station; never waits."""
        if step.after.surveys is not step.before.surveys:
            self._latest = (step.after, step.now_ns)
            self._wakes.set()

    def close(self) -> None:
        """Write the last state, as far as the disk takes it in time, and end."""
        self._is_ending.set()
        self._wakes.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_WITHIN_S)

    def _run(self) -> None:
        while not self._is_ending.is_set():
            self._wakes.wait(None if not self._unwritten else WRITE_EVERY_S)
            self._wakes.clear()
            self.note()
            self._is_ending.wait(WRITE_EVERY_S)
        self.note()

    def note(self) -> None:
        """Note and write what the newest station has that is not kept yet.

        The thread does so every two seconds; one that answers an operator may do so before.
        """
        with self._turn:
            self._note()

    def _note(self) -> None:
        latest = self._latest
        try:
            if latest is not None and latest is not self._taken:
                self._take(*latest)
                self._taken = latest
            self._write_all()
        except OSError as problem:
            self.problem = f"surveyed regions: {problem.strerror or problem}"
        except Exception as fault:
            # This thread must survive whatever is wrong: the next survey needs it.
            self.problem = f"surveyed regions: {describe_fault(fault)}"
        else:
            self.problem = None

    def _take(self, station: Station, now_ns: int) -> None:
        changed: dict[str, FlownRegion] = {}
        records = station.surveys.records
        self._seen = {key: seen for key, seen in self._seen.items() if key in records}
        for record, state in _started(station):
            key = region_key(record.survey, is_simulated=_is_simulated(station, record))
            before = changed.get(key) or self._regions.get(key)
            seen = self._seen.get(record.survey.id)
            is_first = before is None or seen is None
            if seen is None:
                seen = first_progress(state.plan).state
            elif seen is state.progress.state:
                continue
            region = _begun(station, record, state, before) if is_first else before
            assert region is not None
            progress = state.progress
            after = region.with_imaged(
                seen, progress.state, progress.is_sun_known, now_ns // NS_PER_S
            )
            self._seen[record.survey.id] = progress.state
            if after is not before:
                changed[key] = after
        self._regions = {**self._regions, **changed}
        self._unwritten |= changed.keys()

    def _write_all(self) -> None:
        for key in tuple(self._unwritten):
            if self._folder is not None:
                self._write(self._folder, self._regions[key])
            self._unwritten.discard(key)


def _started(station: Station) -> Iterator[tuple[SurveyRecord, SurveyState]]:
    """Yield the surveys of named regions that have been started, the oldest first."""
    for record in station.surveys.records.values():
        state = record.state
        if record.survey.region_name and state is not None and state.started_at_ns is not None:
            yield record, state


def _is_simulated(station: Station, record: SurveyRecord) -> bool:
    known = (station.fleet.vehicles.get(serial) for serial in record.members)
    return any(each is not None and each.is_simulated for each in known)


def _begun(
    station: Station, record: SurveyRecord, state: SurveyState, before: FlownRegion | None
) -> FlownRegion:
    """Return the region as a survey begins it; the times of its cells are those of before."""
    survey, cells = record.survey, state.plan.cells
    assert state.started_at_ns is not None, "it is started"
    started_s = state.started_at_ns // NS_PER_S
    shape = cells.grid.rows, cells.grid.cols
    begun = FlownRegion(
        survey=replace(survey, id=0, lattice=None, flown=None, rows_note=""),
        lattice=kept_lattice(state.plan.lattice),
        grid=cells.grid,
        is_reached=cells.is_reached,
        is_light_known=np.zeros(shape, dtype=np.bool_),
        imaged_s=np.zeros(shape, dtype=np.uint32),
        in_sun_s=np.zeros(shape, dtype=np.uint32),
        begun_s=started_s if survey.flown is None else survey.flown.since_s,
        started_s=started_s,
        is_simulated=_is_simulated(station, record),
    )
    if before is None or origin_fault(before, cells.grid.frame) is not None:
        return begun
    rows, cols, is_on = nearest_cells(before.grid, cells.grid)
    return replace(
        begun,
        is_light_known=is_on & before.is_light_known[rows, cols],
        imaged_s=np.where(is_on, before.imaged_s[rows, cols], np.uint32(0)),
        in_sun_s=np.where(is_on, before.in_sun_s[rows, cols], np.uint32(0)),
    )
