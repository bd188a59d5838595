"""Steering closes its loop over delay, jitter, wind and noise: it arrives without overshoot."""

from dataclasses import replace
from itertools import pairwise
from math import hypot, inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.closed_loop import SETTINGS, START, Loop, Way

from recon.geo.distance import horizontal_distance_m, moved_m, offset_north_east_m
from recon.guidance.steering import (
    Goal,
    KinematicState,
    approach_speed_mps,
    begin,
    halted,
    has_arrived,
    steer,
    stopping_place,
)
from recon.model.geo import LatLon
from recon.model.units import wrap_degrees
from recon.sim.flight.kinematics import AircraftMotion

S = 1_000_000_000
STILL_AIR_OVERSHOOT_M = 0.5
PUSHED_OVERSHOOT_S = 2.0
"""Times the wind's push, when it could not be learnt on the way (a short hop)."""


def goal(
    north_m: float, east_m: float, up_m: float = 0.0, speed_mps: float = 5.0, yaw_deg: float = 0.0
) -> Goal:
    return Goal(moved_m(START, north_m, east_m), 30.0 + up_m, speed_mps, yaw_deg)


def seen(
    north_m: float = 0.0, velocity_north_mps: float = 0.0, age_s: float = 0.1
) -> KinematicState:
    return KinematicState(moved_m(START, north_m, 0.0), velocity_north_mps, 0.0, 30.0, 0.0, age_s)


paths = st.builds(
    Way,
    telemetry_s=st.floats(0.05, 0.3),
    jitter_s=st.floats(0.0, 0.25),
    stick_s=st.floats(0.05, 0.25),
    seed=st.integers(0, 10_000),
)
bearings = st.tuples(st.floats(-150.0, 150.0), st.floats(-150.0, 150.0)).filter(
    lambda to: hypot(*to) > 1.0
)


class TestClosedLoop:
    @settings(max_examples=examples(40), deadline=None)
    @given(paths, bearings, st.floats(-15.0, 30.0), st.floats(1.0, 15.0))
    def test_it_arrives_and_does_not_overshoot_in_still_air(
        self, path: Way, to_m: tuple[float, float], up_m: float, speed_mps: float
    ) -> None:
        loop, to = Loop(path), goal(*to_m, up_m, speed_mps)
        loop.fly(to, 25.0 + hypot(*to_m) / speed_mps + abs(up_m))
        assert loop.distance_m(to) < 0.2
        assert loop.has_arrived(to)
        assert loop.overshoot_m(to) <= STILL_AIR_OVERSHOOT_M

    @settings(max_examples=examples(40), deadline=None)
    @given(paths, bearings, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.0, 0.15))
    def test_it_arrives_within_a_metre_in_wind(
        self, path: Way, to_m: tuple[float, float], north: float, east: float, noise: float
    ) -> None:
        windy = replace(
            path, wind_north_mps=north, wind_east_mps=east, gust_mps=0.15, noise_m=noise
        )
        loop, to = Loop(windy), goal(*to_m, speed_mps=8.0)
        loop.fly(to, 45.0 + hypot(*to_m) / 6.0)
        assert loop.distance_m(to) < 1.0
        bound_m = STILL_AIR_OVERSHOOT_M + PUSHED_OVERSHOOT_S * (hypot(north, east) + 0.3)
        assert loop.overshoot_m(to) <= bound_m

    def test_a_push_learnt_on_the_way_costs_no_overshoot(self) -> None:
        loop, to = Loop(Way(wind_north_mps=1.0)), goal(200.0, 0.0, speed_mps=8.0)
        loop.fly(to, 60.0)
        assert loop.overshoot_m(to) <= STILL_AIR_OVERSHOOT_M
        assert loop.distance_m(to) < 0.2

    @settings(max_examples=examples(30), deadline=None)
    @given(paths, bearings, st.floats(2.0, 15.0), st.floats(-8.0, 8.0))
    def test_what_is_asked_for_stays_within_its_bounds(
        self, path: Way, to_m: tuple[float, float], speed_mps: float, moving_mps: float
    ) -> None:
        loop = Loop(path, AircraftMotion(height_m=30.0, velocity_east_mps=moving_mps))
        loop.fly(goal(*to_m, 20.0, speed_mps, 170.0), 40.0)
        assert loop.hardest_demand_mps2() <= 2.0 + 1e-6
        fastest_mps = max(hypot(d.velocity_north_mps, d.velocity_east_mps) for d in loop.demands)
        assert fastest_mps <= max(speed_mps, abs(moving_mps)) + 1e-9
        for a, b in pairwise(loop.demands):
            climb_m = b.height_above_takeoff_m - a.height_above_takeoff_m
            assert -0.15 - 1e-9 <= climb_m <= 0.2 + 1e-9
            assert abs(wrap_degrees(b.yaw_deg - a.yaw_deg)) <= 4.5 + 1e-9

    def test_a_hold_out_of_full_motion_stays_near_where_it_comes_to_rest(self) -> None:
        loop = Loop(Way(jitter_s=0.2), AircraftMotion(height_m=30.0, velocity_north_mps=10.0))
        loop.fly(goal(100.0, 0.0, speed_mps=10.0), 1.0)
        last = loop.seen()
        assert last is not None
        place = stopping_place(last, SETTINGS)
        loop.fly(Goal(place, 30.0, 5.0, 0.0), 20.0)
        north_m, _ = offset_north_east_m(START, place)
        assert abs(loop.motion.north_m - north_m) < 0.3
        assert max(m.north_m for m in loop.trace) < north_m + 1.5

    def test_two_seconds_of_zero_in_between_and_it_arrives_all_the_same(self) -> None:
        loop, to = Loop(Way(jitter_s=0.2)), goal(80.0, 0.0, speed_mps=6.0)
        loop.fly(to, 6.0)
        loop.fly(to, 2.5, is_blind=True)
        assert loop.motion.ground_speed_mps < 1.0
        loop.fly(to, 30.0)
        assert loop.distance_m(to) < 0.2
        assert loop.overshoot_m(to) <= STILL_AIR_OVERSHOOT_M

    def test_an_aircraft_that_climbs_slower_is_not_left_behind(self) -> None:
        before, to = begin(seen(), 0), goal(0.0, 0.0, 50.0)
        for number in range(1, 200):
            before = steer(before, to, seen(), number * S // 10, SETTINGS)
        assert before.height_above_takeoff_m == 33.0

    def test_against_an_aircraft_that_does_not_obey_the_demand_stays_bounded(self) -> None:
        before, to = begin(seen(), 0), goal(50.0, 0.0, speed_mps=4.0)
        for number in range(1, 600):
            before = steer(before, to, seen(velocity_north_mps=-3.0), number * S // 10, SETTINGS)
        assert hypot(before.velocity_north_mps, before.velocity_east_mps) <= 4.0 + 1e-9
        assert hypot(before.push_north_mps, before.push_east_mps) <= SETTINGS.longest_push_mps
        assert len(before.recent) <= 14


class TestParts:
    def test_it_goes_on_from_the_present_motion(self) -> None:
        moving = KinematicState(START, 3.0, -1.0, 25.0, 80.0, 0.2)
        first = begin(moving, S)
        assert (first.velocity_north_mps, first.velocity_east_mps) == (3.0, -1.0)
        assert (first.height_above_takeoff_m, first.yaw_deg) == (25.0, 80.0)

    def test_a_halt_is_zero_at_once_and_keeps_height_and_heading(self) -> None:
        stopped = halted(begin(KinematicState(START, 3.0, -1.0, 25.0, 80.0, 0.2), S), None, 2 * S)
        assert (stopped.velocity_north_mps, stopped.velocity_east_mps) == (0.0, 0.0)
        assert (stopped.height_above_takeoff_m, stopped.yaw_deg, stopped.at_ns) == (
            25.0,
            80.0,
            2 * S,
        )

    def test_a_halt_in_a_climb_demands_the_height_last_reported(self) -> None:
        climbing = begin(KinematicState(START, 0.0, 0.0, 25.0, 80.0, 0.2), S)
        assert halted(climbing, 23.5, 2 * S).height_above_takeoff_m == 23.5

    def test_a_late_step_changes_no_more_than_a_bounded_time_allows(self) -> None:
        late = steer(begin(seen(), 0), goal(100.0, 0.0), seen(), 60 * S, SETTINGS)
        assert late.velocity_north_mps == pytest.approx(2.0 * 0.3)

    def test_the_way_round_the_compass_is_the_short_one(self) -> None:
        to = goal(0.0, 0.0, yaw_deg=-170.0)
        turned = steer(replace(begin(seen(), 0), yaw_deg=170.0), to, seen(), S // 10, SETTINGS)
        assert turned.yaw_deg == pytest.approx(174.5)

    @pytest.mark.parametrize(
        ("changes", "is_there"),
        [
            ({}, True),
            ({"position": moved_m(START, 0.9, 0.0)}, True),
            ({"position": moved_m(START, 1.1, 0.0)}, False),
            ({"height_above_takeoff_m": 31.1}, False),
            ({"height_above_takeoff_m": 29.1}, True),
            ({"yaw_deg": 11.0}, False),
            ({"yaw_deg": -9.0}, True),
            ({"velocity_east_mps": 0.5}, False),
        ],
    )
    def test_arrived_is_there_at_rest_and_turned(
        self, changes: dict[str, object], is_there: bool
    ) -> None:
        there = replace(seen(), **changes)  # type: ignore[arg-type]
        assert has_arrived(goal(0.0, 0.0), there, SETTINGS) is is_there

    @given(st.floats(0.0, 500.0), st.floats(0.01, 10.0))
    def test_the_approach_never_asks_for_more_than_can_be_braked(
        self, distance_m: float, further_m: float
    ) -> None:
        speed_mps = approach_speed_mps(distance_m, SETTINGS)
        assert 0.5 * speed_mps**2 / SETTINGS.braking_mps2 <= distance_m + 1e-9
        farther_mps = approach_speed_mps(distance_m + further_m, SETTINGS)
        assert speed_mps < farther_mps <= speed_mps + 0.5 * further_m + 1e-9

    def test_standing_the_stopping_place_is_here(self) -> None:
        assert stopping_place(seen(), SETTINGS) == LatLon(START.latitude_deg, START.longitude_deg)

    def test_the_stopping_place_is_a_braking_distance_ahead(self) -> None:
        place = stopping_place(seen(velocity_north_mps=6.0, age_s=0.2), SETTINGS)
        north_m, east_m = offset_north_east_m(START, place)
        assert north_m == pytest.approx(6.0 * 0.5 + 12.0)
        assert east_m == pytest.approx(0.0)

    def test_prediction_from_old_telemetry_is_bounded(self) -> None:
        near = stopping_place(seen(velocity_north_mps=3.0, age_s=1.0), SETTINGS)
        assert stopping_place(seen(velocity_north_mps=3.0, age_s=inf), SETTINGS) == near

    @given(
        st.floats(-70.0, 70.0),
        st.floats(-180.0, 179.9),
        st.floats(-5_000.0, 5_000.0),
        st.floats(-5_000.0, 5_000.0),
    )
    def test_moving_and_the_offset_undo_each_other(
        self, latitude_deg: float, longitude_deg: float, north_m: float, east_m: float
    ) -> None:
        origin = LatLon(latitude_deg, longitude_deg)
        there = moved_m(origin, north_m, east_m)
        assert there.is_valid()
        assert offset_north_east_m(origin, there) == pytest.approx((north_m, east_m), abs=1e-6)
        distance_m = horizontal_distance_m(origin, there)
        assert distance_m == pytest.approx(hypot(north_m, east_m), abs=1e-6)
