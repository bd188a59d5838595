"""What photos truly show, and in which light; the station never learns of it.

A photo counts for the cells that a mosaic would take from it: the band of its row, as in surveys.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
import numpy.typing as npt

from recon.guidance.survey import SurveyPlan
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.sim.camera.survey_shutter import IntervalTimer
from recon.sim.world import Sky

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

STEEPEST_COURSE = 0.27
"""Largest ratio of motion across to along a row that counts as flown along it, as in surveys."""


@dataclass(frozen=True, slots=True, eq=False)
class Photos:
    """Where photos were taken on rows: `at_s` (N,), `places_m` (N, 2) east-north."""

    at_s: FloatArray
    places_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Imaged:
    """When each cell of the plan was on a photo; infinite where it never was.

    A photo is shaded when more than half of the region's cells on it lie in shade.
    """

    first_s: FloatArray
    """(R, C): when a cell was first on a photo."""
    first_in_sun_s: FloatArray
    photos: int
    shaded_photos: int


def phases_s(seed: int, serials: Sequence[str], interval_s: float) -> list[float]:
    """Return when in each interval the camera timers of drones trigger, as in the simulator."""
    return [IntervalTimer(seed, serial, interval_s).phase_s for serial in serials]


def imaged(photos: Sequence[Photos], plan: SurveyPlan, sky: Sky) -> Imaged:
    """Return what the photos of all drones show."""
    shape = plan.cells.is_inside.shape
    first_s, first_in_sun_s = np.full(shape, np.inf), np.full(shape, np.inf)
    taken = shaded = 0
    for each in photos:
        number, cells = _shown(each, plan)
        if cells.size == 0:
            continue
        at_s = each.at_s[number]
        east_m, north_m = _middles_m(plan, cells)
        in_sun = sky.transmittance(east_m, north_m, at_s) >= SUNLIT_TRANSMITTANCE
        np.minimum.at(first_s.reshape(-1), cells, at_s)
        np.minimum.at(first_in_sun_s.reshape(-1), cells[in_sun], at_s[in_sun])
        shown = np.bincount(number, minlength=len(each.at_s))
        lit = np.bincount(number[in_sun], minlength=len(each.at_s))
        taken += int((shown > 0).sum())
        shaded += int(((shown > 0) & (2 * lit < shown)).sum())
    return Imaged(first_s, first_in_sun_s, taken, shaded)


def _shown(photos: Photos, plan: SurveyPlan) -> tuple[IntArray, IntArray]:
    """Return pairs (N,): a photo's index, and the flat index of a cell of the region on it."""
    survey, cells = plan.survey, plan.cells
    half_along_m = survey.camera.along_m(survey.height_above_takeoff_m) / 2.0
    half_across_m = plan.counted_swath.half_across_m
    lying = plan.lattice.along_across_m(photos.places_m)
    reach = ceil(np.hypot(half_along_m, half_across_m) / cells.grid.cell_m) + 1
    numbers: list[IntArray] = []
    shown: list[IntArray] = []
    for number, ((east_m, north_m), (along_m, across_m)) in enumerate(
        zip(photos.places_m.tolist(), lying.tolist(), strict=True)
    ):
        row = int((cells.grid.north_m - north_m) / cells.grid.cell_m)
        col = int((east_m - cells.grid.west_m) / cells.grid.cell_m)
        rows = slice(max(row - reach, 0), max(row + reach + 1, 0))
        cols = slice(max(col - reach, 0), max(col + reach + 1, 0))
        is_shown = np.abs(cells.along_m[rows, cols] - along_m) <= half_along_m
        is_shown &= np.abs(cells.across_m[rows, cols] - across_m) <= half_across_m
        is_shown &= cells.is_inside[rows, cols]
        found = np.nonzero(is_shown)
        flat = (found[0] + rows.start) * cells.grid.cols + found[1] + cols.start
        numbers.append(np.full(len(flat), number, dtype=np.int64))
        shown.append(flat.astype(np.int64))
    if not numbers:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    return np.concatenate(numbers), np.concatenate(shown)


def _middles_m(plan: SurveyPlan, cells: IntArray) -> tuple[FloatArray, FloatArray]:
    grid = plan.cells.grid
    row, col = np.divmod(cells, grid.cols)
    return grid.west_m + (col + 0.5) * grid.cell_m, grid.north_m - (row + 0.5) * grid.cell_m
