"""The places of the real frames: lens, pose by control points, light, and the hot spot if seen."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from tests.real_footage.light import light_of, sunlit_base

from recon.camera import (
    ImageCircle,
    OmnidirectionalCamera,
    decode_jpeg,
    find_image_circle,
    load_camera,
    load_control_points,
    pose_from_points,
)
from recon.geo import enu_from_points
from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose

PLACES = ("becker-1", "elgin-5", "grand-meadow-7")
MARKED_SIZE_PX = (3840, 2160)
SOURCE_FINER = 2
"""Pixels of the source frame to one of the made frames, so that moving it does not blur it."""


@dataclass(frozen=True, slots=True)
class HotSpot:
    """Brightening of the ground opposite the sun, as measured in one frame."""

    toward_enu: tuple[float, float, float]
    """Unit vector from the camera to its middle; the sun is in the opposite direction."""
    gain: tuple[float, float, float]
    """At its middle, of light in red, green, blue."""
    e_fold_deg: float

    def at(self, directions: FloatArray) -> np.ndarray:
        """Return the gain (..., 3) towards unit vectors (..., 3)."""
        angle_deg = np.degrees(np.arccos(np.clip(directions @ np.array(self.toward_enu), -1, 1)))
        return np.exp(-angle_deg / self.e_fold_deg)[..., np.newaxis] * np.array(self.gain)


HOT_SPOTS = {
    "elgin-5": HotSpot((0.546, 0.300, -0.782), (0.95, 0.45, 0.65), 6.0),
    "grand-meadow-7": HotSpot((-0.177, 0.403, -0.898), (0.45, 0.30, 0.35), 5.0),
}
"""Medians of light by angle over that at 14 to 18 degrees; becker-1 shows none."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """One real frame, ready to be relit at the size of `camera`."""

    name: str
    camera: OmnidirectionalCamera
    circle: ImageCircle
    frame: LocalFrame
    marked_pose: CameraPose
    """The real frame's, fitted to its control points."""
    sunlit: np.ndarray
    """(R, C, 3) light of the real frame, without the hot spot; finer than the made frames."""
    hot_spot: HotSpot | None

    @property
    def toward_sun_enu(self) -> FloatArray | None:
        """Return the unit vector to the sun, where the hot spot shows it."""
        return None if self.hot_spot is None else -np.array(self.hot_spot.toward_enu)

    def grid(self, cell_m: float = 1.0, side_m: float = 512.0) -> GroundGrid:
        """Return a square of ground below the camera."""
        east_m, north_m, _ = (float(metres) for metres in self.marked_pose.position_enu_m)
        count, half_m = round(side_m / cell_m), side_m / 2.0
        return GroundGrid(self.frame, east_m - half_m, north_m + half_m, cell_m, count, count)


def load_place(folder: Path, name: str, cols: int = 640) -> Place:
    """Return a place of the real data for frames of this many columns."""
    camera = load_camera(folder / "camera-model.txt")
    points = load_control_points(folder / name / "GCPs.txt")
    middle = np.mean([(p.latitude_deg, p.longitude_deg, p.ellipsoid_height_m) for p in points], 0)
    frame = LocalFrame(GeoPoint(*(float(number) for number in middle)))
    enu_m = enu_from_points(frame, [point.place for point in points])
    pose = pose_from_points(camera, points, MARKED_SIZE_PX, enu_m).pose
    rgb = decode_jpeg((folder / name / "RefFrame.jpeg").read_bytes())
    circle = find_image_circle(rgb, camera.scaled_to(*rgb.shape[:2]))
    assert circle is not None
    made = camera.scaled_to(cols * camera.rows // camera.cols, cols)
    fine = camera.scaled_to(SOURCE_FINER * made.rows, SOURCE_FINER * made.cols)
    light = cv2.resize(light_of(rgb), (fine.cols, fine.rows), interpolation=cv2.INTER_AREA)
    hot_spot = HOT_SPOTS.get(name)
    return Place(
        name=name,
        camera=made,
        circle=circle.scaled(cols / rgb.shape[1]),
        frame=frame,
        marked_pose=pose,
        sunlit=_without_hot_spot(light, fine, pose, hot_spot),
        hot_spot=hot_spot,
    )


def _without_hot_spot(
    light: np.ndarray, camera: OmnidirectionalCamera, pose: CameraPose, hot_spot: HotSpot | None
) -> np.ndarray:
    if hot_spot is None:
        return light
    pixels = np.stack(np.meshgrid(np.arange(camera.cols), np.arange(camera.rows)), axis=-1)
    rays = camera.unproject(pixels.reshape(-1, 2)) @ pose.rotation_enu_camera.T
    hot = np.nan_to_num(hot_spot.at(rays)).astype(np.float32)
    return sunlit_base(light.reshape(-1, 3), hot).reshape(light.shape)
