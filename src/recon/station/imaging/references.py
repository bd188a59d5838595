"""Sunlit references: read from the site's folder at the start, written while the flight learns.

A flight may end at any time, so a reference is written every two minutes, by the worker, and
replaces the one before. Detection takes an earlier flight's up automatically (`detection.sunlit`).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from recon.detection import DetectionState, sunlit_reference_of
from recon.model.imagery import GroundImage
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.record.raster.reference_file import read_references, write_reference
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import Imaging, ReferenceKeeping, ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

RULE = "sunlit_reference"
WRITE_EVERY_S = 120.0


@dataclass(frozen=True, slots=True, eq=False)
class WriteReference:
    """What the flight has learned so far of each imaging drone's land, and where it is kept."""

    folder: Path
    learned: tuple[tuple[DetectionState, GroundImage], ...]


def with_references(station: Station, folder: Path) -> Station:
    """Return the station with the references of a site's folder, where it also keeps its own."""
    found, troubles = read_references(folder)
    keeping = ReferenceKeeping(folder, found, unreadable=troubles)
    return replace(station, shade=replace(station.shade, references=keeping))


def written(pipeline: ShadePipeline, imaging: Imaging) -> tuple[ShadePipeline, "Jobs"]:
    """Return the job that writes what was learned, when it is due."""
    keeping, shade = pipeline.references, pipeline.shade
    if keeping is None or shade is None or shade.captured_at_ns < keeping.due_ns:
        return pipeline, ()
    number = keeping.next_job_id
    due_ns = shade.captured_at_ns + seconds_to_ns(WRITE_EVERY_S)
    pipeline = replace(pipeline, references=replace(keeping, due_ns=due_ns, next_job_id=number + 1))
    images = ((s, each.ground_image) for s, each in imaging.imagers.items())
    known = pipeline.detections
    learned = tuple((known[s], image) for s, image in images if s in known and image is not None)
    return pipeline, (Job(number, WRITE_REFERENCE, WriteReference(keeping.folder, learned)),)


def conditions(pipeline: ShadePipeline) -> Iterator[Condition]:
    """Yield what an operator must know of references: files not read, or not written."""
    keeping = pipeline.references
    if keeping is None:
        return
    problems = dict(enumerate(keeping.unreadable))
    if keeping.problem:
        problems[-1] = keeping.problem
    for number, text in problems.items():
        key = f"{RULE}:{number}"
        yield Condition(key, Severity.WARNING, RULE, "", text)


def _write(work: WriteReference) -> None:
    """Write the references for which enough was learned; raises `RecordError`."""
    for detection, image in work.learned:
        reference = sunlit_reference_of(detection, image)
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
    acts=True,
)
"""Writes what a flight has learned of the land into the site's folder."""

Jobs = tuple[Job[WriteReference, None], ...]
