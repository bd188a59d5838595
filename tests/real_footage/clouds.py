"""Clouds drawn for real footage: a frozen field that the wind moves; nothing here is simulated."""

from dataclasses import dataclass, field

import cv2
import numpy as np

from recon.model.geo import GroundGrid

CELL_M, CELLS = 6.0, 1024
"""The field repeats after 6 km: more than 10 min at 9 m/s."""
OUTER_M = 700.0
"""Largest size of clouds and gaps."""
SLOPE = 1.7
"""Of the spectrum's amplitude."""
EDGE = 0.12
"""Rise of the field, in standard deviations, over which the optical depth grows by one."""
THICKEST = 12.0
SUN_DISK_M = 18.0
"""Width that the sun's disk covers on clouds at 1400 m: the penumbra of a hard edge."""


@dataclass(slots=True)
class DrawnClouds:
    """Cloud shadows on the ground: `cover` of it lies below half of the direct beam."""

    seed: int
    cover: float = 0.4
    velocity_mps: tuple[float, float] = (6.0, 3.0)
    """East and north."""
    _beam: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        rng = np.random.default_rng([self.seed, 1])
        waves = np.hypot(np.fft.fftfreq(CELLS)[:, np.newaxis], np.fft.rfftfreq(CELLS)) / CELL_M
        spectrum = np.fft.rfft2(rng.standard_normal((CELLS, CELLS)))
        noise = np.fft.irfft2(spectrum * (waves + 1.0 / OUTER_M) ** -SLOPE, (CELLS, CELLS))
        threshold, deviation = np.quantile(noise, 1.0 - self.cover), noise.std()
        depth = np.log(2.0) + (noise - threshold) / (EDGE * deviation)
        beam = np.exp(-np.clip(depth, 0.0, THICKEST)).astype(np.float32)
        # A disk's standard deviation across is a quarter of its width.
        sigma = SUN_DISK_M / 4.0 / CELL_M
        edge = 8
        wide = cv2.copyMakeBorder(beam, edge, edge, edge, edge, cv2.BORDER_WRAP)
        self._beam = cv2.GaussianBlur(wide, (0, 0), sigma)[edge:-edge, edge:-edge]

    def at(self, east_m: np.ndarray, north_m: np.ndarray, time_s: float) -> np.ndarray:
        """Return the transmittance of the direct beam at ground points (R, C), float32."""
        cols = np.mod((east_m - self.velocity_mps[0] * time_s) / CELL_M, CELLS)
        rows = np.mod((north_m - self.velocity_mps[1] * time_s) / CELL_M, CELLS)
        maps = cols.astype(np.float32), rows.astype(np.float32)
        return cv2.remap(self._beam, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)

    def on_grid(self, grid: GroundGrid, time_s: float) -> np.ndarray:
        """Return the transmittance at the centres of a grid's cells, (rows, cols)."""
        east = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
        north = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
        return self.at(*np.meshgrid(east, north), time_s)
