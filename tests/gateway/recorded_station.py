"""The record and audit of a running station in this process, and maps as if detected."""

from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader
from tests.replay.record_flight import Audits

from recon.model.geo import GroundGrid, LocalFrame
from recon.model.replacing import replace
from recon.model.shade import ShadeMap, SunForecast
from recon.record.audit.audit_log import AuditLog
from recon.record.mcap.record_process import RecordProcess
from recon.site import Site
from recon.station.kernel.driver import AsyncioDriver
from recon.station.recording.recording import Recorder, record_process
from recon.station.state.imaging import ImagerFrames
from recon.station.state.steps import StepTaken

FINISHES_WITHIN_S = 60.0
Message = tuple[str, str, bytes, int, bytes]
"""Encoding, name and bytes of the schema; time; bytes."""


class RecordedStation:
    """What `running_station` calls to have its driver recorded."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._audits, self._log = Audits(), AuditLog(folder / "audit")
        self.driver: AsyncioDriver | None = None
        self._recorder: Recorder | None = None
        self._process: RecordProcess | None = None

    def attach(self, driver: AsyncioDriver, site: Site) -> AuditLog:
        """Record a driver from before its first event."""
        self._process = record_process(self._folder)
        self.driver, process = driver, self._process
        self._recorder = Recorder(lambda: process, driver.handle, self._audits, site)
        driver.observe, driver.record = self._observe, self._recorder.take
        assert driver.links is not None
        driver.links.tap = self._recorder.tap
        self._recorder.start(driver.station, driver.now_ns())
        return self._log

    def _observe(self, step: StepTaken) -> None:
        self._audits.observe(step)
        for entry in self._audits.entries:
            self._log.put(entry, step.now_ns)

    def detect(self, frame: LocalFrame) -> None:
        """Give the station a shade map and a forecast of this moment."""
        assert self.driver is not None
        station, now_ns = self.driver.station, self.driver.now_ns()
        shade, sun = maps(frame, now_ns)
        line = replace(station.shade, number=station.shade.number + 1, shade=shade, sun=sun)
        # Of an imaging drone that sends nothing: the state shows maps only with one.
        imaging = replace(station.imaging, imagers={"ELSEWHERE": ImagerFrames("ELSEWHERE")})
        self.driver.station = replace(station, shade=line, imaging=imaging)

    def read(self) -> dict[str, list[Message]]:
        """Finish the record; return its messages by topic, as the library reads them."""
        assert self._recorder is not None
        assert self._process is not None
        self._recorder.close(FINISHES_WITHIN_S)
        assert self._process.problem is None, self._process.problem
        assert self._process.path is not None
        found: dict[str, list[Message]] = {}
        with self._process.path.open("rb") as file:
            for schema, channel, message in make_reader(file).iter_messages():
                if schema is not None:
                    content = (channel.message_encoding, schema.name, schema.data)
                    row = (*content, message.log_time, message.data)
                    found.setdefault(channel.topic, []).append(row)
        return found


def maps(frame: LocalFrame, at_ns: int) -> tuple[ShadeMap, SunForecast]:
    """A shade map and a forecast of odd values, partly unknown."""
    random = np.random.default_rng(7)
    grid = GroundGrid(frame, -123.456, 78.9, 5.0, 9, 14)
    valid = random.random((9, 14)) < 0.7

    def values(unknown: float) -> Any:
        return np.where(valid, random.random((9, 14)), unknown).astype(np.float32)

    shade = ShadeMap(grid, at_ns, ("A", "Ü"), values(np.nan), valid, values(0.0), values(np.nan))
    lead_s = np.array([0.0, 15.0, 30.0])
    probability = random.integers(0, 256, (3, 9, 14)).astype(np.uint8)
    horizon_s = np.where(valid, 30.0 * random.random((9, 14)), np.nan).astype(np.float32)
    sun = SunForecast(grid, at_ns, lead_s, probability, horizon_s, 0.4, "test", (1.5, -2.5))
    return shade, sun
