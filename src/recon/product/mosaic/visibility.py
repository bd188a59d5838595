"""Whether a surface model hides a place from a camera: a walk along the ray, by heights."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from recon.model.arrays import FloatArray
from recon.product.mosaic.cameras import Camera
from recon.product.mosaic.ground import MosaicGround

HIDDEN_BY_M = 0.3
"""Height by which a surface must rise above a ray to hide what is behind: models err by pixels."""
REACH_CELLS = 32
"""How far from a place something may hide it, in cells of the choice: some metres, about as far as
a tree hides ground from a camera that looks down."""
STRIDE_CELLS = 2
FAR_BELOW_M = -1e6


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceAround:
    """The surface on the cells of a window and `REACH_CELLS` around them."""

    up_m: FloatArray
    cell_m: float

    @classmethod
    def of(cls, ground: MosaicGround, east_m: FloatArray, north_m: FloatArray) -> "SurfaceAround":
        """Return the surface around cells at easts (C,) and norths (R,), both evenly spaced."""
        cell_m = float(east_m[1] - east_m[0])
        beyond_m = np.arange(1, REACH_CELLS + 1) * cell_m
        wide_east_m = np.concatenate([east_m[0] - beyond_m[::-1], east_m, east_m[-1] + beyond_m])
        wide_north_m = np.concatenate(
            [north_m[0] + beyond_m[::-1], north_m, north_m[-1] - beyond_m]
        )
        up_m = ground.up_m(wide_east_m, wide_north_m)
        # What is not known hides nothing.
        return cls(np.where(np.isfinite(up_m), up_m, FAR_BELOW_M), cell_m)

    def is_seen(self, camera: Camera, places: FloatArray) -> npt.NDArray[np.bool_]:
        """Return which of the window's places (R, C, 3) nothing hides from a camera."""
        toward = camera.place_m - places
        across_m = np.hypot(toward[..., 0], toward[..., 1]).clip(1e-6)
        right, down = toward[..., 0] / across_m, -toward[..., 1] / across_m
        slope = toward[..., 2] / across_m
        rows, cols = np.indices(across_m.shape) + float(REACH_CELLS)
        is_seen = np.isfinite(places[..., 2])
        rise_m = float(self.up_m.max()) - places[..., 2]
        for cells in range(STRIDE_CELLS, REACH_CELLS, STRIDE_CELLS):
            off_m = cells * self.cell_m
            may_hide = is_seen & (slope * off_m < rise_m) & (off_m < across_m)
            if not may_hide.any():
                break
            at = rows[may_hide] + down[may_hide] * cells, cols[may_hide] + right[may_hide] * cells
            there_m = ndimage.map_coordinates(self.up_m, at, order=1, mode="nearest")
            ray_m = places[may_hide][:, 2] + slope[may_hide] * off_m
            is_seen[may_hide] &= there_m <= ray_m + HIDDEN_BY_M
        return is_seen
