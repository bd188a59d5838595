"""The eye of a whole run: rendered frames read by the station's own methods, or the truth.

With the truth, frames of a few pixels travel as any do, with their latency and faults; what would
be read from them is put in their place when the station has them laid and read.
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
from recon.station.imaging.frames import LAY_FRAME, LayFrame
from recon.station.imaging.shade import READ_SHADE, ReadShade, ShadeRead
from recon.station.kernel.worker import JobRunner
from recon.station.state.settings import StationSettings

PLACEHOLDER_PX = 8
METRES_PER_PIXEL = 0.5


@dataclass(frozen=True, slots=True)
class Placeholders:
    """Frames of which nobody reads a pixel."""

    def prepare(self) -> None:
        """There is nothing to draw."""

    def render(self, view: CameraView) -> RgbImage:
        """Return a grey frame; its number is in it, so that no two are the same."""
        level = 1 + view.number % 250
        return np.full((PLACEHOLDER_PX, PLACEHOLDER_PX, 3), level, dtype=np.uint8)


def config_of(scenario: Scenario, seed: int) -> SimulationConfig:
    """Return the scenario's simulation with the frames that its detection needs."""
    feed = FeedSettings(1.0 / scenario.imager.period_s, ImageFormat.RAW)
    config = simulation_of(scenario, seed, feed)
    if scenario.methods.detection != IDEAL or config.imager is None:
        return config
    return replace(config, imager=replace(config.imager, source=Placeholders()))


def settings_of(scenario: Scenario) -> StationSettings:
    """Return the station's settings with the methods that the scenario names."""
    settings, methods = StationSettings(), scenario.methods
    if methods.detection != IDEAL:
        detection = replace(settings.detection, method=methods.detection)
        settings = replace(settings, detection=detection)
    if methods.forecast != NO_FORECAST:
        settings = replace(settings, forecast=replace(settings.forecast, method=methods.forecast))
    return settings


def jobs_of(scenario: Scenario, sky: Sky, grid: GroundGrid, footprint: MaskMap) -> JobRunner:
    """Return what runs the station's jobs; with ideal detection it reads the truth of `sky`."""
    jobs = JobRunner(scenario.site)
    if scenario.methods.detection != IDEAL:
        return jobs

    def lay(work: LayFrame) -> GroundImage:
        nothing = np.zeros((grid.rows, grid.cols, 3), dtype=np.uint8)
        pose = CameraPose(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
        frame = work.frame
        return GroundImage(
            grid, frame.id, frame.captured_at_ns, nothing, footprint, pose, serial=IMAGER_SERIAL
        )

    def read(work: ReadShade) -> ShadeRead:
        shade = true_shade(sky, grid, footprint, work.image.captured_at_ns)
        method = FORECASTERS[work.forecast_settings.method]
        forecast, sun = method(work.forecast, shade, work.forecast_settings)
        return ShadeRead(work.detection, forecast, (shade, sun))

    jobs.replace(LAY_FRAME, lay)
    jobs.replace(READ_SHADE, read)
    return jobs


def true_shade(sky: Sky, grid: GroundGrid, footprint: MaskMap, at_ns: int) -> ShadeMap:
    """Return the truth of a moment as a shade map of the footprint."""
    told = np.where(footprint, sky.on_grid(grid, at_ns / NS_PER_S), np.nan).astype(np.float32)
    fine = np.where(footprint, METRES_PER_PIXEL, np.nan).astype(np.float32)
    return ShadeMap(
        grid, at_ns, (IMAGER_SERIAL,), told, footprint, footprint.astype(np.float32), fine
    )
