"""The land's colours and shadows as the lens sees them, before light."""

from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

from recon.sim.camera.lens import LATTICE_PX, Lens
from recon.sim.camera.look import Look
from recon.sim.land.land_tiles import CELLS_M, LandImage, LandSquare
from recon.sim.land.noise import FloatImage

Squares = Callable[[int], LandSquare]
"""Level -> the land's pixels of that level around the camera."""

FADE_M = 20.0
"""Towards the edge of a level's square the next coarser one takes over."""


def land_picture(lens: Lens, seen: Look, squares: Squares) -> LandImage:
    """Return red, green, blue and shadow (rows, cols, 4) of the lens's window.

    From coarse to fine, each level where its pixels are called for.
    """
    east, north = lens.full(seen.east_m), lens.full(seen.north_m)
    picture = _sample(squares(len(CELLS_M) - 1), east, north)
    for level in range(len(CELLS_M) - 2, -1, -1):
        if seen.footprint_m.min() >= CELLS_M[level + 1]:
            break
        square = squares(level)
        weight = _weight(seen, square, CELLS_M[level + 1])
        if (box := _box(weight, picture.shape)) is not None:
            fine = _sample(square, east[box], north[box])
            share = np.clip(lens.full(weight)[box], 0.0, 1.0)
            picture[box] = cv2.blendLinear(
                fine, np.ascontiguousarray(picture[box]), share, 1.0 - share
            )
    return picture


def _weight(seen: Look, square: LandSquare, coarser_m: float) -> FloatImage:
    """Return the share of a level on the lattice: 1 where its pixels are as fine as the lens's."""
    wanted = (coarser_m - seen.footprint_m) / (coarser_m - square.cell_m)
    east_m, north_m = square.centre_m
    reach = np.maximum(np.abs(seen.east_m - east_m), np.abs(seen.north_m - north_m))
    covered = (square.half_width_m - reach) / FADE_M
    weight: FloatImage = np.clip(np.minimum(wanted, covered), 0.0, 1.0).astype(np.float32)
    return weight


def _box(weight: FloatImage, shape: tuple[int, ...]) -> tuple[slice, slice] | None:
    """Return the window's rows and columns where a weight on the lattice counts."""
    rows, cols = np.flatnonzero(weight.any(axis=1)), np.flatnonzero(weight.any(axis=0))
    if rows.size == 0:
        return None
    # One block more on each side: interpolation reaches into it.
    return (
        slice(max(0, (rows[0] - 1) * LATTICE_PX), min(shape[0], (rows[-1] + 2) * LATTICE_PX)),
        slice(max(0, (cols[0] - 1) * LATTICE_PX), min(shape[1], (cols[-1] + 2) * LATTICE_PX)),
    )


def _sample(square: LandSquare, east_m: FloatImage, north_m: FloatImage) -> npt.NDArray[np.uint8]:
    per_m = np.float32(1.0 / square.cell_m)
    cols = (east_m - np.float32(square.west_m)) * per_m - np.float32(0.5)
    rows = (np.float32(square.north_m) - north_m) * per_m - np.float32(0.5)
    return cv2.remap(
        square.pixels, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101
    ).astype(np.uint8, copy=False)
