"""Sunlit references: read from the site's folder at the start, written while the flight learns.

A flight may end at any time, so a reference is written every two minutes, by the worker, and
replaces the one before. Detection takes an earlier flight's up by itself (`detection.sunlit`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from recon.detection import DetectionState, sunlit_reference_of
from recon.model.imagery import GroundImage
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.record.reference_file import read_references, write_reference
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import ReferenceKeeping, ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

RULE = "sunlit_reference"
WRITE_EVERY_S = 120.0


@dataclass(frozen=True, slots=True, eq=False)
class WriteReference:
    """What the flight has learned so far, and where it is kept."""

    folder: Path
    detection: DetectionState
    image: GroundImage


def with_references(station: Station, folder: Path) -> Station:
    """Return the station with the references of a site's folder, where it also keeps its own."""
    found, troubles = read_references(folder)
    keeping = ReferenceKeeping(folder, unreadable=troubles)
    detection = replace(station.shade.detection, references=found)
    return replace(station, shade=replace(station.shade, detection=detection, references=keeping))


def written(pipeline: ShadePipeline, image: GroundImage | None) -> tuple[ShadePipeline, "Jobs"]:
    """Return the job that writes what was learned, when it is due."""
    keeping = pipeline.references
    if keeping is None or image is None or image.captured_at_ns < keeping.due_ns:
        return pipeline, ()
    number = keeping.next_job_id
    due_ns = image.captured_at_ns + seconds_to_ns(WRITE_EVERY_S)
    pipeline = replace(pipeline, references=replace(keeping, due_ns=due_ns, next_job_id=number + 1))
    work = WriteReference(keeping.folder, pipeline.detection, image)
    return pipeline, (Job(number, WRITE_REFERENCE, work),)


def conditions(pipeline: ShadePipeline, serial: str | None) -> Iterator[Condition]:
    """Yield what an operator must know of references: files not read, or not written."""
    keeping = pipeline.references
    if keeping is None:
        return
    problems = dict(enumerate(keeping.unreadable))
    if keeping.problem:
        problems[-1] = keeping.problem
    for number, text in problems.items():
        key = f"{RULE}:{number}"
        yield Condition(key, Severity.WARNING, RULE, serial or "", text, serial)


def _write(work: WriteReference) -> None:
    """Write a reference, if enough was learned; raises `RecordError`."""
    reference = sunlit_reference_of(work.detection, work.image)
    if reference is not None:
        write_reference(work.folder, reference)


def _with_problem(station: Station, problem: str) -> Stepped:
    keeping = station.shade.references
    assert keeping is not None
    keeping = replace(keeping, problem=problem)
    return replace(station, shade=replace(station.shade, references=keeping)), ()


WRITE_REFERENCE: JobKind[WriteReference, None] = JobKind(
    "write_reference",
    lambda _site: _write,
    lambda station, _job_id, _done, _now_ns: _with_problem(station, ""),
    lambda station, _job_id, error, _now_ns: _with_problem(station, error),
    lambda station, _job_id, _now_ns: (station, ()),
)
"""Writes what a flight has learned of the land into the site's folder."""

Jobs = tuple[Job[WriteReference, None], ...]
