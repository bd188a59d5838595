"""Ideal detection: the worker returns the true sky of each frame instead of reading its pixels, and
with the perfect forecast also the true sky to come."""

from dataclasses import replace

import numpy as np

from recon.camera import displaced_pose
from recon.camera.sight import farthest_sight_m
from recon.detection import DetectionSettings
from recon.detection.cells import field_grid
from recon.geo import cell_centres_m, shift_east_north_m
from recon.model.imagery import CameraPose, GroundImage, Outlook
from recon.model.shade import MaskMap, ShadeMap
from recon.model.vehicle import VehicleProfile
from recon.score.perfect_forecast import perfect_forecast
from recon.score.scenario import PERFECT, Scenario
from recon.score.true_frames import Frames, ground_seen
from recon.sim.world import Sky
from recon.station.imaging.projection import ProjectedFrame
from recon.station.imaging.shade import ReadShade, ShadeRead, with_forecast
from recon.station.state.imaging import ProjectFrame

METRES_PER_PIXEL = 0.5


class IdealDetection:
    """The true sky of each frame, where the station believes that the frame lies.

    Latency and pose are the station's: the sky is that of the true capture, seen from the true
    pose, and is projected on the station's grid by the pose from telemetry. Only the pixels are
    ideal.
    """

    def __init__(self, scenario: Scenario, sky: Sky, frames: Frames, *, shows_sun: bool) -> None:
        site = scenario.site
        assert site.ground_grid is not None  # or it would not have been read
        self._frame, self._site = scenario.frame, site
        self._sky, self._frames = sky, frames
        detection = DetectionSettings(cell_m=scenario.imager.cell_m)
        self._grid = field_grid(site.ground_grid, detection)
        east_m, north_m = (part.ravel() for part in np.meshgrid(*cell_centres_m(self._grid)))
        self._points_m = np.column_stack([east_m, north_m])
        self._outlooks = {serial: each.outlook for serial, each in site.imagers.items()}
        self._coarsest_m = scenario.imager.coarsest_m
        self._shows_sun = shows_sun
        self._is_forecast_perfect = scenario.methods.forecast == PERFECT

    def project(self, work: ProjectFrame) -> ProjectedFrame:
        """Return a frame's time and believed pose, without pixels."""
        marked, now, frame = work.reference, work.telemetry, work.frame
        imager = self._site.imagers[frame.serial]
        mount = self._site.profiles.get(frame.serial, VehicleProfile(frame.serial)).mount
        shift_m = shift_east_north_m(self._frame, marked, now)
        pose = displaced_pose(imager.marked_pose, marked, now, shift_m, mount)
        nothing = np.zeros((self._grid.rows, self._grid.cols, 3), dtype=np.uint8)
        is_seen = self._seen(pose, self._outlooks[frame.serial]).reshape(nothing.shape[:2])
        image = GroundImage(
            self._grid,
            frame.id,
            frame.captured_at_ns,
            nothing,
            is_seen,
            pose,
            serial=frame.serial,
        )
        return ProjectedFrame(image)

    def read(self, work: ReadShade) -> ShadeRead:
        """Return the true sky of an image as a shade map, and the forecast from it."""
        shade = self._shade(work.image)
        found = with_forecast(work, work.detection, shade, work.image.valid, self._shows_sun)
        if found.merged is None or not self._is_forecast_perfect:
            return found
        together, sun = found.merged
        assert sun is not None  # or it would not be shown
        perfect = perfect_forecast(self._sky, sun, work.forecast_settings.surest)
        return replace(found, merged=(together, perfect))

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
            (image.serial,),
            transmittance,
            known,
            known.astype(np.float32),
            fine,
        )

    def _seen(self, pose: CameraPose, outlook: Outlook) -> MaskMap:
        """(N,): whether the lens shows the points, were the pose true."""
        level = np.column_stack([self._points_m, np.zeros(len(self._points_m))])
        rays = (level - pose.position_enu_m) @ pose.rotation_enu_camera
        in_field = np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2]) <= outlook.field_rad
        height_m = float(pose.position_enu_m[2])
        most_m = farthest_sight_m(height_m, outlook.pixels_per_radian, self._coarsest_m)
        seen: MaskMap = in_field & (np.linalg.norm(rays, axis=1) <= most_m)
        return seen
