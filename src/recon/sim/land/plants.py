"""Plants, clods and stones: detail of the ground finer than the land's tiles, for photos from low.

Noise in three sizes of grain, each periodic and fixed to the ground, so that neighbouring photos
show the same detail at the same places. A grain finer than a photo's pixel is averaged out.
"""

import cv2
import numpy as np

from recon.sim.land.farmland_raster import noise_tile
from recon.sim.land.land_tiles import LandImage
from recon.sim.world.keyframes import FloatImage

TILE_CELLS = 1024
GRAINS = ((0.02, 0.16), (0.055, 0.11), (0.15, 0.09))
"""Size of a cell in metres, and the standard deviation of the ground's brightness, as a share.
Periods of 20, 56 and 154 m have no small common multiple: no two places look alike."""
SPECTRUM_SLOPE = 0.5
FIRST_STREAM = 20
COARSEST_PX = 8.0
"""Cells to a pixel from which a grain no longer shows."""


def add_plants(
    picture: LandImage, east_m: FloatImage, north_m: FloatImage, pixel_m: float, seed: int
) -> None:
    """Vary the brightness of a picture of the land (R, C, 4), whose pixels lie at places (R, C).

    `pixel_m` is the size of a pixel on the ground, of the middle one.
    """
    gain = np.ones(picture.shape[:2], dtype=np.float32)
    for number, (cell_m, share) in enumerate(GRAINS):
        if pixel_m / cell_m >= COARSEST_PX:
            continue
        blur_px = max(1, round(pixel_m / cell_m))
        tile = noise_tile(seed + FIRST_STREAM + number, 1.0, SPECTRUM_SLOPE, blur_px, TILE_CELLS)
        cols, rows = (_in_cells(part, cell_m) for part in (east_m, north_m))
        noise = cv2.remap(tile, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        gain += np.float32(share) * noise
    colours = picture[:, :, :3] * gain[:, :, np.newaxis]
    picture[:, :, :3] = np.clip(colours, 0.0, 255.0)


def _in_cells(places_m: FloatImage, cell_m: float) -> FloatImage:
    """Return places in cells of a tile, from its first period: remap takes no large ones."""
    period_m = TILE_CELLS * cell_m
    start_m = np.floor(float(places_m.min()) / period_m) * period_m
    cells: FloatImage = (places_m - np.float32(start_m)) * np.float32(1.0 / cell_m)
    return cells
