"""Chessboards before a known lens: their true corners, and photos of them."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from scipy.spatial.transform import Rotation
from tools.demo_site import demo_camera

from recon.camera import OmnidirectionalCamera
from recon.camera.calibration import BoardPhoto, Chessboard
from recon.model.imagery import RgbImage

BOARD = Chessboard(rows=5, cols=7, square_mm=30.0)
PAPER, INK, WALL = 225.0, 22.0, 90.0


@dataclass(frozen=True, slots=True, eq=False)
class BoardPlace:
    """Where a board hangs before the camera: rotation, and its first corner in mm."""

    rotation: np.ndarray
    offset_mm: np.ndarray

    def points_mm(self, board: Chessboard) -> np.ndarray:
        """The corners in the camera's axes."""
        return board.points_mm() @ self.rotation.T + self.offset_mm


def small_camera(centre_px: tuple[float, float] = (322.0, 178.0)) -> OmnidirectionalCamera:
    """A lens of 170 degrees at 640 x 360, stretched a little; its centre (col, row) is given."""
    lens = demo_camera().scaled_to(360, 640)
    return OmnidirectionalCamera(
        lens.direct, lens.inverse, centre_px[1], centre_px[0], 1.003, 0.002, 0.002, 360, 640
    )


def place(
    around_deg: float,
    off_axis_deg: float,
    distance_mm: float,
    turn_deg: tuple[float, float, float],
    board: Chessboard = BOARD,
) -> BoardPlace:
    """A board in this direction from the camera, facing it but for a turn."""
    around, off = np.deg2rad((around_deg, off_axis_deg))
    toward = np.array([np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)])
    facing = Rotation.from_rotvec(off * np.array([-np.sin(around), np.cos(around), 0.0]))
    rotation = (facing * Rotation.from_rotvec(np.deg2rad(turn_deg))).as_matrix()
    middle = board.points_mm().mean(axis=0)
    return BoardPlace(rotation, toward * distance_mm - rotation @ middle)


def places(count: int, seed: int, board: Chessboard = BOARD) -> list[BoardPlace]:
    """Boards all over the view, out to its rim, near and far, tilted by up to 35 degrees."""
    rng = np.random.default_rng(seed)
    reach_mm = board.square_mm * board.cols
    return [
        place(
            360.0 * 0.382 * number,
            (8.0, 35.0, 52.0, 58.0)[number % 4],
            reach_mm * (0.95 + 0.25 * rng.random()),
            tuple(rng.uniform(-1.0, 1.0, 3) * (25.0, 25.0, 40.0)),
            board,
        )
        for number in range(count)
    ]


def seen_corners(
    camera: OmnidirectionalCamera, where: BoardPlace, noise_px: float, seed: int
) -> np.ndarray:
    """The true pixels of the corners, with noise; NaN for those out of view."""
    pixels = camera.project(where.points_mm(BOARD))
    return pixels + np.random.default_rng(seed).normal(0.0, noise_px, pixels.shape)


def board_photos(
    camera: OmnidirectionalCamera, count: int, noise_px: float = 0.0, seed: int = 0
) -> list[BoardPhoto]:
    """Corners of boards that are in view as a whole."""
    return [
        BoardPhoto(f"{number}.png", corners)
        for number, where in enumerate(places(count, seed))
        if np.isfinite(corners := seen_corners(camera, where, noise_px, 100 * seed + number)).all()
    ]


def photo(camera: OmnidirectionalCamera, where: BoardPlace, seed: int, times: int = 3) -> RgbImage:
    """A photo of the board on its sheet of paper, with blur and noise; black outside the lens."""
    levels = np.where(_is_lit(camera), np.float32(WALL), np.float32(0.0))
    corners = camera.project_beyond_range(where.points_mm(BOARD))
    margin_px = 1.2 * np.ptp(corners, axis=0).max() / (BOARD.rows - 1)
    low = np.maximum(np.floor(corners.min(axis=0) - margin_px), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0) + margin_px), (camera.cols, camera.rows))
    cols, rows = (high.astype(int) - low).tolist()
    row, col = np.mgrid[0 : times * rows, 0 : times * cols].reshape(2, -1)
    fine = np.stack([col, row], axis=1) + 0.5
    light = _light(where, camera.unproject(fine / times - 0.5 + low))
    board = light.reshape(times * rows, times * cols).astype(np.float32)
    window = np.s_[low[1] : low[1] + rows, low[0] : low[0] + cols]
    levels[window] = cv2.resize(board, (cols, rows), interpolation=cv2.INTER_AREA)
    levels = cv2.GaussianBlur(levels, (0, 0), 0.5)
    levels += np.random.default_rng(seed).normal(0.0, 2.0, levels.shape)
    grey = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., np.newaxis], 3, axis=2)


@lru_cache(maxsize=2)
def _is_lit(camera: OmnidirectionalCamera) -> np.ndarray:
    row, col = np.mgrid[0 : camera.rows, 0 : camera.cols].reshape(2, -1)
    rays = camera.unproject(np.stack([col, row], axis=1))
    return (rays[:, 2] > np.cos(np.deg2rad(85.0))).reshape(camera.rows, camera.cols)


def _light(where: BoardPlace, rays: np.ndarray) -> np.ndarray:
    """Level of what each ray (N, 3) meets: a square, the paper round them, or the wall."""
    normal = where.rotation[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        length = (normal @ where.offset_mm) / (rays @ normal)
        hit = (rays * length[:, np.newaxis] - where.offset_mm) @ where.rotation / BOARD.square_mm
        x, y = hit[:, 0], hit[:, 1]
        beyond = np.maximum.reduce([-x, x - (BOARD.cols - 1), -y, y - (BOARD.rows - 1)])
    is_before = length > 0.0
    is_odd = (np.floor(x) + np.floor(y)) % 2 == 0
    is_outside = ~(rays[:, 2] > np.cos(np.deg2rad(85.0)))
    return np.select(
        [is_outside, is_before & (beyond < 1.0) & is_odd, is_before & (beyond < 1.6)],
        [0.0, INK, PAPER],
        WALL,
    )


def angle_errors_deg(true: OmnidirectionalCamera, found: OmnidirectionalCamera) -> np.ndarray:
    """Angles between the rays of both lenses, over the pixels of the true field.

    The best common rotation is taken off: it belongs to the camera's pose, not to the lens.
    """
    col, row = np.meshgrid(np.linspace(0, true.cols - 1, 49), np.linspace(0, true.rows - 1, 27))
    pixels = np.stack([col.ravel(), row.ravel()], axis=1)
    rays, others = true.unproject(pixels), found.unproject(pixels)
    chosen = np.arccos(np.clip(rays[:, 2], -1.0, 1.0)) < np.deg2rad(80.0)
    rays, others = rays[chosen], others[chosen]
    turned = Rotation.align_vectors(rays, others)[0].apply(others)
    return np.rad2deg(2.0 * np.arcsin(np.linalg.norm(turned - rays, axis=1) / 2.0))
