"""The sun on the ground that each photo shows, at its time: a piece of the flight's shade maps."""

from dataclasses import dataclass

import cv2
import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.product.sun_at import FloatMap, SunHistory, Sunshine

BEYOND_CELLS = 2
"""Cells of the maps kept around a photo's ground."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoLight:
    """The sun at one moment on a part of the shade maps' grid; `west_m` and `north_m` are edges."""

    sun: Sunshine
    west_m: float
    north_m: float
    cell_m: float

    def at(self, east_m: FloatArray, north_m: FloatArray) -> tuple[FloatMap, FloatMap]:
        """Return transmittance and confidence (rows, cols) at easts (cols,) and norths (rows,).

        Between cells as `sun_on_photo` has it: only known cells count, and a place is known where
        most of its neighbours are. Transmittance is 0 where nothing is known.
        """
        cols = ((east_m - self.west_m) / self.cell_m - 0.5).astype(np.float32)
        rows = ((self.north_m - north_m) / self.cell_m - 0.5).astype(np.float32)
        places = np.broadcast_arrays(cols[np.newaxis, :], rows[:, np.newaxis])
        across, down = (np.ascontiguousarray(each) for each in places)
        confidence, transmittance = self.sun.confidence, self.sun.transmittance
        is_known = (confidence > 0.0).astype(np.float32)
        # Cells that are not known hold zeros: sums over known ones, divided by their share.
        share, bright, sure = (
            cv2.remap(each, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
            for each in (is_known, transmittance * is_known, confidence)
        )
        known = share >= 0.5
        divisor = np.where(known, share, np.float32(1.0))
        return (
            np.where(known, bright / divisor, 0.0).astype(np.float32),
            np.where(known, sure / divisor, 0.0).astype(np.float32),
        )


def light_on(history: SunHistory, at_ns: int, area: shapely.Geometry) -> PhotoLight:
    """Return the sun at a station time on an area in east-north metres."""
    grid, sun = history.grid, history.at(at_ns)
    rows, cols = _part(grid, area)
    # Copies: a view would keep the whole map in memory.
    piece = Sunshine(sun.transmittance[rows, cols].copy(), sun.confidence[rows, cols].copy())
    west_m = grid.west_m + cols.start * grid.cell_m
    return PhotoLight(piece, west_m, grid.north_m - rows.start * grid.cell_m, grid.cell_m)


def _part(grid: GroundGrid, area: shapely.Geometry) -> tuple[slice, slice]:
    """Return the rows and columns around an area, at least one each."""
    west, south, east, north = area.bounds
    ends = []
    for low, high, count in (
        ((grid.north_m - north) / grid.cell_m, (grid.north_m - south) / grid.cell_m, grid.rows),
        ((west - grid.west_m) / grid.cell_m, (east - grid.west_m) / grid.cell_m, grid.cols),
    ):
        first = int(np.clip(np.floor(low) - BEYOND_CELLS, 0, count - 1))
        ends.append(slice(first, int(np.clip(np.ceil(high) + BEYOND_CELLS, first + 1, count))))
    return ends[0], ends[1]
