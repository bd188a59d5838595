"""Whether pieces of a path stay above or below a height, and heights in words."""

import numpy as np
import numpy.typing as npt

from recon.model.zone import HeightDatum, Zone
from recon.safety.airspace import PreparedAirspace

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


def stays_above(
    airspace: PreparedAirspace,
    triangles_m: FloatArray,
    low_m: FloatArray,
    height_m: float,
    datum: HeightDatum = HeightDatum.GROUND,
) -> BoolArray:
    """Return which of N pieces, (N, 3, 2) down to (N,) up_m, are nowhere below a height.

    Over the ground: the highest ground under the whole piece counts.
    """
    if datum is HeightDatum.WGS84:
        return np.asarray(low_m >= height_m - airspace.origin_height_m)
    return airspace.is_ground_below(triangles_m, low_m - height_m)


def stays_below(
    airspace: PreparedAirspace,
    triangles_m: FloatArray,
    high_m: FloatArray,
    height_m: float,
    datum: HeightDatum = HeightDatum.GROUND,
) -> BoolArray:
    """Return which of N pieces, (N, 3, 2) up to (N,) up_m, are nowhere above a height.

    Over the ground: the lowest ground under the whole piece counts.
    """
    if datum is HeightDatum.WGS84:
        return np.asarray(high_m <= height_m - airspace.origin_height_m)
    return airspace.is_ground_above(triangles_m, high_m - height_m)


def up_of(
    airspace: PreparedAirspace, here_m: FloatArray, height_m: float, datum: HeightDatum
) -> float:
    """Return the up_m of a height over a (3,) place; NaN over ground that is not known."""
    if datum is HeightDatum.WGS84:
        return height_m - airspace.origin_height_m
    return float(airspace.ground_up_m(here_m[np.newaxis, :2])[0]) + height_m


def zone_datum(zone: Zone) -> HeightDatum:
    """Return what a zone's heights count from; a zone without any needs none."""
    return zone.datum or HeightDatum.GROUND


def height_words(height_m: float, datum: HeightDatum) -> str:
    """Return a height with what it counts from."""
    return f"{height_m:g} m above {'ground' if datum is HeightDatum.GROUND else 'the ellipsoid'}"
