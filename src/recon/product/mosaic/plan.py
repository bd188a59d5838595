"""The mosaic's raster: its pixels, its windows, and which photos may show each."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.geo import GroundGrid, LocalFrame
from recon.product.mosaic.choice import STEP_PX

WINDOW_PX = 512
WINDOW_CELLS = WINDOW_PX // STEP_PX
MOST_PIXELS = 40_000_000_000
"""Of a mosaic: 36 km2 at 3 cm."""
FINEST_M, COARSEST_M = 0.001, 2.0


@dataclass(frozen=True, slots=True)
class MosaicWindow:
    """One window of the raster: its row and column among windows."""

    row: int
    col: int


@dataclass(frozen=True, slots=True, eq=False)
class MosaicPlan:
    """A raster of whole windows over an area in east-north metres."""

    grid: GroundGrid
    """The pixels; as many as whole windows have."""
    area: shapely.Geometry

    def windows(self) -> list[MosaicWindow]:
        """Return the windows that meet the area, in an order in which neighbours share photos."""
        found = []
        down, across = self.grid.rows // WINDOW_PX, self.grid.cols // WINDOW_PX
        shapely.prepare(self.area)
        for row in range(down):
            cols = range(across) if row % 2 == 0 else range(across - 1, -1, -1)
            found += [
                MosaicWindow(row, col)
                for col in cols
                if self.area.intersects(self.box(MosaicWindow(row, col)))
            ]
        return found

    def box(self, window: MosaicWindow) -> shapely.Polygon:
        """Return a window's ground."""
        side_m = WINDOW_PX * self.grid.cell_m
        west_m = self.grid.west_m + window.col * side_m
        north_m = self.grid.north_m - window.row * side_m
        return shapely.box(west_m, north_m - side_m, west_m + side_m, north_m)

    def middles_m(
        self, window: MosaicWindow, step_px: int, rows: slice, cols: slice
    ) -> tuple[FloatArray, FloatArray]:
        """Return easts and norths of the middles of squares of `step_px` pixels of a window.

        Rows and columns may lie beyond the window.
        """
        cell_m = self.grid.cell_m
        first_col, first_row = window.col * WINDOW_PX, window.row * WINDOW_PX
        middle_cols = first_col + (np.arange(cols.start, cols.stop) + 0.5) * step_px
        middle_rows = first_row + (np.arange(rows.start, rows.stop) + 0.5) * step_px
        return self.grid.west_m + middle_cols * cell_m, self.grid.north_m - middle_rows * cell_m

    def cells_m(self, window: MosaicWindow) -> tuple[FloatArray, FloatArray]:
        """Return easts and norths of the middles of a window's choice cells."""
        whole = slice(0, WINDOW_CELLS)
        return self.middles_m(window, STEP_PX, whole, whole)

    def inside(self, window: MosaicWindow) -> npt.NDArray[np.bool_]:
        """Return which choice cells of a window lie in the area, (R, C)."""
        places = np.meshgrid(*self.cells_m(window))
        return np.asarray(shapely.contains_xy(self.area, *places), dtype=np.bool_)


def plan_over(area: shapely.Geometry, frame: LocalFrame, cell_m: float) -> MosaicPlan:
    """Return the raster over an area; raises `RecordError` for sizes that cannot be meant."""
    if not FINEST_M <= cell_m <= COARSEST_M:
        raise RecordError(f"expected pixels of {FINEST_M:g} to {COARSEST_M:g} m, got {cell_m:g} m")
    west, south, east, north = area.bounds
    side_m = WINDOW_PX * cell_m
    first_col, first_row = floor(west / side_m), ceil(north / side_m)
    cols = max(1, ceil(east / side_m) - first_col) * WINDOW_PX
    rows = max(1, first_row - floor(south / side_m)) * WINDOW_PX
    if rows * cols > MOST_PIXELS:
        raise RecordError(
            f"expected a mosaic of at most {MOST_PIXELS} pixels, got {cols} x {rows} at "
            f"{cell_m:g} m: larger pixels, or fewer surveys"
        )
    return MosaicPlan(
        GroundGrid(frame, first_col * side_m, first_row * side_m, cell_m, rows, cols), area
    )


def round_m(size_m: float) -> float:
    """Return a size rounded up to 1, 1.5, 2, 3, 4, 5 or 7 times a power of ten."""
    power = 10.0 ** floor(np.log10(size_m))
    steps: Sequence[float] = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0)
    return float(f"{next(s for s in steps if s * power >= size_m * (1.0 - 1e-9)) * power:.3g}")
