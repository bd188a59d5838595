"""What has been imaged, and in which light, from the reported positions of vehicles.

A state machine per cell: NOT_YET -> IN_SHADE -> IN_SUN; a cell never falls back. One that no shade
map shows, outside the imaging drone's view, stays IN_SHADE however often it is flown: it is missing
until it is imaged, and no longer (`missing_cells`).

A photo is taken every `interval_s`, but not at known moments. So a cell counts as imaged when it
was in view, without a break, for at least that long: then a photo shows it, whatever the timer's
phase. It counts as imaged in sun when it was in view and sunlit for that long. By default only the
row's own band counts, which is photographed from nearly above.

An app that reports its photos makes none of this necessary (`photo_progress`). Of the others is
assumed: the timer runs, the camera looks straight down with its longer side across the course, and
the vehicle flew straight between two positions a moment apart. What is flown across the rows, at
another height, or faster than planned does not count.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import exp
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from recon.geo.grid_cells import nearest_cells
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.view import Crossing, Window, crossing, nearest_map, sunlit_cells
from recon.model.arrays import BoolArray, IntArray
from recon.model.flown_before import StateArray
from recon.model.shade import ShadeMap
from recon.model.survey import CellState, Survey, planner_goal
from recon.model.units import ns_to_seconds, seconds_to_ns

ShareArray = npt.NDArray[np.float32]
NEVER = -1


@dataclass(frozen=True, slots=True)
class PositionSample:
    """Where a vehicle was, in east-north metres of the site, and when; as received, so late."""

    at_ns: int
    east_m: float
    north_m: float
    height_above_takeoff_m: float
    takeoff_up_m: float | None = None
    """The height of its takeoff point, up of the site's frame; None: not known."""


@dataclass(frozen=True, slots=True)
class PhotoSample:
    """A photo: where its vehicle was, in east-north metres of the site, and when."""

    at_ns: int
    east_m: float
    north_m: float
    height_above_takeoff_m: float
    yaw_deg: float
    takeoff_up_m: float | None = None
    """The height of its takeoff point, up of the site's frame; None: not known."""
    gimbal_pitch_deg: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class InView:
    """Cells of a window that are in view at the end of a path: since when, and since when sunlit.

    `NEVER` where they are not.
    """

    at_ns: int
    window: Window
    since_ns: IntArray
    sunlit_since_ns: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class LightShown:
    """`share` (R, C) of about the last minutes' shade maps that have a value for a cell, 1 before
    the first map; `until_ns` is when the newest of them was captured."""

    share: ShareArray
    until_ns: int | None = None

    def after(self, shade: ShadeMap, plan: SurveyPlan) -> "LightShown":
        """Return it with one more map. One that knows next to no light of what was shown, as while
        a detection is learning the ground or the light is flat, changes nothing."""
        settings, grid, at_ns = plan.settings, plan.cells.grid, shade.captured_at_ns
        # Without maps, as during a change of battery, what was in view is not forgotten.
        since_s = 0.0 if self.until_ns is None else ns_to_seconds(at_ns - self.until_ns)
        since_s = min(max(since_s, 0.0), settings.shade_age_s)
        whole = Window(0, grid.rows, 0, grid.cols)
        _, is_known = sunlit_cells(shade, grid, whole, settings.least_transmittance)
        shown = plan.cells.is_reached & (self.share >= settings.light_shown_from)
        if not is_known.any() or is_known[shown].sum() < settings.decided_least * shown.sum():
            return self
        kept = np.float32(exp(-since_s / settings.light_shown_s))
        share = np.where(is_known, 1.0 - kept * (1.0 - self.share), kept * self.share)
        return LightShown(share, max(at_ns, self.until_ns or at_ns))


@dataclass(frozen=True, slots=True, eq=False)
class CoverageProgress:
    """`state` (R, C) holds `CellState`s on the plan's cells; never written to once made.

    `is_sun_known` (R, C): a shade map had a value for the cell when it was imaged. The two moments
    are when 95 % of the reached cells were imaged, and imaged in sun.
    """

    state: StateArray
    is_sun_known: BoolArray
    light_shown: LightShown
    shade: tuple[ShadeMap, ...] = ()
    waiting: Mapping[str, tuple[PositionSample, ...]] = field(
        default_factory=lambda: MappingProxyType({})
    )
    """Positions by serial whose path from the first on does not count yet."""
    photos: tuple[PhotoSample, ...] = ()
    """Reported photos that do not count yet."""
    in_view: Mapping[str, InView] = field(default_factory=lambda: MappingProxyType({}))
    imaged_95_at_ns: int | None = None
    in_sun_95_at_ns: int | None = None


def first_progress(plan: SurveyPlan) -> CoverageProgress:
    """Return the progress of a survey that has not begun: what it is to leave out counts."""
    cells, flown = plan.cells, plan.survey.flown
    shape = (cells.grid.rows, cells.grid.cols)
    state = np.full(shape, CellState.NOT_YET, dtype=np.uint8)
    is_known = np.zeros(shape, dtype=np.bool_)
    if flown is not None and flown.grid.frame == cells.grid.frame:
        rows, cols, is_on = nearest_cells(flown.grid, cells.grid)
        is_on = is_on & cells.is_inside
        state[is_on] = flown.state[rows, cols][is_on]
        is_known[is_on] = flown.is_light_known[rows, cols][is_on]
    return CoverageProgress(state, is_known, LightShown(np.ones(shape, dtype=np.float32)))


def first_pieces(plan: SurveyPlan) -> tuple[Piece, ...]:
    """Return what of the rows is flown first: all of them, or what an earlier survey has left."""
    if plan.survey.flown is None:
        return plan.pieces
    wanted = planner_goal(plan.survey.planner)
    return plan.pieces_over(missing_cells(first_progress(plan), plan, wanted))


def missing_cells(progress: CoverageProgress, plan: SurveyPlan, wanted: CellState) -> BoolArray:
    """Return (R, C): the reached cells that are to be imaged yet, up to the `wanted` state.

    What is imaged, and shown by no shade map, is not flown again for sun.
    """
    is_imaged: BoolArray = progress.state > CellState.NOT_YET
    is_below: BoolArray = progress.state < wanted
    return plan.cells.is_reached & is_below & ~(is_imaged & not_shown_cells(progress, plan))


def not_shown_cells(progress: CoverageProgress, plan: SurveyPlan) -> BoolArray:
    """Return (R, C): the reached cells whose light shade maps do not show, imaged or not."""
    is_not_shown: BoolArray = progress.light_shown.share < plan.settings.light_shown_from
    return plan.cells.is_reached & is_not_shown


def with_shade(progress: CoverageProgress, shade: ShadeMap, plan: SurveyPlan) -> CoverageProgress:
    """Return the progress with one more shade map to look at; the oldest is dropped."""
    kept = (*progress.shade, shade)[-plan.settings.shade_maps_kept :]
    return replace(progress, shade=kept, light_shown=progress.light_shown.after(shade, plan))


def with_positions(
    progress: CoverageProgress, serial: str, seen: Sequence[PositionSample], plan: SurveyPlan
) -> CoverageProgress:
    """Return the progress with more of a vehicle's path, oldest first; it counts when settled.

    Positions that are out of order, or too near in time to the one before, are excluded; of a
    burst the last one is kept, which is the freshest.
    """
    waiting = list(progress.waiting.get(serial, ()))
    least_ns = seconds_to_ns(plan.settings.least_step_s)
    burst_ns = seconds_to_ns(plan.settings.burst_s)
    for each in seen:
        after_ns = each.at_ns - waiting[-1].at_ns if waiting else least_ns
        if 0 <= after_ns <= burst_ns:
            waiting[-1] = replace(each, at_ns=waiting[-1].at_ns)
        elif after_ns >= least_ns:
            waiting.append(each)
    kept = tuple(waiting[-plan.settings.positions_kept :])
    return replace(progress, waiting=MappingProxyType({**progress.waiting, serial: kept}))


def count_settled(progress: CoverageProgress, plan: SurveyPlan, now_ns: int) -> CoverageProgress:
    """Return the progress with all that has waited long enough counted."""
    until_ns = now_ns - seconds_to_ns(plan.settings.settle_s)
    due = {
        serial: count
        for serial, seen in progress.waiting.items()
        if (count := sum(each.at_ns <= until_ns for each in seen)) > 1
    }
    if not due:
        return progress
    counting = _Counter(progress, plan)
    waiting = dict(progress.waiting)
    for serial, number in due.items():
        for a, b in pairwise(waiting[serial][:number]):
            counting.path(serial, a, b)
        waiting[serial] = waiting[serial][number - 1 :]
    return with_95_times(
        replace(counting.result(), waiting=MappingProxyType(waiting)), plan, until_ns
    )


def with_95_times(progress: CoverageProgress, plan: SurveyPlan, at_ns: int) -> CoverageProgress:
    """Return the progress with the moments noted at which most of it was imaged."""
    reached = plan.cells.is_reached
    states = progress.state[reached]
    enough = 0.95 * max(1, len(states))
    if progress.imaged_95_at_ns is None and (states >= CellState.IN_SHADE).sum() >= enough:
        progress = replace(progress, imaged_95_at_ns=at_ns)
    if progress.in_sun_95_at_ns is None and (states == CellState.IN_SUN).sum() >= enough:
        progress = replace(progress, in_sun_95_at_ns=at_ns)
    return progress


class _Counter:
    """Counts paths on a copy of the progress."""

    def __init__(self, progress: CoverageProgress, plan: SurveyPlan) -> None:
        self._plan = plan
        self._progress = progress
        self._state = progress.state.copy()
        self._is_sun_known = progress.is_sun_known.copy()
        self._in_view = dict(progress.in_view)
        self._interval_ns = seconds_to_ns(plan.survey.camera.interval_s)

    def result(self) -> CoverageProgress:
        """The progress with what was counted."""
        return replace(
            self._progress,
            state=self._state,
            is_sun_known=self._is_sun_known,
            in_view=MappingProxyType(self._in_view),
        )

    def path(self, serial: str, a: PositionSample, b: PositionSample) -> None:
        """Count a vehicle's path between two positions."""
        plan = self._plan
        before = self._in_view.pop(serial, None)
        if before is not None and before.at_ns != a.at_ns:
            before = None
        lying = plan.lattice.along_across_m([(a.east_m, a.north_m), (b.east_m, b.north_m)])
        start, end = ((float(along), float(across)) for along, across in lying)
        moved_m = end[0] - start[0], end[1] - start[1]
        off_m = off_height_m(plan, (a, b))
        if off_m is None or not is_flown_as_planned(
            plan.survey, plan.settings, (a.at_ns, b.at_ns), moved_m, off_m
        ):
            return
        times_ns = (a.at_ns, b.at_ns)
        cross = crossing(plan.cells, plan.lattice, plan.counted_swath, (start, end), times_ns)
        middle_ns = (a.at_ns + b.at_ns) // 2
        shade = nearest_map(self._progress.shade, middle_ns, plan.settings.shade_age_s)
        sunlit, known = sunlit_cells(
            shade, plan.cells.grid, cross.window, plan.settings.least_transmittance
        )
        self._in_view[serial] = self._counted(cross, before, sunlit, known, b.at_ns)

    def _counted(
        self,
        cross: Crossing,
        before: InView | None,
        sunlit: BoolArray,
        known: BoolArray,
        at_ns: int,
    ) -> InView:
        since_ns, lit_since_ns = _carried_over(before, cross.window)
        since_ns = _since(cross, since_ns)
        lit_since_ns = _since(cross, lit_since_ns)
        inside = self._plan.cells.is_inside[cross.window.index] & cross.is_in_view
        imaged = inside & (cross.leaves_ns - since_ns >= self._interval_ns)
        in_sun = inside & sunlit & (cross.leaves_ns - lit_since_ns >= self._interval_ns)
        state = self._state[cross.window.index]
        np.maximum(state, np.where(imaged, CellState.IN_SHADE, 0), out=state, casting="unsafe")
        np.maximum(state, np.where(in_sun, CellState.IN_SUN, 0), out=state, casting="unsafe")
        self._is_sun_known[cross.window.index] |= imaged & known
        stays = cross.stays_in_view
        return InView(
            at_ns,
            cross.window,
            np.where(stays, since_ns, NEVER),
            np.where(stays & sunlit, lit_since_ns, NEVER),
        )


def off_height_m(plan: SurveyPlan, ends: Sequence[PositionSample | PhotoSample]) -> float | None:
    """Return how far places are at most off the heights that a mission may have there; None: it is
    not known."""
    below_m, above_m = 0.0, 0.0
    if plan.terrain is not None:
        below_m, above_m = plan.settings.terrain_below_m, plan.settings.terrain_above_m
    farthest_m = 0.0
    for end in ends:
        place_m, height_m = (end.east_m, end.north_m), end.height_above_takeoff_m
        off_m = plan.height_off_m(place_m, height_m, end.takeoff_up_m)
        if off_m is None:
            return None
        farthest_m = max(farthest_m, off_m - above_m, -off_m - below_m)
    return farthest_m


def is_flown_as_planned(
    survey: Survey,
    settings: SurveySettings,
    times_ns: tuple[int, int],
    moved_m: tuple[float, float],
    off_m: float,
) -> bool:
    """Whether a path is flown as the rows are: height, course, speed, and no gap in time.

    `moved_m` is the path along and across the rows, `off_m` how far it is off the planned height.
    """
    took_s = ns_to_seconds(times_ns[1] - times_ns[0])
    if not 0.0 < took_s <= settings.longest_gap_s:
        return False
    along_m, across_m = abs(moved_m[0]), abs(moved_m[1])
    is_along = across_m <= settings.steepest_course * along_m + settings.course_slack_m
    is_moving = settings.least_move_m <= along_m
    is_slow = along_m <= survey.speed_mps * settings.fastest_share * took_s
    return off_m <= settings.height_slack_m and is_along and is_moving and is_slow


def _carried_over(before: InView | None, window: Window) -> tuple[IntArray, IntArray]:
    """What was in view at the end of the way before, in another window."""
    carried = (np.full(window.shape, NEVER, np.int64), np.full(window.shape, NEVER, np.int64))
    if before is None:
        return carried
    old = before.window
    rows = max(old.first_row, window.first_row), min(old.last_row, window.last_row)
    cols = max(old.first_col, window.first_col), min(old.last_col, window.last_col)
    if rows[0] >= rows[1] or cols[0] >= cols[1]:
        return carried
    there = _within(window, rows, cols)
    here = _within(old, rows, cols)
    carried[0][there] = before.since_ns[here]
    carried[1][there] = before.sunlit_since_ns[here]
    return carried


def _within(window: Window, rows: tuple[int, int], cols: tuple[int, int]) -> tuple[slice, slice]:
    return (
        slice(rows[0] - window.first_row, rows[1] - window.first_row),
        slice(cols[0] - window.first_col, cols[1] - window.first_col),
    )


def _since(cross: Crossing, since_ns: IntArray) -> IntArray:
    """Return since when cells are in view: as before, or from entering on."""
    goes_on = cross.was_in_view & (since_ns != NEVER)
    return np.where(goes_on, since_ns, cross.enters_ns)
