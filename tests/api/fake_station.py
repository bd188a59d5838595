"""A station that the API can be put around, and its application under test."""

from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

import numpy as np

from recon.api.schema import StationState
from recon.api.security import Access, AccessCheck
from recon.model.event import OperatorOrder
from recon.model.imagery import Frame, GroundImage
from recon.site import Site, default_site
from recon.station.api_views.app import create_app
from recon.station.api_views.edited_site import EditedSite
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver
from recon.station.kernel.worker import AnyJob, JobRunner
from recon.station.state.steps import StepTaken


@dataclass
class WorkerAtOnce:
    """Runs each job at once, on the caller's thread."""

    jobs: JobRunner
    driver: AsyncioDriver

    def submit(self, job: AnyJob) -> None:
        self.driver.handle(self.jobs.run(job))


class FakeStation(Service):
    """The real service around a station without sockets; pictures are put in by hand."""

    driver: AsyncioDriver

    def __init__(self, site: Site | None = None) -> None:
        site = site or default_site()
        self.now_ns = 1_000_000_000
        self.image: GroundImage | None = None
        self.states_made = 0
        self.asked: list[OperatorOrder] = []
        """The orders that have reached the station."""
        driver = AsyncioDriver(first_state(site), lambda: self.now_ns, self._observe)
        driver.worker = WorkerAtOnce(JobRunner(site), driver)
        super().__init__(driver, EditedSite(driver, site, None), [], None, None, count(1).__next__)

    def _observe(self, step: StepTaken) -> None:
        if isinstance(step.event, OperatorOrder):
            self.asked.append(step.event)

    def state(self) -> StationState:
        self.states_made += 1
        return super().state()

    def put_frame(self, serial: str, frame: Frame) -> None:
        frames = {**self.driver.station.frames, serial: frame}
        self.driver.station = replace(self.driver.station, frames=frames)

    def ground_image(self) -> GroundImage | None:
        return self.image


def application(
    station: FakeStation, *, access: Access | None = None, console: Path | None = None
) -> AccessCheck:
    return AccessCheck(create_app(station, console, "1.2.3"), access or Access())


def rgb_frame(serial: str) -> Frame:
    """Return a frame whose left half is red and right half blue."""
    rgb = np.zeros((32, 64, 3), np.uint8)
    rgb[:, :32, 0] = 255
    rgb[:, 32:, 2] = 255
    return Frame(7, serial, 0, 0, 0.25, rgb=rgb)
