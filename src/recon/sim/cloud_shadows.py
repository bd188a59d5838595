"""Soft shadows of fair-weather clouds that drift over the ground: for pictures, not for studies."""

from dataclasses import dataclass, field
from math import cos, radians, sin

import cv2
import numpy as np

from recon.sim.noise import FloatImage, tileable_noise

TILE_CELLS = 256
TILE_M = 1_500.0


@dataclass(slots=True)
class CloudShadows:
    """A pattern that moves with the wind; a pure function of time and place."""

    seed: int = 0
    cover: float = 0.28
    """Share of the ground that is in shadow, about."""
    depth: float = 0.5
    """How much darker a full shadow is."""
    wind_mps: float = 6.0
    heading_deg: float = 70.0
    _transmittance: FloatImage = field(init=False)

    def __post_init__(self) -> None:
        noise = tileable_noise(TILE_CELLS, self.seed, smallest_cells=9.0, slope=1.5)
        edge = float(np.quantile(noise, 1.0 - self.cover))
        # From sun to shadow within a band of noise: some tens of metres on the ground.
        share = np.clip((noise - edge) / 0.4 + 0.5, 0.0, 1.0)
        self._transmittance = (1.0 - self.depth * share * share * (3.0 - 2.0 * share)).astype(
            np.float32
        )

    def transmittance(self, east_m: FloatImage, north_m: FloatImage, time_s: float) -> FloatImage:
        """Return the light's share at each place, of the shape of `east_m`."""
        drift_m = self.wind_mps * time_s
        drift_east, drift_north = (
            drift_m * sin(radians(self.heading_deg)),
            drift_m * cos(radians(self.heading_deg)),
        )
        cells_per_m = TILE_CELLS / TILE_M
        # Reduced to one tile first: far from the origin 32-bit maps would lose the fraction.
        cols = np.mod((east_m - drift_east) * cells_per_m, TILE_CELLS).astype(np.float32)
        rows = np.mod((north_m - drift_north) * cells_per_m, TILE_CELLS).astype(np.float32)
        return cv2.remap(
            self._transmittance, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP
        ).astype(np.float32, copy=False)
