"""Heights for approaches: each vehicle of a survey has layers of its own, away from all rows.

Above takeoff, all rows have one height, and layers lie above and below it. Above ground, rows have
any height between the lowest and the highest wanted one along a vehicle's path. Layers are then
counted from the highest wanted height of the whole survey, so that no two vehicles share one
wherever they took off, and a vehicle takes those of its own that are clear of the rows on its way.
"""

from itertools import pairwise
from math import ceil, hypot, isfinite

import numpy as np

from recon.guidance.survey.terrain import Terrain
from recon.model.airspace import LAYER_SPACING_M, FlightLimits
from recon.model.arrays import FloatArray
from recon.safety.airspace import PreparedAirspace

SPARE_M = 5.0
"""Margin under the site's ceiling: the ground may be higher there than the takeoff point."""

LOWEST_M = 20.0
"""No approach is lower: trees and buildings are in a zone, or lower than this."""

EVERY_M = 5.0
"""Wanted heights are looked up along a path at places this far apart: their lattice is as fine."""

ROUNDING_M = 0.01


def layers_above_takeoff_m(
    rows_m: float, number: int, count: int, limits: FlightLimits
) -> list[float]:
    """Return the layers of vehicle `number` of `count` for rows at one height, nearest first."""
    ceiling_m = limits.max_height_above_ground_m - SPARE_M
    steps = range(1, 1 + int(max(ceiling_m, rows_m) // LAYER_SPACING_M))
    outwards = [rows_m + sign * step * LAYER_SPACING_M for step in steps for sign in (1.0, -1.0)]
    layers_m = [each for each in outwards if LOWEST_M <= each <= ceiling_m] or [rows_m]
    return layers_m[number::count] or layers_m[-1:]


def layers_over_terrain_m(
    terrain: Terrain,
    airspace: PreparedAirspace,
    path_m: FloatArray,
    end_m: FloatArray,
    number: int,
    count: int,
) -> list[float]:
    """Return a vehicle's layers above its path (N, 2) to its first row and above the end of its
    last one, (2,), up of the frame; the nearest to the rows first. None may be free of ground and
    rows.
    """
    wanted_m = terrain.up_m(np.concatenate([_along(path_m), end_m[np.newaxis]]))
    low_m, high_m = float(wanted_m.min()), float(wanted_m.max())
    floor_m, ceiling_m = _heights_allowed_m(airspace, np.concatenate([path_m, end_m[np.newaxis]]))

    def off_rows_m(layer_m: float) -> float:
        return max(layer_m - high_m, low_m - layer_m)

    farthest_m = max(terrain.highest_up_m - floor_m, ceiling_m - terrain.highest_up_m)
    if not isfinite(farthest_m):
        return []
    # Every `count`-th layer from the highest rows upwards and downwards is its own.
    most = ceil(farthest_m / LAYER_SPACING_M)
    steps = (step for step in range(-most, most + 1) if (step - 1 - number) % count == 0)
    own_m = [terrain.highest_up_m + step * LAYER_SPACING_M for step in steps]
    free_m = [
        each
        for each in own_m
        if floor_m <= each <= ceiling_m and off_rows_m(each) >= LAYER_SPACING_M - ROUNDING_M
    ]
    return sorted(free_m, key=lambda each: (off_rows_m(each), -each))


def _along(path_m: FloatArray) -> FloatArray:
    """The places of a path, and more of them in between."""
    places = [path_m[:1]]
    for a, b in pairwise(path_m):
        pieces = 1 + int(hypot(*(b - a)) / EVERY_M)
        share = np.linspace(0.0, 1.0, pieces + 1)[1:, np.newaxis]
        places.append(a * (1.0 - share) + b * share)
    return np.concatenate(places)


def _heights_allowed_m(airspace: PreparedAirspace, places_m: FloatArray) -> tuple[float, float]:
    """The lowest and the highest height for a level flight along a path, up of the frame."""
    starts, ends = places_m[:-1], places_m[1:]
    lowest_m, highest_m = airspace.ground_within_up_m(np.stack([starts, ends, ends], axis=1))
    most_m = airspace.airspace.limits.max_height_above_ground_m - SPARE_M
    return float(highest_m.max()) + LOWEST_M, float(lowest_m.min()) + most_m
