"""Known poses and the points seen from them: truth by construction."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from recon.camera import (
    ControlPoint,
    OmnidirectionalCamera,
    PoseSolution,
    TelemetryReference,
    displaced_pose,
    pose_from_points,
)
from recon.geo import enu_from_points, geo_from_enu, shift_east_north_m
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.imagery import CameraPose
from recon.model.vehicle import Mount

FRAME = LocalFrame(GeoPoint(44.5, -92.9, 320.0))
SIZE_PX = (1280, 720)
LEVEL = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
"""Camera to ENU: looking straight down, the frame's top towards north."""


def tilted_pose(
    east_m: float, north_m: float, up_m: float, turn_deg: tuple[float, float, float]
) -> CameraPose:
    """The level camera turned by a rotation vector in ENU (degrees), at this place."""
    turn = Rotation.from_rotvec(np.deg2rad(turn_deg)).as_matrix()
    return CameraPose(turn @ LEVEL, np.array([east_m, north_m, up_m]))


def seen_pixels(camera: OmnidirectionalCamera, pose: CameraPose, enu_m: np.ndarray) -> np.ndarray:
    return camera.project((enu_m - pose.position_enu_m) @ pose.rotation_enu_camera)


def control_points(
    camera: OmnidirectionalCamera,
    pose: CameraPose,
    enu_m: np.ndarray,
    noise_px: float = 0.0,
    seed: int = 0,
) -> list[ControlPoint]:
    """Control points as a perfect marker (or one with noise) would mark them."""
    pixels = seen_pixels(camera, pose, enu_m)
    pixels = pixels + np.random.default_rng(seed).normal(0.0, noise_px, pixels.shape)
    globe = zip(*geo_from_enu(FRAME, enu_m), strict=True)
    return [
        ControlPoint(f"P{i}", float(col), float(row), float(lat), float(lon), float(height))
        for i, ((col, row), (lat, lon, height)) in enumerate(zip(pixels, globe, strict=True))
    ]


def field_points(count: int, seed: int, relief_m: float = 0.0) -> np.ndarray:
    """Points spread over 400 m x 400 m, on the plane or with some relief."""
    rng = np.random.default_rng(seed)
    flat = rng.uniform(-200.0, 200.0, (count, 2))
    return np.column_stack([flat, rng.uniform(-relief_m, relief_m, count)])


def solved(
    camera: OmnidirectionalCamera,
    points: Sequence[ControlPoint],
    marked_size_px: tuple[int, int],
    frame: LocalFrame,
) -> PoseSolution:
    """The pose of control points whose places are on the globe."""
    points_enu_m = enu_from_points(frame, [point.place for point in points])
    return pose_from_points(camera, points, marked_size_px, points_enu_m)


def moved(
    pose: CameraPose, marked: TelemetryReference, now: TelemetryReference, mount: Mount
) -> CameraPose:
    """A pose moved by telemetry in `FRAME`."""
    return displaced_pose(pose, marked, now, shift_east_north_m(FRAME, marked, now), mount)
