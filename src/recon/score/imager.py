"""The imaging drone of a run: rendered frames for the station's detector, or true shade maps.

With ideal detection, frames of a few pixels are sent over the link, with latency and faults; the
worker then returns the true sky of each frame instead of reading its pixels.
"""

from dataclasses import dataclass, replace

import numpy as np

from recon.camera import displaced_pose
from recon.camera.sight import farthest_sight_m
from recon.detection import DetectionSettings
from recon.detection.cells import field_grid
from recon.forecast import FORECASTERS
from recon.geo import cell_centres_m, shift_east_north_m
from recon.model.imagery import CameraPose, GroundImage, RgbImage
from recon.model.shade import MaskMap, ShadeMap
from recon.model.vehicle import VehicleProfile
from recon.score.scenario import IDEAL, NO_FORECAST, Scenario
from recon.score.scenario_conditions import conditions_of
from recon.score.simulation import simulation_of
from recon.score.true_frames import TrueFrames, ground_seen
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.fleet import IMAGER_SERIAL, SimulationConfig
from recon.sim.world import Sky
from recon.station.imaging.frames import LAY_FRAME
from recon.station.imaging.projection import LaidFrame
from recon.station.imaging.shade import READ_SHADE, ReadShade, ShadeRead
from recon.station.kernel.worker import JobRunner
from recon.station.state.imaging import LayFrame, SeenShade
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


def renderer_of(scenario: Scenario, seed: int) -> FieldRenderer:
    """Return the renderer of the scenario's frames, which knows their true poses."""
    imager = simulation_of(scenario, seed).imagers[IMAGER_SERIAL]
    assert isinstance(imager.source, FieldRenderer)
    return imager.source


def config_of(scenario: Scenario, seed: int) -> SimulationConfig:
    """Return the scenario's simulation, with rendered frames only where they are read."""
    config = simulation_of(scenario, seed, conditions_of(scenario, seed).feed)
    if scenario.methods.detection != IDEAL:
        return config
    unread = replace(config.imagers[IMAGER_SERIAL], source=Placeholders())
    return replace(config, imagers={IMAGER_SERIAL: unread})


def settings_of(scenario: Scenario) -> StationSettings:
    """Return the station's settings with the scenario's methods."""
    settings, methods = StationSettings(), scenario.methods
    detection = replace(settings.detection, cell_m=scenario.imager.cell_m)
    if methods.detection != IDEAL:
        detection = replace(detection, method=methods.detection)
    settings = replace(settings, detection=detection)
    if methods.forecast != NO_FORECAST:
        settings = replace(settings, forecast=replace(settings.forecast, method=methods.forecast))
    return settings


def jobs_of(scenario: Scenario, sky: Sky, frames: TrueFrames) -> JobRunner:
    """Return the runner of the station's jobs; with ideal detection it reads the truth of `sky`."""
    jobs = JobRunner(scenario.site)
    if scenario.methods.detection == IDEAL:
        ideal = IdealDetection(scenario, sky, frames)
        jobs.replace(LAY_FRAME, ideal.lay)
        jobs.replace(READ_SHADE, ideal.read)
    return jobs


class IdealDetection:
    """The true sky of each frame, where the station believes that the frame lies.

    Latency and pose are the station's: the sky is that of the true capture, seen from the true
    pose, and is laid on the station's grid by the pose from telemetry. Only the pixels are ideal.
    """

    def __init__(self, scenario: Scenario, sky: Sky, frames: TrueFrames) -> None:
        site = scenario.site
        assert site.imager is not None  # or it would not have been read
        assert site.ground_grid is not None
        self._frame, self._imager = scenario.frame, site.imager
        self._mount = site.profiles.get(IMAGER_SERIAL, VehicleProfile(IMAGER_SERIAL)).mount
        self._sky, self._frames = sky, frames
        detection = DetectionSettings(cell_m=scenario.imager.cell_m)
        self._grid = field_grid(site.ground_grid, detection)
        east_m, north_m = (part.ravel() for part in np.meshgrid(*cell_centres_m(self._grid)))
        self._points_m = np.column_stack([east_m, north_m])
        self._field_rad = site.imager.outlook.field_rad
        self._pixels_per_radian = site.imager.outlook.pixels_per_radian
        self._coarsest_m = scenario.imager.coarsest_m

    def lay(self, work: LayFrame) -> LaidFrame:
        """Return a frame's time and believed pose, without pixels."""
        marked, now, frame = work.reference, work.telemetry, work.frame
        shift_m = shift_east_north_m(self._frame, marked, now)
        pose = displaced_pose(self._imager.marked_pose, marked, now, shift_m, self._mount)
        nothing = np.zeros((self._grid.rows, self._grid.cols, 3), dtype=np.uint8)
        is_seen = self._seen(pose).reshape(nothing.shape[:2])
        image = GroundImage(
            self._grid,
            frame.id,
            frame.captured_at_ns,
            nothing,
            is_seen,
            pose,
            serial=IMAGER_SERIAL,
        )
        return LaidFrame(image)

    def read(self, work: ReadShade) -> ShadeRead:
        """Return the true sky of an image as a shade map, and the forecast from it."""
        shade = self._shade(work.image)
        own = SeenShade(shade, work.image.valid)
        method = FORECASTERS[work.forecast_settings.method]
        forecast, sun = method.after(work.forecast, shade, work.forecast_settings, own.seen)
        return ShadeRead(IMAGER_SERIAL, work.detection, forecast, own, (own, sun))

    def _shade(self, image: GroundImage) -> ShadeMap:
        """Return the true sky as this image shows it; raises `ValueError` without its frame."""
        true = self._frames.of_image(image)
        if true is None:
            raise ValueError("expected a frame that the simulator has sent, got another one")
        seen_m = ground_seen(true.pose, image.pose, self._points_m)
        known = image.valid & np.isfinite(seen_m).all(axis=1).reshape(image.valid.shape)
        places_m = np.nan_to_num(seen_m)
        share = self._sky.transmittance(places_m[:, 0], places_m[:, 1], true.taken_at_s)
        transmittance = np.where(known, share.reshape(known.shape), np.nan).astype(np.float32)
        fine = np.where(known, METRES_PER_PIXEL, np.nan).astype(np.float32)
        return ShadeMap(
            image.grid,
            image.captured_at_ns,
            (IMAGER_SERIAL,),
            transmittance,
            known,
            known.astype(np.float32),
            fine,
        )

    def _seen(self, pose: CameraPose) -> MaskMap:
        """(N,): whether the lens shows the points, were the pose true."""
        level = np.column_stack([self._points_m, np.zeros(len(self._points_m))])
        rays = (level - pose.position_enu_m) @ pose.rotation_enu_camera
        in_field = np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2]) <= self._field_rad
        height_m = float(pose.position_enu_m[2])
        most_m = farthest_sight_m(height_m, self._pixels_per_radian, self._coarsest_m)
        seen: MaskMap = in_field & (np.linalg.norm(rays, axis=1) <= most_m)
        return seen
