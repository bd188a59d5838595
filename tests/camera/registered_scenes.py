"""Frames of a made-up field whose true poses are known, small enough to be rendered in a test."""

from functools import cache

import cv2
import numpy as np
from scipy.spatial.transform import Rotation
from tests.camera.constructions import LEVEL
from tools.demo_site import demo_camera

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.camera.registration.lens_view import LensView, homography, view_of
from recon.camera.registration.settings import RegistrationSettings
from recon.model.imagery import CameraPose, RgbImage

HEIGHT_M = 120.0
CELL_M = 1.0
SIDE_CELLS = 900

CAMERA: OmnidirectionalCamera = demo_camera().scaled_to(360, 640)
CIRCLE = ImageCircle(CAMERA.centre_col_px, CAMERA.centre_row_px, 165.0)
VIEW: LensView = view_of(CAMERA, CIRCLE, RegistrationSettings())


@cache
def field(seed: int) -> RgbImage:
    """A field of patches in many sizes, (SIDE_CELLS, SIDE_CELLS, 3), centred on the origin."""
    random = np.random.default_rng(seed)
    total = np.zeros((SIDE_CELLS, SIDE_CELLS), dtype=np.float32)
    for cells, weight in ((12, 10.0), (5, 8.0), (2, 5.0)):
        count = SIDE_CELLS // cells
        noise = random.standard_normal((count, count)).astype(np.float32)
        total += weight * cv2.resize(noise, total.shape, interpolation=cv2.INTER_CUBIC)
    grey = np.clip(110.0 + total, 0.0, 255.0).astype(np.uint8)
    return np.repeat(grey[:, :, np.newaxis], 3, axis=2)


FIELD = field(1)


def pose_at(
    east_m: float = 0.0,
    north_m: float = 0.0,
    up_m: float = HEIGHT_M,
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> CameraPose:
    turn = Rotation.from_rotvec(np.deg2rad(turn_deg)).as_matrix()
    return CameraPose(turn @ LEVEL, np.array([east_m, north_m, up_m]))


def seen(pose: CameraPose, land: RgbImage = FIELD) -> RgbImage:
    """The frame that the lens takes of the land, (360, 640, 3), black outside the circle."""
    col, row = np.meshgrid(np.arange(640.0), np.arange(360.0))
    rays = CAMERA.unproject(np.stack([col.ravel(), row.ravel()], axis=1))
    rays = rays @ pose.rotation_enu_camera.T
    is_ground = rays[:, 2] < -0.1
    reach = np.where(is_ground, -pose.position_enu_m[2] / np.where(is_ground, rays[:, 2], -1.0), 0)
    east, north = (pose.position_enu_m + rays * reach[:, np.newaxis])[:, :2].T
    middle = (SIDE_CELLS - 1) / 2.0
    maps = (east / CELL_M + middle, middle - north / CELL_M)
    shaped = [np.nan_to_num(plane).reshape(360, 640).astype(np.float32) for plane in maps]
    frame = cv2.remap(land, *shaped, cv2.INTER_LINEAR)
    is_shown = is_ground.reshape(360, 640) & CIRCLE.contains(col, row)
    return np.where(is_shown[:, :, np.newaxis], frame, 0).astype(np.uint8)


def displacements_m(
    estimated: CameraPose, true: CameraPose, reference: CameraPose, true_reference: CameraPose
) -> np.ndarray:
    """How far the ground image of one pose is displaced against that of the reference frame.

    On points within 195 m of the point below the camera, (N,).
    """
    east, north = np.meshgrid(np.arange(-195.0, 196.0, 15.0), np.arange(-195.0, 196.0, 15.0))
    is_near = np.hypot(east, north) <= 195.0
    points = np.stack([east[is_near], north[is_near], np.zeros(is_near.sum())], axis=1)
    points[:, :2] += true.position_enu_m[:2]
    shown, expected = (
        _content(points, projected, taken)
        for projected, taken in ((estimated, true), (reference, true_reference))
    )
    return np.hypot(*(shown - expected)[:, :2].T)


def _content(points_m: np.ndarray, projected: CameraPose, taken: CameraPose) -> np.ndarray:
    """Which place truly is shown at each point of a ground image, (N, 3)."""
    rays = (points_m - projected.position_enu_m) @ projected.rotation_enu_camera
    rays = rays @ taken.rotation_enu_camera.T
    return taken.position_enu_m - rays * (taken.position_enu_m[2] / rays[:, 2:])


def relation_error(first: CameraPose, second: CameraPose) -> float:
    """Largest angle (rad) between rays to ground points and those by the homography."""
    points = np.random.default_rng(3).uniform(-300.0, 300.0, (50, 3)) * (1.0, 1.0, 0.0)
    rays, others = (
        (points - pose.position_enu_m) @ pose.rotation_enu_camera for pose in (first, second)
    )
    mapped = rays @ homography(first, second).T
    unit, expected = (each / np.linalg.norm(each, axis=1)[:, None] for each in (mapped, others))
    return float(np.linalg.norm(unit - expected, axis=1).max())
