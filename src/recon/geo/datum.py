"""From any coordinate reference system to WGS84, by the best path that PROJ has here.

PROJ falls back silently: to a path without its grid, metres off, and where it knows none to a
"ballpark" one that leaves degrees as they are, off by up to hundreds of metres. So the path is
chosen for the place, and its accuracy is stated.
"""

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pyproj

WGS84 = "EPSG:4326"
AS_WGS84 = frozenset({"China 2000", "D_China_2000", "China_2000"})
"""Datums that are WGS84 within decimetres, and that PROJ has no path for."""
AS_WGS84_M = 0.5
UNKNOWN_BY_WGS84 = ("unknown", "not_specified", "not specified")
"""How the name of a datum begins that is known by its ellipsoid alone."""

_FILES = re.compile(r"nadgrids=(?!@null\b)|geoidgrids|PARAMETERFILE", re.IGNORECASE)


class UnknownDatumError(Exception):
    """A coordinate reference system that PROJ does not know."""


@dataclass(frozen=True, slots=True)
class PathToWgs84:
    """A transformation to WGS84."""

    name: str
    """Of the system it begins with."""
    description: str
    """Of the transformation, by PROJ."""
    accuracy_m: float | None
    """None where no transformation is known: degrees stay as they are."""
    _transformer: "pyproj.Transformer"

    def to_globe(self, places: Sequence[tuple[float, ...]]) -> list[tuple[float, float]]:
        """Return longitudes and latitudes in degrees of places (x, y); infinite off the map."""
        points = np.array([place[:2] for place in places], dtype=np.float64).reshape(-1, 2)
        moved = self._transformer.transform(points[:, 0], points[:, 1])
        return list(zip(*(part.tolist() for part in moved), strict=True))


def path_to_wgs84(crs: Any, places: Sequence[tuple[float, ...]] = ()) -> PathToWgs84:
    """Return the best path to WGS84 for places (x, y) of a system that PROJ reads.

    Raises `UnknownDatumError`.
    """
    import pyproj
    from pyproj.transformer import TransformerGroup

    try:
        known = pyproj.CRS.from_user_input(crs)
        with warnings.catch_warnings(action="ignore"):
            # That a grid is missing shows in the accuracy of what is left.
            paths = TransformerGroup(
                known, WGS84, always_xy=True, area_of_interest=_area(known, places)
            ).transformers
    except pyproj.exceptions.ProjError as problem:
        raise UnknownDatumError(
            "expected a known coordinate reference system, got another"
        ) from problem
    if not paths:
        raise UnknownDatumError("expected a system that PROJ relates to WGS84, got another one")
    best = paths[0]
    accuracy_m: float | None = best.accuracy if best.accuracy >= 0.0 else None
    if accuracy_m is None and is_as_wgs84(known):
        accuracy_m = AS_WGS84_M
    return PathToWgs84(known.name, best.description, accuracy_m, best)


def map_from_globe(crs: "pyproj.CRS") -> "pyproj.Transformer":
    """Return the path from longitude and latitude to a map's coordinates.

    Raises `pyproj.exceptions.ProjError` where none is known: a ballpark one would be off by up to
    hundreds of metres, without a word.
    """
    import pyproj

    return pyproj.Transformer.from_crs(WGS84, crs, always_xy=True, allow_ballpark=is_as_wgs84(crs))


def names_files(wkt: str) -> bool:
    """Return whether a reference system makes PROJ look for files that it names."""
    return _FILES.search(wkt) is not None


def horizontal(crs: "pyproj.CRS") -> "pyproj.CRS":
    """Return the horizontal part of a reference system, with its shift to WGS84 if it has one."""
    if crs.is_bound:
        return crs
    return horizontal(crs.sub_crs_list[0]) if crs.is_compound else crs.to_2d()


def is_as_wgs84(crs: "pyproj.CRS") -> bool:
    """Return whether a system has no path to WGS84, and is it within decimetres."""
    geodetic = crs.geodetic_crs
    datum = None if geodetic is None else geodetic.datum
    if datum is None:
        return False
    ellipsoid = "" if datum.ellipsoid is None else datum.ellipsoid.name
    is_unknown = datum.name.lower().startswith(UNKNOWN_BY_WGS84)
    return datum.name in AS_WGS84 or (is_unknown and ellipsoid in ("WGS 84", "WGS_1984"))


def _area(crs: "pyproj.CRS", places: Sequence[tuple[float, ...]]) -> Any:
    """Return where a few of the places are, roughly: a country has several paths."""
    from pyproj import Transformer
    from pyproj.aoi import AreaOfInterest

    if not places:
        return None
    points = np.array([place[:2] for place in places[:1]], dtype=np.float64)
    longitude, latitude = Transformer.from_crs(crs, WGS84, always_xy=True).transform(
        points[:, 0], points[:, 1]
    )
    if not np.isfinite([*longitude, *latitude]).all():
        return None
    east, north = float(longitude[0]), float(latitude[0])
    return AreaOfInterest(east, north, east, north)
