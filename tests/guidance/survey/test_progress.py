"""Progress: what counts as imaged, and in which light, and what does not."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import FRAME, planned, rectangle, survey_of
from tests.guidance.survey.flyers import middles_m

from recon.guidance.survey import (
    CoverageProgress,
    PositionSample,
    SurveyPlan,
    SurveyState,
    create,
    figures,
    observe,
    observe_shade,
    start,
    step,
)
from recon.guidance.survey.progress import (
    count_settled,
    first_progress,
    missing_cells,
    with_positions,
    with_shade,
)
from recon.guidance.survey.view import crossing
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap
from recon.model.survey import CellState
from recon.model.units import seconds_to_ns

BoolArray = npt.NDArray[np.bool_]

PLAN = planned(survey_of(rectangle(300.0, 200.0), bearing_deg=90.0))
"""From 60 m a photo shows 78 m across and 58.5 m along, less 3 m on each side; every 2 s, 8 m/s."""

ROW_M = float(PLAN.lattice.east_north_m([(0.0, PLAN.lattice.row_across_m(3))])[0, 1])
LATE_NS = seconds_to_ns(1_000.0)


def row_flown(speed_mps: float = 8.0, hz: float = 1.0, **changes: float) -> list[PositionSample]:
    """Positions along a whole row from the west, from 10 s on."""
    count = int(300.0 / speed_mps * hz)
    seen = [
        PositionSample(seconds_to_ns(10.0 + i / hz), speed_mps * i / hz, ROW_M, 60.0)
        for i in range(count)
    ]
    return [replace(each, **changes) for each in seen]


def counted(
    seen: list[PositionSample], *shade: ShadeMap, plan: SurveyPlan = PLAN
) -> CoverageProgress:
    progress = first_progress(plan)
    for each in shade:
        progress = with_shade(progress, each, plan)
    return count_settled(with_positions(progress, "A", seen, plan), plan, LATE_NS)


def shade(at_s: float, is_lit: bool = True, valid: bool = True) -> ShadeMap:
    grid = GroundGrid(FRAME, -50.0, 250.0, 10.0, 30, 40)
    shape = (grid.rows, grid.cols)
    lit = np.full(shape, 1.0 if is_lit else 0.0, np.float32)
    one = np.ones(shape, np.float32)
    return ShadeMap(grid, seconds_to_ns(at_s), (), lit, np.full(shape, valid), one, one)


def imaged(progress: CoverageProgress) -> BoolArray:
    return np.asarray(progress.state >= CellState.IN_SHADE)


def near_row(within_m: float) -> BoolArray:
    """The cells so near to the row, (R, C)."""
    grid = PLAN.cells.grid
    near = np.abs(middles_m(grid)[:, 1] - ROW_M) <= within_m
    return near.reshape(grid.rows, grid.cols) & PLAN.cells.is_inside


class TestImaged:
    def test_a_row_images_its_own_band(self) -> None:
        """And 3 m more, for it may be flown as far beside."""
        cells = imaged(counted(row_flown()))
        inner = (PLAN.cells.along_m > 20.0) & (PLAN.cells.along_m < 270.0)
        assert (cells[inner] == near_row(PLAN.lattice.spacing_m / 2.0 + 3.0)[inner]).all()

    def test_where_neighbours_count_it_images_the_footprint_less_the_slack(self) -> None:
        survey = replace(PLAN.survey, counts_neighbours=True)
        cells = imaged(counted(row_flown(), plan=planned(survey)))
        inner = (PLAN.cells.along_m > 20.0) & (PLAN.cells.along_m < 270.0)
        half_m = 60.0 * np.tan(np.deg2rad(33.0)) - 3.0
        assert half_m > 1.9 * (PLAN.lattice.spacing_m / 2.0 + 3.0)
        assert (cells[inner] == near_row(half_m)[inner]).all()

    @pytest.mark.parametrize("hz", [0.5, 1.0, 2.0, 5.0, 10.0])
    def test_at_any_telemetry_rate(self, hz: float) -> None:
        east_m = PLAN.cells.along_m
        inner = (east_m > 20.0) & (east_m < 270.0) & near_row(15.0)
        assert imaged(counted(row_flown(hz=hz)))[inner].all()

    def test_counting_bit_by_bit_is_counting_at_once(self) -> None:
        seen = row_flown(hz=2.0)
        progress = first_progress(PLAN)
        for each in seen:
            progress = with_positions(progress, "A", [each], PLAN)
            progress = count_settled(progress, PLAN, each.at_ns + seconds_to_ns(1.3))
        progress = count_settled(progress, PLAN, LATE_NS)
        assert np.array_equal(progress.state, counted(seen).state)

    def test_what_is_in_view_for_less_than_an_interval_is_not_imaged(self) -> None:
        """Its last 8 m are flown in a second: no photo is sure to fall into it."""
        last = row_flown()[-2:]
        assert not imaged(counted(last)).any()
        assert imaged(counted(row_flown()[-6:])).any()

    @pytest.mark.parametrize(
        ("seen", "why"),
        [
            (row_flown(height_above_takeoff_m=66.0), "too high"),
            (row_flown(height_above_takeoff_m=54.0), "too low"),
            (row_flown(speed_mps=13.0), "too fast"),
            (row_flown(hz=0.25), "gaps of four seconds"),
            ([replace(s, east_m=s.north_m, north_m=s.east_m) for s in row_flown()], "across rows"),
            ([replace(s, north_m=s.east_m * 0.5) for s in row_flown()], "aslant"),
            ([replace(s, east_m=100.0) for s in row_flown()], "standing"),
            (list(reversed(row_flown())), "backwards in time"),
        ],
    )
    def test_what_is_not_flown_as_a_row_counts_for_nothing(
        self, seen: list[PositionSample], why: str
    ) -> None:
        assert not imaged(counted(seen)).any(), why

    def test_rows_may_be_flown_either_way(self) -> None:
        back = [replace(s, east_m=300.0 - s.east_m) for s in row_flown()]
        assert imaged(counted(back)).sum() > 0.8 * imaged(counted(row_flown())).sum()

    def test_a_gap_breaks_what_was_in_view(self) -> None:
        seen = row_flown()
        whole = imaged(counted(seen))
        broken = imaged(counted([*seen[:15], *seen[19:]]))
        assert (whole & ~broken).any()
        assert not (broken & ~whole).any()

    def test_positions_that_were_dropped_break_what_was_in_view(self) -> None:
        """When the buffer overflows the oldest are dropped, and the path to the next is unknown."""
        plan = replace(PLAN, settings=replace(PLAN.settings, positions_kept=4))
        seen = row_flown()
        progress = with_positions(first_progress(plan), "A", seen[:15], plan)
        progress = count_settled(progress, plan, LATE_NS)
        few = count_settled(with_positions(progress, "A", seen[15:], plan), plan, LATE_NS)
        alone = [seen[11:15], seen[-4:]]
        expected = imaged(counted(alone[0])) | imaged(counted(alone[1]))
        assert np.array_equal(imaged(few), expected)

    def test_a_burst_is_taken_for_one_position(self) -> None:
        """Positions of a second that all come at once, after it."""
        seen = row_flown(hz=10.0)[120:240]
        bursts = [
            replace(each, at_ns=seconds_to_ns(22.0 + index // 10))
            for index, each in enumerate(seen)
        ]
        assert np.array_equal(imaged(counted(bursts)), imaged(counted(seen[9::10])))

    def test_a_position_waits_for_the_shade_of_its_time(self) -> None:
        progress = with_positions(first_progress(PLAN), "A", row_flown(), PLAN)
        assert count_settled(progress, PLAN, seconds_to_ns(13.5)) is progress
        later = count_settled(progress, PLAN, seconds_to_ns(30.0))
        assert 0 < imaged(later).sum() < imaged(count_settled(later, PLAN, LATE_NS)).sum()

    def test_what_waits_is_bounded(self) -> None:
        many = [PositionSample(seconds_to_ns(i), 1.0 * i, 0.0, 60.0) for i in range(3_000)]
        progress = with_positions(first_progress(PLAN), "A", many, PLAN)
        assert len(progress.waiting["A"]) == PLAN.settings.positions_kept
        for second in range(100):
            progress = with_shade(progress, shade(float(second)), PLAN)
        assert len(progress.shade) == PLAN.settings.shade_maps_kept


class TestLight:
    def test_in_sun_all_the_way_is_in_sun(self) -> None:
        progress = counted(row_flown(), *(shade(t) for t in (12.0, 20.0, 28.0, 36.0, 44.0)))
        assert (progress.state[imaged(progress)] == CellState.IN_SUN).all()
        assert progress.is_sun_known[imaged(progress)].all()

    def test_in_shade_all_the_way_is_in_shade(self) -> None:
        maps = [shade(t, is_lit=False) for t in (12.0, 20.0, 28.0, 36.0, 44.0)]
        progress = counted(row_flown(), *maps)
        assert (progress.state[imaged(progress)] == CellState.IN_SHADE).all()
        assert progress.is_sun_known[imaged(progress)].all()

    @pytest.mark.parametrize(
        ("transmittance", "state"), [(0.52, CellState.IN_SHADE), (0.58, CellState.IN_SUN)]
    )
    def test_what_is_hardly_in_sun_does_not_count(
        self, transmittance: float, state: CellState
    ) -> None:
        """Maps err: it may have been in shade."""
        maps = [shade(t) for t in (12.0, 20.0, 28.0, 36.0, 44.0)]
        maps = [replace(m, transmittance=transmittance * m.transmittance) for m in maps]
        progress = counted(row_flown(), *maps)
        assert imaged(progress).any()
        assert (progress.state[imaged(progress)] == state).all()

    @pytest.mark.parametrize(
        "maps",
        [
            [],
            [shade(60.0)],
            [shade(t, valid=False) for t in (12.0, 20.0, 28.0, 36.0, 44.0)],
            [
                replace(shade(30.0), grid=replace(shade(30.0).grid, frame=other))
                for other in [LocalFrame(GeoPoint(1.0, 2.0, 3.0))]
            ],
        ],
        ids=["no map", "a map of another time", "a map without values", "another site's map"],
    )
    def test_what_nothing_is_known_of_is_not_in_sun(self, maps: list[ShadeMap]) -> None:
        progress = counted(row_flown(), *maps)
        assert imaged(progress).any()
        assert not (progress.state == CellState.IN_SUN).any()
        assert not progress.is_sun_known.any()

    def test_off_the_map_nothing_is_known(self) -> None:
        whole = shade(20.0)
        half = replace(
            whole,
            grid=replace(whole.grid, cols=20),
            **{
                name: getattr(whole, name)[:, :20]
                for name in ("transmittance", "valid", "confidence", "metres_per_pixel")
            },
        )
        plan = replace(PLAN, settings=replace(PLAN.settings, shade_age_s=99.0))
        progress = counted(row_flown(), half, plan=plan)
        is_on_map = PLAN.cells.along_m < 150.0
        assert (progress.state == CellState.IN_SUN).any()
        assert ((progress.state == CellState.IN_SUN) == imaged(progress) & is_on_map).all()
        assert not progress.is_sun_known[~is_on_map].any()

    def test_a_blink_of_sun_shorter_than_the_interval_is_none(self) -> None:
        maps = [shade(10.0 + t, is_lit=t == 20) for t in range(38)]
        plan = replace(PLAN, settings=replace(PLAN.settings, shade_maps_kept=99))
        progress = counted(row_flown(), *maps, plan=plan)
        assert imaged(progress).any()
        assert not (progress.state == CellState.IN_SUN).any()

    def test_three_seconds_of_sun_are_enough_for_a_photo(self) -> None:
        maps = [shade(10.0 + t, is_lit=20 <= t < 24) for t in range(38)]
        plan = replace(PLAN, settings=replace(PLAN.settings, shade_maps_kept=99))
        progress = counted(row_flown(), *maps, plan=plan)
        in_sun = progress.state == CellState.IN_SUN
        east_m = PLAN.cells.along_m[in_sun]
        # The footprint's 52.5 m move on by 16 m at least while it is sunny.
        assert 0.0 < east_m.max() - east_m.min() < 52.5
        assert in_sun.any()

    def test_once_in_sun_stays_so(self) -> None:
        first = counted(row_flown(), *(shade(t) for t in (12.0, 20.0, 28.0, 36.0, 44.0)))
        again = [replace(s, at_ns=s.at_ns + LATE_NS) for s in row_flown()]
        for t in (1012.0, 1020.0, 1028.0, 1036.0, 1044.0):
            first = with_shade(first, shade(t, is_lit=False), PLAN)
        second = count_settled(with_positions(first, "A", again, PLAN), PLAN, 3 * LATE_NS)
        assert np.array_equal(second.state, first.state)


class TestCrossing:
    @settings(max_examples=examples(60), deadline=None)
    @given(
        st.integers(0, 10**6),
        st.floats(0.0, 180.0),
        st.tuples(st.floats(-60.0, 360.0), st.floats(-60.0, 260.0)),
        st.tuples(st.floats(-20.0, 20.0), st.floats(-4.0, 4.0)),
    )
    def test_times_in_view_are_those_of_a_sampled_way(
        self,
        start_ns: int,
        bearing_deg: float,
        place: tuple[float, float],
        move: tuple[float, float],
    ) -> None:
        plan = planned(survey_of(rectangle(), bearing_deg=bearing_deg))
        cells = plan.cells
        one = tuple(plan.lattice.along_across_m([place])[0].tolist())
        path = (one, (one[0] + move[0], one[1] + move[1]))
        end_ns = start_ns + seconds_to_ns(1.0)
        cross = crossing(cells, plan.lattice, plan.swath, path, (start_ns, end_ns))
        first = np.full(cells.is_inside.shape, np.inf)
        last = np.full(cells.is_inside.shape, -np.inf)
        for share in np.linspace(0.0, 1.0, 401):
            along_m = cells.along_m - (path[0][0] + share * move[0])
            across_m = cells.across_m - (path[0][1] + share * move[1])
            seen = np.abs(along_m) <= plan.swath.half_along_m
            seen &= np.abs(across_m) <= plan.swath.half_across_m
            first[seen] = np.minimum(first[seen], share)
            last[seen] = np.maximum(last[seen], share)
        seen = last >= first
        outside = seen.copy()
        outside[cross.window.index] = False
        assert not outside.any()
        assert not (seen[cross.window.index] & ~cross.is_in_view).any()
        window = cross.window.index
        both = seen[window] & cross.is_in_view
        entered_s = (cross.enters_ns - start_ns) / 1e9
        left_s = (cross.leaves_ns - start_ns) / 1e9
        assert np.abs(entered_s - first[window])[both].max(initial=0.0) < 0.003
        assert np.abs(left_s - last[window])[both].max(initial=0.0) < 0.003
        grazed = cross.is_in_view & ~seen[window]
        assert (left_s - entered_s)[grazed].max(initial=0.0) < 0.003


class TestGroundOutOfView:
    """Ground that no shade map shows is not missing once it is imaged."""

    WEST = PLAN.cells.along_m < 150.0

    def missing_after(self, *maps: ShadeMap) -> BoolArray:
        progress = count_settled(
            with_positions(first_progress(PLAN), "A", row_flown(), PLAN), PLAN, LATE_NS
        )
        for each in maps:
            progress = with_shade(progress, each, PLAN)
        return missing_cells(progress, PLAN, CellState.IN_SUN)

    def western(self, at_s: float) -> ShadeMap:
        whole = shade(at_s)
        is_shown = np.arange(whole.grid.cols) < 20
        return replace(whole, valid=whole.valid & is_shown)

    @pytest.mark.parametrize("period_s", [1.0, 5.0])
    def test_it_is_known_as_such_after_208_s(self, period_s: float) -> None:
        until_s = [207.0, 209.0 + period_s]
        kept, released = (
            self.missing_after(*map(self.western, np.arange(0.0, until, period_s)))
            for until in until_s
        )
        assert kept.all()
        assert (released == (self.WEST | ~imaged(counted(row_flown())))).all()

    def test_at_the_edge_of_the_view_a_map_now_and_then_changes_nothing(self) -> None:
        maps = [shade(t) if t % 10 == 0 else self.western(t) for t in range(600)]
        assert not self.missing_after(*maps)[~self.WEST & imaged(counted(row_flown()))].any()

    def test_back_in_view_it_is_missing_again(self) -> None:
        away = [self.western(t) for t in range(600)]
        assert self.missing_after(*away, *(shade(600.0 + t) for t in range(50))).all()

    def test_what_is_not_imaged_is_missing_wherever_it_lies(self) -> None:
        missing = self.missing_after(*(self.western(t) for t in range(600)))
        assert missing[~imaged(counted(row_flown()))].all()

    def test_without_maps_or_light_in_them_nothing_changes(self) -> None:
        learning = [shade(t, valid=False) for t in range(600)]
        assert self.missing_after(*learning).all()
        assert self.missing_after(self.western(0.0), self.western(900.0)).all()


class TestFigures:
    def test_areas_add_up_to_the_region(self) -> None:
        created = create(PLAN)
        assert isinstance(created, SurveyState)
        state = start(created, ["A"], 0)
        assert isinstance(state, SurveyState)
        for t in (12.0, 20.0, 28.0):
            state = observe_shade(state, shade(t))
        state = observe(state, "A", row_flown())
        state = observe(state, "B", [replace(s, north_m=20.0) for s in row_flown()])
        state, _ = step(state, [], LATE_NS)
        found = figures(state)
        assert found.region_m2 == found.reached_m2 == pytest.approx(60_000.0, rel=0.02)
        parts = (found.not_yet_m2, found.sun_unknown_m2, found.in_sun_m2)
        assert min(parts) > 0.0
        assert sum(parts) == pytest.approx(found.region_m2)
        assert found.in_shade_m2 == 0.0
        assert found.time_to_95_imaged_s is None

    def test_unknown_light_is_neither_sun_nor_shade(self) -> None:
        """A row flown in shade, and one while the shade maps had no value."""
        created = create(PLAN)
        assert isinstance(created, SurveyState)
        state = start(created, ["A", "B"], 0)
        assert isinstance(state, SurveyState)
        for t in (12.0, 20.0, 28.0, 36.0, 44.0):
            state = observe_shade(state, shade(t, is_lit=False))
        state = observe(state, "A", row_flown())
        state, _ = step(state, [], LATE_NS)
        in_shade_m2 = figures(state).in_shade_m2
        assert in_shade_m2 > 0.0
        assert figures(state).sun_unknown_m2 == 0.0
        for t in (1012.0, 1020.0, 1028.0, 1036.0, 1044.0):
            state = observe_shade(state, shade(t, valid=False))
        later = [replace(s, at_ns=s.at_ns + LATE_NS, north_m=s.north_m + 60.0) for s in row_flown()]
        state, _ = step(observe(state, "B", later), [], 3 * LATE_NS)
        found = figures(state)
        assert found.in_shade_m2 == in_shade_m2
        assert found.sun_unknown_m2 > 0.0
        parts = (found.not_yet_m2, found.sun_unknown_m2, found.in_shade_m2)
        assert sum(parts) == pytest.approx(found.region_m2)

    def test_before_the_start_nothing_counts(self) -> None:
        created = create(PLAN)
        assert isinstance(created, SurveyState)
        assert observe(created, "A", row_flown()) is created

    def test_the_moment_of_95_percent_is_that_of_the_position(self) -> None:
        progress = first_progress(PLAN)
        rows = [
            float(PLAN.lattice.east_north_m([(0.0, PLAN.lattice.row_across_m(row))])[0, 1])
            for row in range(PLAN.lattice.rows)
        ]
        at_s = []
        for index, north_m in enumerate(rows):
            flown = [
                replace(
                    each,
                    at_ns=each.at_ns + seconds_to_ns(100.0 * index),
                    east_m=each.east_m * 1.02 - 2.0,
                    north_m=north_m,
                )
                for each in row_flown()
            ]
            progress = with_positions(progress, "A", flown, PLAN)
            for a, b in pairwise(range(100 * index, 100 * index + 101, 10)):
                progress = count_settled(progress, PLAN, seconds_to_ns(b + 3.0))
                share = imaged(progress)[PLAN.cells.is_reached].mean()
                at_s += [(a, b, share)]
        after = next(b for _, b, share in at_s if share >= 0.95)
        assert progress.imaged_95_at_ns == seconds_to_ns(after)
        assert progress.in_sun_95_at_ns is None
