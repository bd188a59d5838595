"""A survey's rows in segments of about 60 m, and how much sun is expected on each, and when."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from recon.geo import nearest_cells
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.progress import CoverageProgress, missing_cells
from recon.guidance.survey.route import RowLeg
from recon.guidance.survey.settings import SurveySettings
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap, SunForecast
from recon.model.survey import CellState
from recon.model.units import ns_to_seconds

NewestForecast = Callable[[], SunForecast | None]
"""Returns the newest forecast; a planner calls it once it decides, since making one takes time."""

NONE = -1
"""Number of a missing neighbour of a segment."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of a piece of a row; `before` and `after` are its neighbours in the same piece."""

    piece: int
    row: int
    across_m: float
    start_m: float
    end_m: float
    before: int
    after: int

    @property
    def length_m(self) -> float:
        """Return the length along the row."""
        return self.end_m - self.start_m


@dataclass(frozen=True, slots=True, eq=False)
class Segments:
    """All segments of a plan, by row and along; `of_cell` (R, C) is each cell's, or `NONE`."""

    parts: tuple[Segment, ...]
    of_cell: IntArray

    def under(self, legs: Sequence[RowLeg]) -> BoolArray:
        """Return (S,): whether a segment lies on one of these legs, wholly or in part."""
        is_under = np.zeros(len(self.parts), dtype=np.bool_)
        for number, part in enumerate(self.parts):
            is_under[number] = any(
                leg.piece.row == part.row
                and min(leg.piece.end_m, part.end_m) - max(leg.piece.start_m, part.start_m) > 1e-6
                for leg in legs
            )
        return is_under


def segments_of(plan: SurveyPlan) -> Segments:
    """Return a plan's rows in segments: neighbouring stretches up to `segment_m` long together."""
    ends: list[tuple[int, float, float]] = []
    of_stretch = np.empty(len(plan.cells.stretches) + 1, dtype=np.int64)
    of_stretch[NONE] = NONE
    for index, stretch in enumerate(plan.cells.stretches):
        last = ends[-1] if ends else None
        if (
            last is not None
            and last[0] == stretch.piece
            and stretch.end_m - last[1] <= plan.settings.segment_m
        ):
            ends[-1] = (stretch.piece, last[1], stretch.end_m)
        else:
            ends.append((stretch.piece, stretch.start_m, stretch.end_m))
        of_stretch[index] = len(ends) - 1
    follows = [False, *(a[0] == b[0] for a, b in pairwise(ends)), False]
    parts = []
    for number, (piece, start_m, end_m) in enumerate(ends):
        row = plan.pieces[piece].row
        before = number - 1 if follows[number] else NONE
        after = number + 1 if follows[number + 1] else NONE
        across_m = plan.lattice.row_across_m(row)
        parts.append(Segment(piece, row, across_m, start_m, end_m, before, after))
    return Segments(tuple(parts), of_stretch[plan.cells.stretch])


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedSun:
    """`missing_m2` (S,): ground of each segment not imaged in sun yet; `probability` (S, K): of
    sun there, at `moments_s` (K,) from now on."""

    missing_m2: FloatArray
    probability: FloatArray
    moments_s: FloatArray

    def at(self, segment: int, at_s: float) -> float:
        """Return the probability at the nearest moment; beyond the last one it stays."""
        step_s = float(self.moments_s[1] - self.moments_s[0])
        moment = min(len(self.moments_s) - 1, round(at_s / step_s))
        return float(self.probability[segment, moment])

    def is_clear(self, chosen: BoolArray, least: float) -> bool:
        """Return whether the mean probability over the chosen (S,) missing ground reaches it."""
        missing_m2 = np.where(chosen, self.missing_m2, 0.0)
        sun = float((missing_m2 @ self.probability).mean() / missing_m2.sum())
        return sun >= least


def expected_sun(
    segments: Segments,
    plan: SurveyPlan,
    progress: CoverageProgress,
    sun: SunForecast | None,
    now_ns: int,
) -> ExpectedSun | None:
    """Return the sun expected on each segment's missing ground; None if light is unknown anywhere.

    Without a recent forecast the newest shade map counts, the less the older it is. A forecast that
    has seen no light yet, as while a detection is still learning the ground, does not count.
    """
    settings = plan.settings
    missing = missing_cells(progress, plan, CellState.IN_SUN)
    moments_s = np.arange(0.0, settings.planned_s + settings.moment_s, settings.moment_s)
    if sun is not None and _is_usable(sun, now_ns, settings):
        by_cell = _forecast(sun, plan.cells.grid, missing, moments_s, now_ns)
    elif (seen := _seen(progress, now_ns, settings)) is not None:
        by_cell = _persisting(seen, plan.cells.grid, missing, moments_s, now_ns, settings)
    else:
        return None
    of_cell = segments.of_cell[missing]
    count = np.bincount(of_cell, minlength=len(segments.parts))
    sums = np.stack([np.bincount(of_cell, each, len(segments.parts)) for each in by_cell], axis=1)
    probability = sums / np.maximum(count, 1)[:, np.newaxis]
    missing_m2 = count.astype(np.float64) * plan.cells.cell_m2
    return ExpectedSun(missing_m2, probability, moments_s)


def _is_usable(sun: SunForecast, now_ns: int, settings: SurveySettings) -> bool:
    is_recent = ns_to_seconds(now_ns - sun.issued_at_ns) <= settings.forecast_age_s
    return is_recent and bool(np.isfinite(sun.horizon_s).any())


def _forecast(
    sun: SunForecast, grid: GroundGrid, missing: BoolArray, moments_s: FloatArray, now_ns: int
) -> FloatArray:
    """(K, N): each missing cell's probability of sun at each moment."""
    cells, is_on = _cells_of(sun.grid, grid, missing)
    at_lead = sun.sun_probability[:, cells[0], cells[1]] / 255.0
    at_lead = np.where(is_on, at_lead, sun.prior_sunlit)
    leads_s = moments_s + ns_to_seconds(now_ns - sun.issued_at_ns)
    after = np.clip(np.searchsorted(sun.lead_s, leads_s), 1, len(sun.lead_s) - 1)
    before_s, after_s = sun.lead_s[after - 1], sun.lead_s[after]
    share = np.clip((leads_s - before_s) / (after_s - before_s), 0.0, 1.0)[:, np.newaxis]
    found: FloatArray = at_lead[after - 1] * (1.0 - share) + at_lead[after] * share
    return found


def _seen(progress: CoverageProgress, now_ns: int, settings: SurveySettings) -> ShadeMap | None:
    newest = max(progress.shade, key=lambda shade: shade.captured_at_ns, default=None)
    if newest is None or not newest.valid.any():
        return None
    age_s = ns_to_seconds(now_ns - newest.captured_at_ns)
    return newest if age_s <= settings.shade_persists_s else None


def _persisting(
    shade: ShadeMap,
    grid: GroundGrid,
    missing: BoolArray,
    moments_s: FloatArray,
    now_ns: int,
    settings: SurveySettings,
) -> FloatArray:
    """(K, N): sun or shade persists, the less surely the longer ago it was seen."""
    cells, is_on = _cells_of(shade.grid, grid, missing)
    is_known = shade.valid[cells] & is_on
    with np.errstate(invalid="ignore"):
        in_sun = shade.transmittance[cells] >= SUNLIT_TRANSMITTANCE
    off = np.where(is_known, np.where(in_sun, 0.5, -0.5), 0.0)
    ages_s = moments_s + ns_to_seconds(now_ns - shade.captured_at_ns)
    found: FloatArray = 0.5 + off * np.exp(-ages_s / settings.shade_persists_s)[:, np.newaxis]
    return found


def _cells_of(
    there: GroundGrid, grid: GroundGrid, chosen: BoolArray
) -> tuple[tuple[IntArray, IntArray], BoolArray]:
    """Return for each chosen cell of `grid` the nearest one of another grid, and if it is on it."""
    rows, cols, is_on = nearest_cells(there, grid)
    at_row, at_col = np.broadcast_arrays(rows, cols)
    return (at_row[chosen], at_col[chosen]), is_on[chosen]
