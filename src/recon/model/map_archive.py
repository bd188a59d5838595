"""Shade maps and sun forecasts as archives of numpy arrays (`.npz`), each value as it is.

The arrays have the names of the fields of `ShadeMap` and `SunForecast`. Of the grid there are
`edges_m` (west edge, north edge, size of a cell) and `origin` (latitude and longitude in degrees,
ellipsoid height in metres). Whoever reads one may get it from the network: its size is limited
before anything is unpacked, and nothing is unpickled.
"""

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from recon.model.array_archive import ArchiveError, read_arrays
from recon.model.errors import ReconError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap, SunForecast

MOST_BYTES = 64 * 1024 * 1024
"""Of all arrays together: forecasts of 23 leads over 1500 x 1500 cells."""
Arrays = Mapping[str, npt.NDArray[Any]]


class MapArchiveError(ReconError):
    """Bytes that are no archive of a shade map or a forecast."""


def shade_archive(shade: ShadeMap) -> bytes:
    """Return a shade map as an archive."""
    return _packed(
        shade.grid,
        captured_at_ns=np.int64(shade.captured_at_ns),
        source_serials=np.array(shade.source_serials, np.str_),
        transmittance=shade.transmittance,
        valid=shade.valid,
        confidence=shade.confidence,
        metres_per_pixel=shade.metres_per_pixel,
    )


def forecast_archive(sun: SunForecast) -> bytes:
    """Return a forecast as an archive; a velocity that is not known is NaN."""
    return _packed(
        sun.grid,
        issued_at_ns=np.int64(sun.issued_at_ns),
        lead_s=sun.lead_s,
        sun_probability=sun.sun_probability,
        horizon_s=sun.horizon_s,
        prior_sunlit=np.float64(sun.prior_sunlit),
        method=np.str_(sun.method),
        velocity_mps=np.array(sun.velocity_mps or (np.nan, np.nan)),
    )


def read_shade(data: bytes) -> ShadeMap:
    """Return the shade map in an archive; raises `MapArchiveError`."""
    with _unpacked(data) as arrays:
        transmittance = _array(arrays, "transmittance", np.float32, 2)
        return ShadeMap(
            grid=_grid(arrays, transmittance),
            captured_at_ns=int(_array(arrays, "captured_at_ns", np.int64, 0)),
            source_serials=tuple(_array(arrays, "source_serials", np.str_, 1).tolist()),
            transmittance=transmittance,
            valid=_array(arrays, "valid", np.bool_, 2),
            confidence=_array(arrays, "confidence", np.float32, 2),
            metres_per_pixel=_array(arrays, "metres_per_pixel", np.float32, 2),
        )


def read_forecast(data: bytes) -> SunForecast:
    """Return the forecast in an archive; raises `MapArchiveError`."""
    with _unpacked(data) as arrays:
        horizon_s = _array(arrays, "horizon_s", np.float32, 2)
        east_mps, north_mps = _array(arrays, "velocity_mps", np.float64, 1).tolist()
        return SunForecast(
            grid=_grid(arrays, horizon_s),
            issued_at_ns=int(_array(arrays, "issued_at_ns", np.int64, 0)),
            lead_s=_array(arrays, "lead_s", np.float64, 1),
            sun_probability=_array(arrays, "sun_probability", np.uint8, 3),
            horizon_s=horizon_s,
            prior_sunlit=float(_array(arrays, "prior_sunlit", np.float64, 0)),
            method=str(_array(arrays, "method", np.str_, 0)),
            velocity_mps=None if np.isnan(east_mps) else (east_mps, north_mps),
        )


def _packed(grid: GroundGrid, **arrays: Any) -> bytes:
    origin = grid.frame.origin
    file = io.BytesIO()
    np.savez(
        file,
        edges_m=np.array([grid.west_m, grid.north_m, grid.cell_m]),
        origin=np.array([origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m]),
        **arrays,
    )
    return file.getvalue()


@contextmanager
def _unpacked(data: bytes) -> Iterator[Arrays]:
    """Yield the arrays of an archive; errors of reading them become a `MapArchiveError`."""
    try:
        yield read_arrays(io.BytesIO(data), MOST_BYTES)
    except (ArchiveError, ValueError, TypeError, KeyError, OverflowError, OSError) as problem:
        raise MapArchiveError(f"expected an archive of a map (.npz): {problem}") from problem


def _array(arrays: Arrays, name: str, kind: type[np.generic], ndim: int) -> npt.NDArray[Any]:
    if name not in arrays:
        raise ValueError(f"expected an array {name}, got {', '.join(arrays)[:80]}")
    array = arrays[name]
    if not np.issubdtype(array.dtype, kind) or array.ndim != ndim:
        raise ValueError(f"{name}: {kind.__name__} of {ndim} dimensions, got {array.dtype}")
    return array


def _grid(arrays: Arrays, cells: npt.NDArray[Any]) -> GroundGrid:
    """Return the grid of cells (R, C)."""
    west_m, north_m, cell_m = _array(arrays, "edges_m", np.float64, 1).tolist()
    frame = LocalFrame(GeoPoint(*_array(arrays, "origin", np.float64, 1).tolist()))
    rows, cols = cells.shape
    return GroundGrid(frame, west_m, north_m, cell_m, rows, cols)
