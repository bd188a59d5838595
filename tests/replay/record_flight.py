"""A flight in virtual time with its record, made as the station makes one."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from recon.record.audit.audit import AuditEntry
from recon.record.mcap.record_process import RecordProcess
from recon.site import Site
from recon.station.audit.entries import Auditing, audit
from recon.station.kernel.virtual import VirtualDriver
from recon.station.recording.recording import Recorder, record_process
from recon.station.state.steps import StepTaken

FINISHES_WITHIN_S = 120.0
MOST_TAKEN_BYTES = 16 * 1024 * 1024
"""Between two ticks."""


@dataclass(slots=True)
class Recorded:
    """A record being written; its file is finished after the flight."""

    recorder: Recorder

    @property
    def process(self) -> RecordProcess:
        return self.recorder.process

    @property
    def path(self) -> Path:
        assert self.process.path is not None
        return self.process.path


@dataclass(slots=True)
class Audits:
    """The audit of each step, as an auditor has it."""

    memory: Auditing = field(default_factory=Auditing)
    entries: tuple[AuditEntry, ...] = ()

    def observe(self, step: StepTaken) -> None:
        self.memory, self.entries = audit(
            self.memory, step.before, step.event, step.after, step.now_ns
        )


@contextmanager
def recording(
    driver: VirtualDriver, site: Site, folder: Path, scenario: str = ""
) -> Iterator[Recorded]:
    """Record what a driver does within the block; `scenario` states the simulated world."""
    audits = Audits()
    recorder = Recorder(lambda: record_process(folder), driver.handle, audits, site, scenario)

    def take(step: StepTaken) -> None:
        # Virtual time is faster than any disk and any thread: a real flight is not.
        if recorder._encoding is not None:
            recorder._encoding.join()
        while recorder.process.bulk_room_bytes < MOST_TAKEN_BYTES and not recorder.process.is_dead:
            time.sleep(0.001)
        audits.observe(step)
        recorder.take(step)

    if driver.jobs is not None:
        driver.jobs.digests_inputs = True
    driver.record, driver.tap = take, recorder.tap
    recorder.start(driver.station, driver.now_ns)
    try:
        yield Recorded(recorder)
    finally:
        driver.record = driver.tap = None
        recorder.close(FINISHES_WITHIN_S)
    assert recorder.process.problem is None, recorder.process.problem
