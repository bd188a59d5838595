"""Which way the rows of a region run best: with the fewest turns."""

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.rows import lattice_over, lines_along, turned
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.swath import Swath

FloatArray = npt.NDArray[np.float64]

STEP_DEG = 15.0
"""Tried all round, besides the directions of the longest edges."""

MOST_EDGES = 16


def best_bearing_deg(area: shapely.Geometry, swath: Swath, settings: SurveySettings) -> float:
    """Return the bearing in [0, 180) whose rows are in the fewest pieces, then the shortest."""
    return min(_candidates_deg(area), key=lambda deg: (*_cost(area, deg, swath, settings), deg))


def _cost(
    area: shapely.Geometry, bearing_deg: float, swath: Swath, settings: SurveySettings
) -> tuple[int, float]:
    """How many pieces, and their length in whole metres, of the rows' middle lines in the area."""
    lattice = lattice_over(area, bearing_deg, swath, settings)
    lying = turned(area, bearing_deg)
    west, _south, east, _north = lying.bounds
    lines = lines_along(west, east, lattice.rows_across_m)
    parts = shapely.get_parts(shapely.intersection(lying, lines))
    long_m = shapely.length(parts)
    return int((long_m > 0.0).sum()), round(float(long_m.sum()))


def _candidates_deg(area: shapely.Geometry) -> list[float]:
    """Round bearings, and those of the longest edges to a tenth of a degree."""
    edges = np.diff(shapely.get_coordinates(area.exterior), axis=0)
    longest = edges[np.argsort(-np.hypot(edges[:, 0], edges[:, 1]), kind="stable")][:MOST_EDGES]
    of_edges = np.rad2deg(np.arctan2(longest[:, 0], longest[:, 1]))
    bearings: FloatArray = np.concatenate([np.arange(0.0, 180.0, STEP_DEG), of_edges.round(1)])
    return sorted({float(deg) for deg in np.mod(bearings, 180.0)})
