"""A flight in virtual time with its record, made as the station makes one."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from recon.record.audit import AuditEntry
from recon.record.record_writer import RecordWriter
from recon.site import Site
from recon.station.audit.entries import Auditing, audit
from recon.station.kernel.recorded_values import FlightStart
from recon.station.kernel.recording import Recorder, record_writer
from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.steps import StepTaken


@dataclass(slots=True)
class Recorded:
    """A record being written; its file is finished after the flight."""

    writer: RecordWriter

    @property
    def path(self) -> Path:
        assert self.writer.path is not None
        return self.writer.path


def entries_of() -> Callable[[StepTaken], tuple[AuditEntry, ...]]:
    """The audit of each step, as an auditor has it."""
    memory = Auditing()

    def entries(step: StepTaken) -> tuple[AuditEntry, ...]:
        nonlocal memory
        memory, found = audit(memory, step.before, step.event, step.after, step.now_ns)
        return found

    return entries


@contextmanager
def recording(driver: VirtualDriver, site: Site, folder: Path) -> Iterator[Recorded]:
    """Record what a driver does within the block."""
    writer = record_writer(folder, FlightStart.now(site, driver.station, driver.now_ns))
    recorder = Recorder(writer, driver.handle, entries_of())

    def take(step: StepTaken) -> None:
        # Virtual time is faster than any disk: a real flight is not.
        while not writer.has_room:
            time.sleep(0.001)
        recorder.take(step)

    driver.record, driver.tap = take, recorder.tap
    writer.start()
    try:
        yield Recorded(writer)
    finally:
        driver.record = driver.tap = None
        writer.close(within_s=120.0)
    assert writer.problem is None, writer.problem
