"""An eye's pictures of the ground where a detector is to be scored: coarse and cheap.

Plots of crops and soils with patches, lit by what the sky lets through; one pixel a cell. The full
picture (lens, pose, packets) is the simulator's; here the methods themselves are scored.
"""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, GroundImage
from recon.model.shade import FloatMap, MaskMap
from recon.model.units import seconds_to_ns
from recon.sim.world.light import ClearSkyLight

PLOT_M = 90.0
PLOT_CONTRAST = 0.8
"""Brightest plots reflect five times as much as the darkest (natural log of reflectance)."""
PATCHES = 0.15
PATCH_M = 12.0
REFLECTANCE = 0.22
EXPOSURE = 2.2
"""Locked, so that sunlit soil of common brightness lies in the middle of the levels."""
NOISE_LEVELS = 2.5
GAMMA = 2.2
LOOKS_DOWN = np.diag([1.0, -1.0, -1.0])
GROUND_STREAM, NOISE_STREAM = 11, 12


@dataclass(frozen=True)
class CoarseImager:
    """Makes the eye's pictures, laid on the ground already."""

    grid: GroundGrid
    is_seen: MaskMap
    pose_m: tuple[float, float, float]
    seed: int

    @cached_property
    def reflectance(self) -> FloatMap:
        """(R, C), drawn from the seed."""
        rng = np.random.default_rng((self.seed, GROUND_STREAM))
        rows, cols, cell_m = self.grid.rows, self.grid.cols, self.grid.cell_m
        plots = rng.uniform(-PLOT_CONTRAST, PLOT_CONTRAST, (rows, cols))
        row = (np.arange(rows) * cell_m // PLOT_M).astype(np.int64)
        col = (np.arange(cols) * cell_m // PLOT_M).astype(np.int64)
        patches = cv2.GaussianBlur(rng.standard_normal((rows, cols)), (0, 0), PATCH_M / cell_m)
        log = plots[np.ix_(row, col)] + PATCHES * patches / max(float(patches.std()), 1e-9)
        return (REFLECTANCE * np.exp(log)).astype(np.float32)

    def picture(
        self, number: int, time_s: float, transmittance: FloatMap, light: ClearSkyLight
    ) -> GroundImage:
        """Return the `number`th picture, of ground that so much of the direct beam reaches."""
        rng = np.random.default_rng((self.seed, NOISE_STREAM, number))
        lit = np.clip(self.reflectance * light.index(transmittance) * EXPOSURE, 0.0, 1.0)
        levels = 255.0 * lit ** (1.0 / GAMMA) + rng.normal(0.0, NOISE_LEVELS, lit.shape)
        grey: npt.NDArray[np.uint8] = np.clip(np.rint(levels), 0.0, 255.0).astype(np.uint8)
        return GroundImage(
            self.grid,
            number,
            seconds_to_ns(time_s),
            np.dstack([grey] * 3),
            self.is_seen,
            CameraPose(LOOKS_DOWN, np.array(self.pose_m)),
            serial="IMAGER",
        )
