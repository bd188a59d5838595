"""Times at which each cell of a flight's ground was in sun, and how many photos show it so.

The shade maps state the sun at their own moments; between them it is as `sun_at` mixes them, so a
cell's first and last time are known to the seconds between two maps.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import cell_centres_m
from recon.model.errors import RecordError
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap
from recon.model.units import NS_PER_S
from recon.product.coverage import LEAST_CONFIDENCE
from recon.product.flight import FULL, MOST_CELLS, UNKNOWN, FlightData
from recon.product.sun_at import SunHistory
from recon.record.raster.shade_geotiff import CogBand, cog_bytes

IntMap = npt.NDArray[np.int32]

SUNLIT = round(SUNLIT_TRANSMITTANCE * FULL)
"""Value from which a kept map's cells are in sun."""


@dataclass(frozen=True, slots=True, eq=False)
class SunByCell:
    """The sun over a flight; all arrays are (R, C), row 0 north. Times are station time in ns."""

    grid: GroundGrid
    first_ns: npt.NDArray[np.int64]
    last_ns: npt.NDArray[np.int64]
    """0 where no map shows the cell in sun."""
    maps: IntMap
    """Number of maps that show the cell."""
    sunlit_maps: IntMap

    @property
    def share(self) -> FloatMap:
        """The share of its maps in which a cell is in sun; NaN where no map shows it."""
        counted = np.where(self.maps > 0, self.maps, 1)
        share = np.where(self.maps > 0, self.sunlit_maps / counted, np.nan)
        return share.astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class PhotosByCell:
    """How many photos show each cell, and how many of them in sun; (R, C)."""

    photos: IntMap
    sunlit: IntMap


def grid_over(area: shapely.Geometry, grid: GroundGrid) -> GroundGrid:
    """Return a grid with as many more cells around it as an area needs.

    Raises `RecordError` for an area that needs too many.
    """
    west, south, east, north = area.bounds
    cell_m = grid.cell_m
    left, above = (
        max(0, ceil(beyond_m / cell_m)) for beyond_m in (grid.west_m - west, north - grid.north_m)
    )
    cols = left + max(grid.cols, ceil((east - grid.west_m) / cell_m))
    rows = above + max(grid.rows, ceil((grid.north_m - south) / cell_m))
    if rows * cols > MOST_CELLS:
        raise RecordError(
            f"expected regions of surveys near the shade maps, got {west:.0f} to {east:.0f} m east "
            f"and {south:.0f} to {north:.0f} m north of the site's origin"
        )
    west_m, north_m = grid.west_m - left * cell_m, grid.north_m + above * cell_m
    return GroundGrid(grid.frame, west_m, north_m, cell_m, rows, cols)


def place_on(wide: GroundGrid, grid: GroundGrid) -> tuple[slice, slice]:
    """Return where a grid lies on a `grid_over` of it."""
    row = round((wide.north_m - grid.north_m) / grid.cell_m)
    col = round((grid.west_m - wide.west_m) / grid.cell_m)
    return slice(row, row + grid.rows), slice(col, col + grid.cols)


def sun_by_cell(history: SunHistory, wide: GroundGrid | None = None) -> SunByCell:
    """Return when each cell was in sun, by the shade maps; on a `grid_over` of theirs if given."""
    grid = wide or history.grid
    shape, place = (grid.rows, grid.cols), place_on(grid, history.grid)
    found = SunByCell(
        grid, *np.zeros((2, *shape), dtype=np.int64), *np.zeros((2, *shape), dtype=np.int32)
    )
    first_ns, last_ns = found.first_ns[place], found.last_ns[place]
    maps, sunlit = found.maps[place], found.sunlit_maps[place]
    for each in history.maps:
        is_known = each.sun != UNKNOWN
        is_lit = is_known & (each.sun >= SUNLIT)
        maps += is_known
        sunlit += is_lit
        first_ns[is_lit & (sunlit == 1)] = each.at_ns
        last_ns[is_lit] = each.at_ns
    return found


def photos_by_cell(
    history: SunHistory,
    photos: Iterable[tuple[int, shapely.Polygon]],
    wide: GroundGrid | None = None,
) -> PhotosByCell:
    """Return how many photos show each cell, and how many of them in sun.

    `photos` are station times in ns and footprints in east-north metres. Cells are those of the
    shade maps, or of a `grid_over` of theirs.
    """
    grid = wide or history.grid
    place = place_on(grid, history.grid)
    photos_of, sunlit = np.zeros((2, grid.rows, grid.cols), dtype=np.int32)
    is_lit, lit_ns = np.zeros(photos_of.shape, dtype=np.bool_), None
    for at_ns, footprint in photos:
        window, is_on = _cells_in(footprint, grid)
        if at_ns != lit_ns:
            sun, lit_ns = history.at(at_ns), at_ns
            is_sure = sun.confidence >= LEAST_CONFIDENCE
            is_lit[place] = is_sure & (sun.transmittance >= SUNLIT_TRANSMITTANCE)
        photos_of[window] += is_on
        sunlit[window] += is_on & is_lit[window]
    return PhotosByCell(photos_of, sunlit)


def _cells_in(
    area: shapely.Polygon, grid: GroundGrid
) -> tuple[tuple[slice, slice], npt.NDArray[np.bool_]]:
    """Return the part of a grid around an area, and which of its cells have their centre in it."""
    west, south, east, north = area.bounds
    cols = np.array([west - grid.west_m, east - grid.west_m + grid.cell_m]) / grid.cell_m
    rows = np.array([grid.north_m - north, grid.north_m - south + grid.cell_m]) / grid.cell_m
    window = (
        slice(*np.clip(rows, 0, grid.rows).astype(int).tolist()),
        slice(*np.clip(cols, 0, grid.cols).astype(int).tolist()),
    )
    east_m, north_m = cell_centres_m(grid)
    places = np.meshgrid(east_m[window[1]], north_m[window[0]])
    return window, np.asarray(shapely.contains_xy(area, *places), dtype=np.bool_)


def sun_cog(flight: FlightData, sun: SunByCell, photos: PhotosByCell | None) -> bytes:
    """Return the cells' sun as a cloud-optimised GeoTIFF; each band has its description.

    Times are seconds after the flight's first shade map, whose UTC is in the descriptions.
    """
    start_ns = flight.maps[0].at_ns
    start_utc = flight.utc(start_ns)
    is_seen = sun.sunlit_maps > 0

    def seconds(at_ns: npt.NDArray[np.int64]) -> FloatMap:
        return np.where(is_seen, (at_ns - start_ns) / NS_PER_S, np.nan).astype(np.float32)

    bands = [
        CogBand(seconds(sun.first_ns), f"first time in sun, seconds after {start_utc}", "s"),
        CogBand(seconds(sun.last_ns), f"last time in sun, seconds after {start_utc}", "s"),
        CogBand(sun.share, "share of shade maps with the cell in sun"),
        CogBand(sun.maps.astype(np.float32), "shade maps that show the cell"),
    ]
    if photos is not None:
        bands += [
            CogBand(photos.sunlit.astype(np.float32), "photos that show the cell in sun"),
            CogBand(photos.photos.astype(np.float32), "photos that show the cell"),
        ]
    tags = {"RECON_FLIGHT_RECORD": flight.path.name, "RECON_START_UTC": start_utc}
    return cog_bytes(sun.grid, bands, tags)
