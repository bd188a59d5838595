"""[elevation]: the ground's heights from a GeoTIFF, sampled on a grid of the site's local frame.

The grid covers the boundary (without one, the pads and the origin) and as far around it as a
vehicle may fly from home.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from msgspec import Meta, Struct

from recon.geo import Surface, cell_centres_m, enu_from_points
from recon.model.airspace import Airspace, ElevationModel
from recon.model.arrays import FloatArray
from recon.model.errors import SiteError
from recon.model.geo import GroundGrid, LocalFrame
from recon.site.reading import file_inside
from recon.site.schema import FileName
from recon.site.terrain_source import TerrainSource, source_of

if TYPE_CHECKING:
    from recon.site.height_file import HeightFile

Datum = Literal["wgs84", "geoid"]
MOST_CELLS = 1_000_000
FINEST_CELL_M = 1.0
"""Finer models show plants, not ground."""
COARSEST_CELL_M = 30.0
"""Coarsest cell, unless the area asks for more cells than are allowed."""
FINEST_PIXEL_M, COARSEST_PIXEL_M = 0.01, 100.0
"""The world's free models have 30 or 90 m; in coarser ones whole hills are missing."""
LARGEST_GAP_M = 10.0
"""Largest gap between the model and an altitude in site.toml or of a pad. More is another datum,
feet taken for metres, or another place; geoid and ellipsoid differ by 30 m in much of America."""


class ElevationTable(Struct, frozen=True, forbid_unknown_fields=True):
    """[elevation]: `datum` is the zero of the file's heights; it is never guessed."""

    file: FileName
    datum: Datum
    geoid_height_m: Annotated[float, Meta(ge=-120.0, le=100.0)] | None = None
    """The geoid's height above the ellipsoid here, to be added; for `geoid` only."""


def read_elevation(
    site_file: Path, table: ElevationTable, airspace: Airspace
) -> tuple[ElevationModel, TerrainSource | None]:
    """Return the elevation model around an airspace that has a frame, and its source if fetched.

    Raises `SiteError`.
    """
    from recon.site.height_file import opened

    frame = airspace.frame
    assert frame is not None
    raised_m = _raised_m(f"{site_file}: elevation", table)
    with opened(file_inside(site_file, table.file, "elevation.file")) as file:
        refuse_other_datum(file, table.datum)
        pixel_m = _pixel_m(file, frame)
        grid = _grid(frame, flown_area_m(airspace), pixel_m)
        heights_m = _resampled(file, grid, pixel_m) + raised_m
        model = ElevationModel(grid, heights_m)
        _refuse_other_ground(file.place, model)
        source = source_of(file.dataset.tags())
    return model, source


def ground_heights_m(model: ElevationModel, east_north_m: FloatArray) -> FloatArray:
    """Return the ellipsoidal height of the ground at (N, 2) points, NaN where none is known."""
    return Surface(model.grid, model.ellipsoid_height_m).heights_m(east_north_m)


def _raised_m(place: str, table: ElevationTable) -> float:
    """Return the offset from the file's heights to ellipsoidal ones."""
    if (table.datum == "geoid") != (table.geoid_height_m is not None):
        got = "none" if table.geoid_height_m is None else "one"
        raise SiteError(
            f"{place}.geoid_height_m: expected one with datum = 'geoid' and none with 'wgs84', got "
            f"{got} with '{table.datum}'"
        )
    return table.geoid_height_m or 0.0


def refuse_other_datum(file: "HeightFile", datum: Datum) -> None:
    """Raise `SiteError` when the file declares another vertical datum than was stated."""
    vertical = next((crs for crs in file.crs.sub_crs_list if crs.is_vertical), None)
    if vertical is None and len(file.crs.axis_info) < 3:
        return
    name = file.crs.name if vertical is None else vertical.name
    is_ellipsoidal = vertical is None or "ellipsoid" in name.lower()
    if is_ellipsoidal != (datum == "wgs84"):
        raise SiteError(
            f"{file.place}: expected heights with elevation.datum = '{datum}' as in "
            f"site.toml, got a file with {name!a}"
        )
    if vertical is not None and vertical.axis_info[0].unit_conversion_factor != 1.0:
        unit = vertical.axis_info[0].unit_name
        raise SiteError(f"{file.place}: expected heights in metres, got {unit!a}; convert them")


def _pixel_m(file: "HeightFile", frame: LocalFrame) -> float:
    """Return how wide the file's pixels are at the origin, along their narrower side."""
    corner, east, north = file.pixels(frame, np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]))
    # Rows are what rows and columns each change by for a metre; its largest stretch is the finest.
    per_metre = np.stack([east - corner, north - corner])
    finest = float(np.linalg.norm(per_metre, ord=2)) if np.isfinite(per_metre).all() else 0.0
    if finest <= 0.0:
        raise SiteError(_elsewhere(file))
    pixel_m = 1.0 / finest
    if not FINEST_PIXEL_M <= pixel_m <= COARSEST_PIXEL_M:
        raise SiteError(
            f"{file.place}: expected pixels of {FINEST_PIXEL_M:g} to {COARSEST_PIXEL_M:g} m, got "
            f"{pixel_m:.3g} m; is its coordinate reference system right?"
        )
    return pixel_m


def flown_area_m(airspace: Airspace) -> tuple[FloatArray, FloatArray]:
    """Return the south-west and north-east corners of the ground that flights may reach."""
    assert airspace.frame is not None
    pads = enu_from_points(airspace.frame, [pad.place for pad in airspace.landing_pads])[:, :2]
    outline = () if airspace.boundary is None else (airspace.boundary.outline_m,)
    points = np.concatenate([np.zeros((1, 2)), pads, *outline])
    reach_m = airspace.limits.max_distance_from_home_m
    return points.min(axis=0) - reach_m, points.max(axis=0) + reach_m


def _grid(frame: LocalFrame, area_m: tuple[FloatArray, FloatArray], pixel_m: float) -> GroundGrid:
    south_west, north_east = area_m
    width_m, height_m = (north_east - south_west).tolist()
    wanted_m = min(max(pixel_m, FINEST_CELL_M), COARSEST_CELL_M)
    affordable_m = float(np.sqrt(width_m * height_m / MOST_CELLS))
    cell_m = max(wanted_m, affordable_m)
    # One more on each side: heights are known only between the centres of cells.
    rows, cols = (int(np.ceil(side_m / cell_m)) + 2 for side_m in (height_m, width_m))
    west_m, north_m = float(south_west[0]) - cell_m, float(north_east[1]) + cell_m
    return GroundGrid(frame, west_m, north_m, cell_m, rows, cols)


def _resampled(file: "HeightFile", grid: GroundGrid, pixel_m: float) -> FloatArray:
    """Return the file's heights in the middles of the grid's cells, (rows, cols)."""
    pixels = file.pixels(grid.frame, _middles_m(grid))
    reach = _reach(grid.cell_m, pixel_m)
    first, size = _window(file, pixels, 1 + reach)
    heights_m = file.heights_m(first, size)
    if reach:
        heights_m = _highest_around(heights_m, reach)
    sampled = _between(heights_m, pixels - np.array(first))
    if np.isnan(sampled).all():
        raise SiteError(_elsewhere(file))
    return sampled.reshape(grid.rows, grid.cols)


def _reach(cell_m: float, pixel_m: float) -> int:
    """Return from how many pixels around a cell's middle gets the highest ground.

    Where cells are wider than pixels, no peak between cell centres may be lost. A peak is at most
    a cell away, in a grid that may be rotated against the file's; both ends are interpolated
    between pixels.
    """
    if cell_m <= 1.01 * pixel_m:
        return 0
    return int(np.ceil(np.sqrt(2.0) * cell_m / pixel_m)) + 2


def _middles_m(grid: GroundGrid) -> FloatArray:
    """Return the middles of all cells, row after row, (rows * cols, 2)."""
    return np.stack(np.meshgrid(*cell_centres_m(grid)), axis=-1).reshape(-1, 2)


def _window(
    file: "HeightFile", pixels: FloatArray, around: int
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the first row and column and the size of the part that holds the pixels."""
    shape = np.array([file.dataset.height, file.dataset.width], dtype=np.float64)
    known = pixels[np.isfinite(pixels).all(axis=1)]
    if len(known) == 0:
        raise SiteError(_elsewhere(file))
    first = np.clip(np.floor(known.min(axis=0)) - around, 0.0, shape)
    end = np.clip(np.ceil(known.max(axis=0)) + 1.0 + around, 0.0, shape)
    rows, cols = (end - first).astype(int).tolist()
    if rows < 1 or cols < 1:
        raise SiteError(_elsewhere(file))
    return (int(first[0]), int(first[1])), (rows, cols)


def _highest_around(heights_m: FloatArray, reach: int) -> FloatArray:
    """Return the highest height within `reach` pixels; unknown heights stay unknown."""
    from scipy import ndimage

    is_unknown = np.isnan(heights_m)
    filled = np.where(is_unknown, -np.inf, heights_m)
    highest = ndimage.maximum_filter(filled, size=2 * reach + 1, mode="nearest")
    return np.where(is_unknown, np.nan, highest)


def _between(heights_m: FloatArray, pixels: FloatArray) -> FloatArray:
    """Return bilinear heights at (N, 2) rows and columns; NaN beyond the outermost middles."""
    from scipy import ndimage

    places = np.where(np.isfinite(pixels), pixels, -9.0).T
    sampled: FloatArray = ndimage.map_coordinates(
        heights_m, places, order=1, mode="constant", cval=np.nan
    )
    return sampled


def _refuse_other_ground(place: str, model: ElevationModel) -> None:
    """Raise `SiteError` when the model differs from origin.ground_altitude_m at the origin."""
    stated_m = model.grid.frame.origin.ellipsoid_height_m
    found_m = float(ground_heights_m(model, np.zeros((1, 2)))[0])
    if np.isnan(found_m):
        raise SiteError(f"{place}: expected a height at the site's origin, got none")
    if abs(found_m - stated_m) > LARGEST_GAP_M:
        raise SiteError(
            f"{place}: expected ground within {LARGEST_GAP_M:g} m of origin.ground_altitude_m in "
            f"site.toml, {stated_m:g} m above the ellipsoid, got {found_m:.1f} m; are its "
            "heights in metres, and is elevation.datum right?"
        )


def _elsewhere(file: "HeightFile") -> str:
    return (
        f"{file.place}: expected heights around the site's origin, got none; does the file cover "
        "the site, and is its coordinate reference system right?"
    )
