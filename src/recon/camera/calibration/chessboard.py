"""A flat chessboard and its inner corners in a photo."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.errors import CalibrationError
from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage

FEWEST_CORNERS = 3
"""Fewest corners along a side for OpenCV's search."""
MOST_CORNERS = 50
WINDOW_SHARE = 0.3
"""Share of the distance to the nearest corner: a wider window would include its edges."""
WINDOW_PX = (2, 10)
"""Half sides of the window: smaller holds too few pixels, larger only more of a curved edge."""


@dataclass(frozen=True, slots=True)
class Chessboard:
    """Rows and columns of inner corners, where four squares meet, and the side of a square."""

    rows: int
    cols: int
    square_mm: float

    def __post_init__(self) -> None:
        for name, count in (("rows", self.rows), ("cols", self.cols)):
            if not FEWEST_CORNERS <= count <= MOST_CORNERS:
                raise CalibrationError(
                    f"chessboard: expected {FEWEST_CORNERS} to {MOST_CORNERS} {name} of inner "
                    f"corners, got {count}; count the points where four squares meet"
                )
        if not 0.1 <= self.square_mm <= 10_000.0:
            raise CalibrationError(
                f"chessboard: expected squares of 0.1 to 10000 mm, got {self.square_mm:g} mm"
            )

    def points_mm(self) -> FloatArray:
        """Return (rows * cols, 3): the corners on the board, row by row; the third is 0."""
        row, col = np.mgrid[0 : self.rows, 0 : self.cols].reshape(2, -1)
        points = np.stack([col, row, np.zeros_like(col)], axis=1)
        return points.astype(np.float64) * self.square_mm


def find_corners(rgb: RgbImage, board: Chessboard) -> FloatArray | None:
    """Return the corners' pixels (rows * cols, 2) as (col, row), in the board's order, or None.

    A board without a mark has no first corner: the order may begin at the opposite end.
    """
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    is_found, corners = cv2.findChessboardCornersSB(
        grey, (board.cols, board.rows), flags=cv2.CALIB_CB_NORMALIZE_IMAGE
    )
    if not is_found:
        return None
    return _refined(grey, corners.reshape(-1, 2).astype(np.float32), board)


def _refined(
    grey: cv2.typing.MatLike, corners: npt.NDArray[np.float32], board: Chessboard
) -> FloatArray:
    """Return the corners moved to where the edges cross, each in a window of its own size."""
    half = np.clip(np.floor(WINDOW_SHARE * _nearest_px(corners, board)), *WINDOW_PX).astype(int)
    refined = corners.copy()
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-3)
    for side in np.unique(half):
        chosen = np.flatnonzero(half == side)
        start = corners[chosen].reshape(-1, 1, 2).copy()
        found = cv2.cornerSubPix(grey, start, (int(side), int(side)), (-1, -1), stop)
        refined[chosen] = np.asarray(found)[:, 0]
    return refined.astype(np.float64)


def _nearest_px(corners: npt.NDArray[np.float32], board: Chessboard) -> FloatArray:
    """Return (N,): the distance from each corner to its nearest neighbour on the board."""
    grid = corners.reshape(board.rows, board.cols, 2)
    nearest = np.full((board.rows, board.cols), np.inf)
    across = np.linalg.norm(np.diff(grid, axis=1), axis=2)
    down = np.linalg.norm(np.diff(grid, axis=0), axis=2)
    nearest[:, 1:] = np.minimum(nearest[:, 1:], across)
    nearest[:, :-1] = np.minimum(nearest[:, :-1], across)
    nearest[1:] = np.minimum(nearest[1:], down)
    nearest[:-1] = np.minimum(nearest[:-1], down)
    return nearest.ravel()
