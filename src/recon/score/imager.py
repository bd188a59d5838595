"""The imaging drone of a run: rendered frames for the station's detector, or true shade maps.

With ideal detection, frames of a few pixels are sent over the link, with latency and faults; the
worker then returns the true shade map of the capture time instead of reading the pixels.
"""

from dataclasses import dataclass, replace

import numpy as np

from recon.forecast import FORECASTERS
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, GroundImage, RgbImage
from recon.model.shade import MaskMap, ShadeMap
from recon.model.units import NS_PER_S
from recon.score.scenario import IDEAL, NO_FORECAST, Scenario
from recon.score.simulation import simulation_of
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.camera.frames import CameraView
from recon.sim.fleet import IMAGER_SERIAL, SimulationConfig
from recon.sim.world import Sky
from recon.station.imaging.frames import LAY_FRAME
from recon.station.imaging.projection import LaidFrame
from recon.station.imaging.shade import READ_SHADE, ReadShade, ShadeRead
from recon.station.kernel.worker import JobRunner
from recon.station.state.imaging import LayFrame
from recon.station.state.settings import StationSettings

PLACEHOLDER_PX = 8
METRES_PER_PIXEL = 0.5


@dataclass(frozen=True, slots=True)
class Placeholders:
    """Frames whose pixels are not read."""

    def prepare(self) -> None:
        """Do nothing: there is nothing to render."""

    def render(self, view: CameraView) -> RgbImage:
        """Return a grey frame; its level depends on the number, as repeated frames are rejected."""
        level = 1 + view.number % 250
        return np.full((PLACEHOLDER_PX, PLACEHOLDER_PX, 3), level, dtype=np.uint8)


def config_of(scenario: Scenario, seed: int) -> SimulationConfig:
    """Return the scenario's simulation, with rendered frames only where they are read."""
    feed = FeedSettings(1.0 / scenario.imager.period_s, ImageFormat.RAW)
    config = simulation_of(scenario, seed, feed)
    if scenario.methods.detection != IDEAL or config.imager is None:
        return config
    return replace(config, imager=replace(config.imager, source=Placeholders()))


def settings_of(scenario: Scenario) -> StationSettings:
    """Return the station's settings with the scenario's methods."""
    settings, methods = StationSettings(), scenario.methods
    if methods.detection != IDEAL:
        detection = replace(settings.detection, method=methods.detection)
        settings = replace(settings, detection=detection)
    if methods.forecast != NO_FORECAST:
        settings = replace(settings, forecast=replace(settings.forecast, method=methods.forecast))
    return settings


def jobs_of(scenario: Scenario, sky: Sky, grid: GroundGrid, footprint: MaskMap) -> JobRunner:
    """Return the runner of the station's jobs; with ideal detection it reads the truth of `sky`."""
    jobs = JobRunner(scenario.site)
    if scenario.methods.detection != IDEAL:
        return jobs

    def lay(work: LayFrame) -> LaidFrame:
        nothing = np.zeros((grid.rows, grid.cols, 3), dtype=np.uint8)
        pose = CameraPose(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
        frame = work.frame
        image = GroundImage(
            grid, frame.id, frame.captured_at_ns, nothing, footprint, pose, serial=IMAGER_SERIAL
        )
        return LaidFrame(image)

    def read(work: ReadShade) -> ShadeRead:
        shade = true_shade(sky, grid, footprint, work.image.captured_at_ns)
        method = FORECASTERS[work.forecast_settings.method]
        forecast, sun = method(work.forecast, shade, work.forecast_settings)
        return ShadeRead(work.detection, forecast, (shade, sun))

    jobs.replace(LAY_FRAME, lay)
    jobs.replace(READ_SHADE, read)
    return jobs


def true_shade(sky: Sky, grid: GroundGrid, footprint: MaskMap, at_ns: int) -> ShadeMap:
    """Return the true shade map of a moment, valid in the footprint."""
    truth = np.where(footprint, sky.on_grid(grid, at_ns / NS_PER_S), np.nan).astype(np.float32)
    fine = np.where(footprint, METRES_PER_PIXEL, np.nan).astype(np.float32)
    return ShadeMap(
        grid, at_ns, (IMAGER_SERIAL,), truth, footprint, footprint.astype(np.float32), fine
    )
