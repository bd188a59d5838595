"""Surveys above ground: wanted heights, waypoints that follow them, missions and progress.

Truth is by construction: planes, a ridge, waves no steeper than known, walls and spikes.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.guidance.survey.fields import FRAME, planned, rectangle, region, survey_of
from tests.guidance.survey.grounds import Ground, flat, hills, model, ridge, slope
from tests.guidance.survey.test_sunlit_first import forecast

from recon.guidance.survey import (
    PositionSample,
    Surveyor,
    SurveyPlan,
    SurveyState,
    SurveySurroundings,
    create,
    figures,
    observe,
    plan_survey,
    start,
    step,
)
from recon.guidance.survey.estimate import Batteries, SurveyEstimate, estimate, plan_figures
from recon.guidance.survey.imaging import SpeedLimit
from recon.guidance.survey.missions import Track, flight_time_s
from recon.guidance.survey.plan import HEIGHT_FAULT, survey_fault
from recon.guidance.survey.route import route_of
from recon.guidance.survey.settings import DEFAULT
from recon.model.airspace import ElevationModel, FlightLimits, Region
from recon.model.command import Refusal
from recon.model.geo import GroundGrid
from recon.model.mission import Mission
from recon.model.survey import Survey, SurveyCamera
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleProfile
from recon.vehicles.mission_repair import joined, repair

HEIGHT_M = 40.0


def asked(over: Region | None = None, height_m: float = HEIGHT_M, **changes: object) -> Survey:
    what: dict[str, object] = {"speed_mps": 5.0, "bearing_deg": 90.0, **changes}
    survey = survey_of(over or rectangle(), **what)  # type: ignore[arg-type]
    return replace(survey, height_above_takeoff_m=None, height_above_ground_m=height_m)


def over(
    ground: Ground | ElevationModel, survey: Survey | None = None, **limits: float
) -> SurveyPlan:
    elevation = ground if isinstance(ground, ElevationModel) else model(ground)
    around = SurveySurroundings(elevation=elevation, limits=FlightLimits(**limits))
    plan = plan_survey(survey or asked(), FRAME, around)
    assert isinstance(plan, SurveyPlan), plan
    return plan


def whole(plan: SurveyPlan) -> Track:
    """The track along all rows."""
    track = plan.track(route_of(plan.pieces, plan.lattice, None))
    assert track is not None
    return track


def off_m(plan: SurveyPlan, track: Track, every_m: float = 0.5) -> tuple[float, float]:
    """The most that straight legs are below and above the wanted height, at every half metre."""
    assert plan.terrain is not None
    lowest = highest = 0.0
    legs = zip(pairwise(track.corners_m), pairwise(track.up_m), strict=True)
    for (a, b), (up_a, up_b) in legs:
        count = 2 + int(np.hypot(b[0] - a[0], b[1] - a[1]) / every_m)
        share = np.linspace(0.0, 1.0, count)[:, np.newaxis]
        places_m = np.array(a) * (1.0 - share) + np.array(b) * share
        line_m = up_a * (1.0 - share[:, 0]) + up_b * share[:, 0]
        off = line_m - plan.terrain.up_m(places_m)
        lowest, highest = min(lowest, off.min()), max(highest, off.max())
    return lowest, highest


def missions(plan: SurveyPlan, *surveyors: Surveyor) -> tuple[Mission, ...]:
    """The first missions of a survey that is flown once."""
    created = create(plan)
    assert isinstance(created, SurveyState)
    started = start(created, [each.serial for each in surveyors], 0)
    assert isinstance(started, SurveyState)
    _, given_out = step(started, surveyors, seconds_to_ns(10.0))
    return tuple(each.mission for each in given_out)


class TestWantedHeights:
    @pytest.mark.parametrize("cell_m", [1.0, 5.0, 10.0, 30.0])
    def test_over_a_plane_they_are_the_height_above_it_whatever_the_models_cells(
        self, cell_m: float
    ) -> None:
        plan = over(model(slope, cell_m))
        assert plan.terrain is not None
        places_m = np.array([(10.0, 10.0), (150.0, 77.0), (290.0, 190.0)])
        wanted_m = slope(*places_m.T) + HEIGHT_M
        assert plan.terrain.up_m(places_m) == pytest.approx(wanted_m, abs=0.01)
        assert plan.above_ground_m(0.0) == pytest.approx((HEIGHT_M, HEIGHT_M), abs=0.01)

    def test_beyond_the_rows_they_are_those_of_the_nearest_place(self) -> None:
        terrain = over(slope).terrain
        assert terrain is not None
        assert terrain.up_at_m((-900.0, 100.0)) == terrain.up_at_m((-901.0, 100.0))

    def test_plants_and_single_cells_move_nothing(self) -> None:
        rng = np.random.default_rng(1)

        def grown(east_m: np.ndarray, north_m: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
            heights = rng.uniform(0.0, 1.5, np.broadcast(east_m, north_m).shape)
            heights[580:600:7, 640:720:9] += 9.0
            return heights

        plan = over(model(grown, 1.0))
        rows = len(plan.pieces)
        assert len(whole(plan).corners_m) == 2 * rows

    def test_over_a_row_of_trees_three_quarters_of_the_height_are_kept(self) -> None:
        def trees(east_m: np.ndarray, north_m: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
            return np.where(np.abs(east_m - 152.0) < 1.0, 25.0, 0.0) + 0.0 * north_m

        plan = over(model(trees, 1.0))
        assert plan.terrain is not None
        places_m = np.column_stack([np.arange(140.0, 165.0), np.full(25, 100.0)])
        above_trees_m = plan.terrain.up_m(places_m) - 25.0
        assert above_trees_m[10:15].min() >= 0.75 * HEIGHT_M - 0.01
        assert off_m(plan, whole(plan))[0] >= -DEFAULT.terrain_below_m


class TestWaypoints:
    def test_they_are_the_same_to_and_fro(self) -> None:
        terrain = over(hills(1, 0.5)).terrain
        assert terrain is not None
        path = terrain.between((10.0, 50.0), (290.0, 70.0))
        assert len(path) > 1
        assert terrain.between((290.0, 70.0), (10.0, 50.0)) == path[::-1]

    def test_along_a_plane_none_is_added(self) -> None:
        plan = over(slope)
        assert len(whole(plan).corners_m) == 2 * len(plan.pieces)

    def test_over_a_ridge_one_is_added_to_each_row(self) -> None:
        plan = over(ridge)
        track = whole(plan)
        assert len(track.corners_m) == 3 * len(plan.pieces)
        crest_m = [place[0] for place in track.corners_m[1::3]]
        assert crest_m == pytest.approx([150.0] * len(plan.pieces), abs=20.0)

    @settings(max_examples=25, deadline=None)
    @given(
        seed=st.integers(0, 10_000),
        steepest=st.floats(0.0, 0.5),
        height_m=st.floats(20.0, 100.0),
        bearing_deg=st.floats(0.0, 180.0),
        cell_m=st.sampled_from([2.0, 5.0, 12.0, 30.0]),
    )
    def test_legs_stay_near_the_wanted_height_at_every_place(
        self, seed: int, steepest: float, height_m: float, bearing_deg: float, cell_m: float
    ) -> None:
        survey = asked(rectangle(250.0, 150.0), height_m, speed_mps=1.5, bearing_deg=bearing_deg)
        plan = over(model(hills(seed, steepest), cell_m, 300.0), survey)
        track = whole(plan)
        lowest_m, highest_m = off_m(plan, track)
        assert lowest_m >= -DEFAULT.terrain_below_m
        assert highest_m <= DEFAULT.terrain_above_m
        apart_m = [np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(track.corners_m)]
        assert min(apart_m) >= 1.0

    @settings(max_examples=15, deadline=None)
    @given(seed=st.integers(0, 10_000), depth_m=st.floats(5.0, 40.0))
    def test_at_the_edge_of_a_pit_they_are_higher_and_never_lower(
        self, seed: int, depth_m: float
    ) -> None:
        east_m, north_m = np.random.default_rng(seed).uniform(60.0, 240.0, 2)

        def pit(east: np.ndarray, north: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
            inside = (np.abs(east - east_m) < 40.0) & (np.abs(north - north_m) < 30.0)
            return np.where(inside, -depth_m, 0.0)

        plan = over(model(pit, 2.0, 400.0))
        lowest_m, _ = off_m(plan, whole(plan))
        assert lowest_m >= -DEFAULT.terrain_below_m

    def test_no_leg_climbs_more_than_the_height_limits_leave(self) -> None:
        survey = asked(rectangle(500.0, 100.0), 20.0, speed_mps=2.0)
        track = whole(over(slope, survey, min_height_above_ground_m=5.0))
        climbs_m = [abs(b - a) for a, b in pairwise(track.up_m)]
        assert 0.0 < max(climbs_m) <= 20.0 - 5.0 - DEFAULT.terrain_below_m

    def test_more_than_an_app_accepts_are_flown_in_parts(self) -> None:
        plan = over(hills(3, 0.5), asked(rectangle(500.0, 400.0)))
        (flown,) = missions(plan, Surveyor("S-1", (0.0, -40.0), takeoff_up_m=0.0))
        assert len(flown.waypoints) > 30
        parts = repair(flown, VehicleProfile("S-1", max_waypoints=30)).parts
        assert max(len(part.waypoints) for part in parts) <= 30
        assert joined(parts).waypoints == flown.waypoints


class TestMissions:
    @pytest.mark.parametrize("ground_m", [0.0, 12.34, -7.0])
    def test_over_flat_ground_they_equal_those_above_takeoff(self, ground_m: float) -> None:
        above_ground = over(lambda e, n: flat(e, n) + ground_m)
        above_takeoff = planned(
            replace(asked(), height_above_ground_m=None, height_above_takeoff_m=HEIGHT_M)
        )
        here = [Surveyor(f"S-{i}", (60.0 * i, -40.0), takeoff_up_m=ground_m) for i in range(2)]
        assert missions(above_ground, *here) == missions(above_takeoff, *here)

    def test_each_vehicle_gets_heights_above_its_own_takeoff_point(self) -> None:
        plan = over(slope)
        low, high = (
            missions(plan, Surveyor("S-1", (0.0, -40.0), takeoff_up_m=up_m))[0].waypoints
            for up_m in (0.0, 25.0)
        )
        differ_m = [
            a.height_above_takeoff_m - b.height_above_takeoff_m
            for a, b in zip(low, high, strict=True)
        ]
        assert differ_m == pytest.approx([25.0] * len(low))

    def test_a_vehicle_without_a_takeoff_height_gets_none(self) -> None:
        plan = over(slope)
        known = Surveyor("S-2", (60.0, -40.0), takeoff_up_m=0.0)
        assert missions(plan, Surveyor("S-1", (0.0, -40.0))) == ()
        assert len(missions(plan, Surveyor("S-1", (0.0, -40.0)), known)) == 1


class TestTime:
    def test_stops_at_added_waypoints_take_time(self) -> None:
        here = [Surveyor("S-1", (0.0, -40.0), takeoff_up_m=0.0)]
        level, roof = (estimate(over(ground), here, Batteries(3_000.0)) for ground in (flat, ridge))
        assert isinstance(level, SurveyEstimate)
        assert isinstance(roof, SurveyEstimate)
        rows = len(over(ridge).pieces)
        stop_s = 5.0 / DEFAULT.turning_mps2 + DEFAULT.corner_s
        assert roof.flown_s - level.flown_s == pytest.approx(rows * stop_s, rel=0.3)

    def test_a_leg_too_steep_for_the_speed_takes_as_long_as_its_climb(self) -> None:
        level = Track(((0.0, 0.0), (100.0, 0.0)), (0.0, 0.0))
        steep = replace(level, up_m=(0.0, 100.0))
        slow_s, fast_s = (
            flight_time_s(track, 10.0, (0.0, 0.0), (100.0, 0.0), DEFAULT)
            for track in (steep, level)
        )
        assert slow_s - fast_s == pytest.approx(100.0 / DEFAULT.climb_mps - 10.0)


class TestSunlitFirst:
    @pytest.mark.parametrize(("height_m", "steps_aside"), [(61.0, True), (40.0, False)])
    def test_one_that_waits_among_rows_leaves_the_height_wanted_where_it_is(
        self, height_m: float, steps_aside: bool
    ) -> None:
        """At 200 m east the ground is 20 m higher than its takeoff point."""
        plan = over(slope, asked(planner="sunlit_first"))
        waiting = Surveyor("S-1", (200.0, 100.0), height_above_takeoff_m=height_m, takeoff_up_m=0.0)
        other = Surveyor("S-2", (0.0, -40.0), is_flying=False, takeoff_up_m=0.0)
        created = create(plan)
        assert isinstance(created, SurveyState)
        started = start(created, ["S-1", "S-2"], 0)
        assert isinstance(started, SurveyState)
        sun = forecast(lambda _east, _north, _lead: False)
        _, given_out = step(started, (waiting, other), 0, lambda: sun)
        assert [each.stands_by for each in given_out] == [True] * steps_aside
        if steps_aside:
            (aside,) = given_out[0].mission.waypoints
            assert aside.height_above_takeoff_m == pytest.approx(60.0, abs=0.1)

    def test_stops_within_rows_make_it_expect_rows_to_take_longer(self) -> None:
        level, rough = over(flat), over(hills(3, 0.5))
        assert level.stops_per_m == 0.0
        stops = len(whole(rough).corners_m) - 2 * len(rough.pieces)
        rows_m = sum(np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in rough.rows_m)
        assert rough.stops_per_m == pytest.approx(stops / rows_m, rel=0.1)


class TestProgress:
    def flown(self, plan: SurveyPlan, height_m: float | None, takeoff_up_m: float | None) -> float:
        """What counts, in m², of the middle row at a height above takeoff, or along the ground."""
        created = create(plan)
        assert isinstance(created, SurveyState)
        state = start(created, ["S-1"], 0)
        assert isinstance(state, SurveyState)
        assert plan.terrain is not None
        (a, b) = plan.rows_m[len(plan.rows_m) // 2]
        samples: list[PositionSample] = []
        for second in range(int(abs(b[0] - a[0]) / 5.0)):
            place_m = (min(a[0], b[0]) + 5.0 * second, a[1])
            above_m = plan.terrain.up_at_m(place_m) if height_m is None else height_m
            samples.append(
                PositionSample(seconds_to_ns(second + 1.0), *place_m, above_m, takeoff_up_m)
            )
        state = observe(state, "S-1", samples)
        state, _ = step(state, [], seconds_to_ns(len(samples) + 10.0))
        return figures(state).region_m2 - figures(state).not_yet_m2

    def test_what_follows_the_ground_counts(self) -> None:
        plan = over(slope)
        row_m2 = plan.lattice.spacing_m * 300.0
        assert self.flown(plan, None, 0.0) > 0.8 * row_m2

    def test_what_keeps_its_height_above_takeoff_counts_only_where_that_is_right(self) -> None:
        plan = over(slope)
        all_m2, counted_m2 = self.flown(plan, None, 0.0), self.flown(plan, HEIGHT_M + 15.0, 0.0)
        # Right at 150 m east; 6.5 m lower and 8 m higher still count: 145 m with a footprint, less
        # what is in view for under 2 s at both ends.
        assert counted_m2 == pytest.approx((145.0 + 33.0 - 20.0) / 300.0 * all_m2, rel=0.05)

    def test_without_a_takeoff_height_nothing_counts(self) -> None:
        assert self.flown(over(slope), None, None) == 0.0


def refused(survey: Survey, elevation: ElevationModel | None) -> str:
    found = plan_survey(survey, FRAME, SurveySurroundings(elevation=elevation))
    assert isinstance(found, Refusal), found
    return found.reason


class TestWarnings:
    @pytest.mark.parametrize(
        ("ground", "height_m", "is_warned"),
        [(slope, 115.0, True), (slope, 9.0, True), (slope, 60.0, False), (flat, 115.0, False)],
    )
    def test_a_height_near_the_sites_limits_is_warned_of_over_uneven_ground(
        self, ground: Ground, height_m: float, is_warned: bool
    ) -> None:
        camera = SurveyCamera(across_deg=100.0, along_deg=90.0)
        plan = over(ground, asked(height_m=height_m, speed_mps=1.0, camera=camera))
        found = plan_figures(plan, [], None, SpeedLimit(10.0, "fastest allowed"), 0.001)
        assert [("height limits" in each) for each in found.warnings] == [True] * is_warned


class TestRefusals:
    def test_without_an_elevation_model(self) -> None:
        assert "needs the site's elevation model" in refused(asked(), None)
        no_site = plan_survey(asked(), FRAME)
        assert isinstance(no_site, Refusal)

    def test_beyond_the_model(self) -> None:
        far = region([(500.0, 0.0), (900.0, 0.0), (900.0, 100.0), (500.0, 100.0)])
        reason = refused(asked(far), model(slope, reach_m=600.0))
        assert "has no height for" in reason
        assert "ha" in reason

    def test_a_gap_in_the_model_is_named_with_its_size_and_place(self) -> None:
        gapped = model(slope)
        heights_m = gapped.ellipsoid_height_m.copy()
        grid = gapped.grid
        # 100 x 100 m around 150 m east, 100 m north.
        rows = slice(*(int((grid.north_m - n) / grid.cell_m) for n in (150.0, 50.0)))
        cols = slice(*(int((e - grid.west_m) / grid.cell_m) for e in (100.0, 200.0)))
        heights_m[rows, cols] = np.nan
        reason = refused(asked(), ElevationModel(grid, heights_m))
        area_ha = float(reason.split(" ha ")[0].split()[-1])
        assert area_ha == pytest.approx(1.0, abs=0.3)
        assert "44.9909" in reason
        assert "-93.198" in reason

    @pytest.mark.parametrize(
        "heights", [(None, None), (60.0, 60.0)], ids=["no height", "two heights"]
    )
    def test_not_exactly_one_height(self, heights: Sequence[float | None]) -> None:
        survey = replace(
            asked(), height_above_takeoff_m=heights[0], height_above_ground_m=heights[1]
        )
        assert survey_fault(survey) == HEIGHT_FAULT

    def test_a_photo_distance_that_a_stop_in_a_row_would_leave_a_gap_in(self) -> None:
        """Standing counts for nothing: beside a stop half a footprint must hold a photo."""
        fault = survey_fault(asked(front=0.2, speed_mps=10.0))
        assert fault is not None
        assert "fly at 8.3 m/s at most" in fault

    def test_ground_that_is_known_gives_the_range_above_it_of_a_survey_above_takeoff(self) -> None:
        level = replace(asked(), height_above_ground_m=None, height_above_takeoff_m=HEIGHT_M)
        plan = over(model(slope), level)
        assert plan.above_ground_m(5.0) == pytest.approx((15.0, 45.0), abs=0.6)
        assert planned(level).above_ground_m(5.0) is None

    def test_a_model_whose_grid_touches_nothing_has_no_range(self) -> None:
        far = GroundGrid(FRAME, 5_000.0, 5_000.0, 10.0, 4, 4)
        level = replace(asked(), height_above_ground_m=None, height_above_takeoff_m=HEIGHT_M)
        plan = over(ElevationModel(far, np.zeros((4, 4))), level)
        assert plan.above_ground_m(0.0) is None
