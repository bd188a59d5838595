"""A simulated survey with its flight record and the photos on the drones' cards, with known truth.

The whole station flies in virtual time and is recorded as a real one is; its photos are those of
`recon sim photos`, from the record alone.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt
from tests.replay.record_flight import recording

from recon.cli.sim_photos import simulated_truth
from recon.model.event import ClockRead
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData
from recon.product.flight_reader import read_flight
from recon.score.ideal_detection import IdealDetection
from recon.score.run import StationRun
from recon.score.scenario import Scenario
from recon.score.scenario_sky import sky_of
from recon.score.survey_photos import card_of, shots_of
from recon.score.true_frames import FleetFrames
from recon.score.truth import Truth, world_text
from recon.sim.camera.field import FieldRenderer
from recon.sim.photos.card import CardSettings, PhotoShot, true_ground_m
from recon.sim.world.relief import Relief
from recon.station.imaging.shade import READ_SHADE

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SurveyFlown:
    """A recorded flight, and the truth of it."""

    path: Path
    """The scenario's file."""
    record: Path
    settings: CardSettings
    """Of the photos."""

    @cached_property
    def flight(self) -> FlightData:
        """The flight, as the product reads it."""
        return read_flight(self.record)

    @cached_property
    def truth(self) -> Truth:
        """The simulated sky."""
        return simulated_truth(self.flight, self.path)

    @cached_property
    def shots(self) -> dict[str, PhotoShot]:
        """The photos that were taken, by name."""
        return {shot.name: shot for shot in shots_of(self.flight, self.truth)}

    @cached_property
    def world(self) -> FieldRenderer:
        """The land and the sky, as one of the imaging drones' cameras sees them."""
        return card_of(self.flight, self.truth, self.settings).world

    @property
    def relief(self) -> Relief | None:
        """The ground's heights."""
        return self.world.relief

    def ground_m(self, shot: PhotoShot, cols: int, rows: int) -> FloatArray:
        """Return where each pixel of a photo of that size truly lies, (rows, cols, 2) metres."""
        found = true_ground_m(shot, self.settings.camera, cols, rows, self.relief)
        return found.astype(np.float64)

    def sunlit(self, shot: PhotoShot, cols: int, rows: int) -> FloatArray:
        """Return the true transmittance on a photo's pixels, (rows, cols)."""
        east_m, north_m = np.moveaxis(self.ground_m(shot, cols, rows), -1, 0)
        return self.truth.sky.transmittance(east_m, north_m, shot.at_s).astype(np.float64)


class ExactDetection(IdealDetection):
    """The true sky at the time and on the ground that a shade map states: maps without errors."""

    def _shade(self, image: GroundImage) -> ShadeMap:
        sun = self._sky.on_grid(image.grid, image.captured_at_ns / NS_PER_S)
        transmittance = np.where(image.valid, sun, np.nan).astype(np.float32)
        sure = image.valid.astype(np.float32)
        return ShadeMap(
            image.grid,
            image.captured_at_ns,
            (image.serial,),
            transmittance,
            image.valid,
            sure,
            sure,
        )


def fly(
    path: Path,
    scenario: Scenario,
    seed: int,
    folder: Path,
    settings: CardSettings,
    limit_s: float = 3600.0,
    *,
    is_exact: bool = False,
) -> SurveyFlown:
    """Fly a scenario's survey to its end or for so long, and record it into a folder.

    `path` is the scenario's file; `is_exact` replaces the maps of ideal detection, which are
    projected by telemetry, by true ones.
    """
    run = StationRun(scenario, seed)
    sky = sky_of(scenario, seed)
    if is_exact:
        jobs = run.driver.jobs
        assert jobs is not None
        exact = ExactDetection(scenario, sky, FleetFrames({}), shows_sun=True)
        jobs.replace(READ_SHADE, exact.read)
    epoch_ns = round(sky.settings.sun.start_utc_s * NS_PER_S)
    driver = run.driver
    with recording(driver, scenario.site, folder, world_text(path, seed, 0)) as record:
        driver.tap = None  # What links carry would only cost time here.
        driver.handle(ClockRead(epoch_ns + driver.now_ns))
        while run.now_s < limit_s and not _is_over(run):
            run.advance_a_second()
    return SurveyFlown(path, record.path, settings)


def _is_over(run: StationRun) -> bool:
    record = run.record
    return record is not None and record.is_over and not any(p.is_up[-1] for p in run.drones)
