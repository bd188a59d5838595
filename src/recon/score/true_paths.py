"""Where vehicles truly were, and what follows: photos and their light, separation, fence, battery.

The station never learns of it. A photo counts for the cells that a mosaic would take from it: the
band of its row, as in surveys.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import ceil
from random import Random

import numpy as np

from recon.geo import Polygon, enu_from_point
from recon.guidance.survey import SurveyPlan
from recon.model.airspace import ZoneKind
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import LocalFrame
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import NS_PER_S
from recon.score.settings import SCORE
from recon.sim.app.app import SimulatedApp
from recon.sim.world import Sky
from recon.site import Site

STEEPEST_COURSE = 0.27
"""Largest ratio of motion across to along a row that counts as flown along it, as in surveys."""


@dataclass(frozen=True, slots=True, eq=False)
class Photos:
    """Where photos were taken on rows: `at_s` (N,), `places_m` (N, 2) east-north."""

    at_s: FloatArray
    places_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Imaged:
    """Times at which each cell of the plan was on a photo; infinite where it never was.

    A photo is shaded when more than half of the region's cells on it lie in shade.
    """

    first_s: FloatArray
    """(R, C): when a cell was first on a photo."""
    first_in_sun_s: FloatArray
    photos: int
    shaded_photos: int


def phases_s(seed: int, serials: Sequence[str], interval_s: float) -> list[float]:
    """Return when in each interval the camera timers of drones trigger.

    A pilot starts the timer by hand before the flight, so the station cannot know its phase: here
    it is a function of seed and serial.
    """
    return [Random(f"{seed}/{serial}/shutter").uniform(0.0, interval_s) for serial in serials]


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
    half_along_m = survey.camera.along_m(survey.height_m) / 2.0
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


AT_HEIGHT_WITHIN_M = 3.0
"""Tolerance of the survey's height: cruise heights to and from rows are 10 m away from it."""
SLOWEST_ON_ROW_MPS = 0.2
"""Speed below which the course is undefined: the drone turns, or waits."""
COURSE_OVER_S = 0.5


@dataclass(slots=True)
class TruePath:
    """One vehicle's path, sampled: `places_m` east, north, up of the site's frame."""

    app: SimulatedApp
    home_m: tuple[float, float, float]
    at_s: list[float] = field(default_factory=list)
    places_m: list[tuple[float, float, float]] = field(default_factory=list)
    is_up: list[bool] = field(default_factory=list)
    landed_with: list[float] = field(default_factory=list)
    """Battery at each landing, 0 to 1."""

    def sample(self, now_ns: int) -> None:
        """Append the present position."""
        aircraft = self.app.aircraft
        motion = aircraft.motion
        was_up = bool(self.is_up) and self.is_up[-1]
        self.at_s.append(now_ns / NS_PER_S)
        east_m, north_m, up_m = self.home_m
        place_m = (motion.east_m + east_m, motion.north_m + north_m, motion.height_m + up_m)
        self.places_m.append(place_m)
        self.is_up.append(aircraft.is_flying)
        if was_up and not aircraft.is_flying and not aircraft.has_crashed:
            self.landed_with.append(aircraft.battery.fraction)

    def at(self, moments_s: FloatArray) -> FloatArray:
        """Return positions (N, 3) at moments (N,), linear between samples."""
        places = np.array(self.places_m)
        return np.stack([np.interp(moments_s, self.at_s, axis) for axis in places.T], axis=1)

    @property
    def flown_s(self) -> float:
        """Time in the air."""
        steps_s = np.diff(self.at_s, prepend=self.at_s[:1])
        return float(steps_s[np.array(self.is_up)].sum())


def true_path(app: SimulatedApp, frame: LocalFrame) -> TruePath:
    """Return an app's path, without samples."""
    east_m, north_m, up_m = enu_from_point(frame, app.settings.home).tolist()
    return TruePath(app, (east_m, north_m, up_m))


def photos_on_rows(path: TruePath, phase_s: float, plan: SurveyPlan) -> Photos:
    """Return the photos of a timer of that phase that were taken along rows at survey height."""
    interval_s = plan.survey.camera.interval_s
    at_s = np.arange(phase_s, path.at_s[-1], interval_s)
    places = path.at(at_s)
    moved = path.at(at_s + COURSE_OVER_S)[:, :2] - path.at(at_s - COURSE_OVER_S)[:, :2]
    lying = plan.lattice.along_across_m(places[:, :2] + moved) - plan.lattice.along_across_m(
        places[:, :2]
    )
    along_m, across_m = np.abs(lying).T
    is_fast = np.hypot(*moved.T) >= 2.0 * COURSE_OVER_S * SLOWEST_ON_ROW_MPS
    is_level = np.abs(places[:, 2] - _wanted_up_m(path, places, plan)) <= AT_HEIGHT_WITHIN_M
    chosen = is_fast & is_level & (across_m <= STEEPEST_COURSE * along_m)
    return Photos(at_s[chosen], places[chosen, :2])


def _wanted_up_m(path: TruePath, places_m: FloatArray, plan: SurveyPlan) -> FloatArray:
    """Return the survey's height at (N, 3) places, up of the frame, (N,)."""
    if plan.terrain is not None:
        return plan.terrain.up_m(places_m[:, :2])
    return np.full(len(places_m), path.home_m[2] + plan.survey.height_m)


def encounters(paths: Sequence[TruePath]) -> int:
    """Return how often two vehicles in the air came too near, level and over the ground."""
    count = 0
    for one, other in combinations(paths, 2):
        apart = np.array(one.places_m) - np.array(other.places_m)
        near = np.hypot(apart[:, 0], apart[:, 1]) < SCORE.separation_m
        near &= np.abs(apart[:, 2]) < SCORE.separation_up_m
        near &= np.array(one.is_up) & np.array(other.is_up)
        count += times_begun(near)
    return count


def breaches(paths: Sequence[TruePath], site: Site) -> int:
    """Return how often a vehicle in the air left the boundary or entered a keep-out zone."""
    return sum(times_begun(_is_outside(path, site)) for path in paths)


def times_begun(mask: BoolArray) -> int:
    """Return how often a mask (N,) turns True; True at the start counts."""
    return int((mask & ~np.concatenate(([False], mask[:-1]))).sum())


def _is_outside(path: TruePath, site: Site) -> BoolArray:
    places = np.array(path.places_m)
    outside = np.zeros(len(places), dtype=np.bool_)
    if site.layers.boundary is not None:
        outside |= Polygon(site.layers.boundary).distance_to_edge_m(places[:, :2]) < 0.0
    for zone in site.layers.zones:
        if zone.kind is ZoneKind.KEEP_OUT:
            outside |= Polygon(zone.region).distance_to_edge_m(places[:, :2]) > 0.0
    is_up = np.array(path.is_up, dtype=np.bool_)
    return np.logical_and(outside, is_up, dtype=np.bool_)
