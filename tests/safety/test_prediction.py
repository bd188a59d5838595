"""Trajectories in space and time, against constructions and an independent integrator."""

from dataclasses import replace
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import (
    AIR,
    NOW,
    SETTINGS,
    S,
    aircraft,
    at,
    flies,
    judged,
    route,
    seen,
    waypoint,
)

from recon.model.airspace import Airspace
from recon.model.command import FlyMission, GoTo, HoldPosition, Nudge, StickFrame, VirtualStick
from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.vehicle import Failsafe, TrackPoint, VehicleState
from recon.safety import PreparedAirspace, Traffic
from recon.safety.prediction import (
    FlightPart,
    Plane,
    Predictor,
    hazard_area_of,
    hazard_trajectories,
    part_text,
    predict_order,
    predict_traffic,
)
from recon.safety.prediction import vehicle_motion as placed
from recon.safety.prediction.conflicts import segments_apart_m
from recon.safety.prediction.legs import corner_bulge_m
from recon.safety.prediction.trajectory import ALL_HEIGHTS_M, FOREVER_S, Samples, sample


def where(state: VehicleState, intent: Intent, *times_s: float) -> Samples:
    """Where a vehicle that follows its intent is at these moments, phases and all."""
    predictor = Predictor(seen(state), SETTINGS, exactly=True)
    predictor.follow(intent)
    return sample([predictor.writer.rows], times_s)


class TestLegs:
    def test_a_leg_is_gaining_keeping_and_losing_speed(self) -> None:
        """100 m at 5 m/s and 2.5 m/s2: 2 s for 5 m, 18 s for 90 m, 2 s for 5 m."""
        flown = where(aircraft(), flies(route((0.0, 0.0), (100.0, 0.0)), 1), 1.0, 2.0, 11.0, 22.0)
        assert flown.north_m[0] == pytest.approx([1.25, 5.0, 50.0, 100.0], abs=0.01)
        assert flown.east_m[0] == pytest.approx([0.0] * 4, abs=0.01)

    def test_a_short_one_never_reaches_its_speed(self) -> None:
        """5 m: half of it gained and half lost; 5 m/s would take 10 m."""
        mission = route((0.0, 0.0), (5.0, 0.0))
        flown = where(aircraft(), flies(mission, 1), 2.0**0.5, 2.0 * 2.0**0.5, 100.0)
        assert flown.north_m[0] == pytest.approx([2.5, 5.0, 5.0], abs=0.01)

    def test_speed_already_had_is_kept(self) -> None:
        moving = aircraft(velocity=(5.0, 0.0, 0.0))
        flown = where(moving, flies(route((0.0, 0.0), (100.0, 0.0)), 1), 1.0, 10.0)
        assert flown.north_m[0] == pytest.approx([5.0, 50.0], abs=0.01)

    def test_too_much_speed_is_lost_as_hard_as_it_can_be(self) -> None:
        fast = aircraft(velocity=(15.0, 0.0, 0.0))
        flown = where(fast, flies(route((0.0, 0.0), (10.0, 0.0)), 1), 0.5, 3.0)
        assert flown.north_m[0] == pytest.approx([7.5 - 0.31, 10.0], abs=0.01)
        slower = where(fast, flies(route((0.0, 0.0), (100.0, 0.0)), 1), 2.0, 4.0)
        assert slower.north_m[0] == pytest.approx([25.0, 40.0], abs=0.1)

    def test_a_leg_straight_up_takes_the_climbs_time(self) -> None:
        climb = route((0.0, 0.0, 40.0), (0.0, 0.0, 70.0))
        flown = where(aircraft(), flies(climb, 1), 5.0, 10.0)
        assert flown.low_m[0] == pytest.approx([55.0, 70.0], abs=0.1)
        steep = route((0.0, 0.0, 40.0), (2.0, 0.0, 70.0))
        assert where(aircraft(), flies(steep, 1), 5.0).low_m[0] == pytest.approx([55.0], abs=0.1)

    def test_sinking_takes_its_time_too(self) -> None:
        sink = route((0.0, 0.0, 40.0), (0.0, 0.0, 0.0))
        assert where(aircraft(), flies(sink, 1), 5.0).high_m[0] == pytest.approx([20.0], abs=0.1)

    def test_heights_change_evenly_along_a_leg(self) -> None:
        rising = route((0.0, 0.0, 40.0), (100.0, 0.0, 50.0))
        flown = where(aircraft(), flies(rising, 1), 11.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == pytest.approx((45.0, 45.0), abs=0.1)

    def test_loitering_is_waited_for(self) -> None:
        legs = (waypoint(0.0, 0.0), waypoint(100.0, 0.0, loiter_s=10.0), waypoint(200.0, 0.0))
        flown = where(aircraft(), flies(Mission(legs), 1), 22.0, 31.9, 54.0)
        assert flown.north_m[0] == pytest.approx([100.0, 100.0, 200.0], abs=0.1)

    def test_to_the_first_waypoint_every_height_between_is_possible(self) -> None:
        flown = where(aircraft(), flies(route((50.0, 0.0, 60.0), (99.0, 0.0, 60.0))), 3.0, 30.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (40.0, 60.0)
        assert (flown.low_m[0, 1], flown.high_m[0, 1]) == (60.0, 60.0)

    def test_to_a_first_waypoint_above_it_climbs_before_it_leaves(self) -> None:
        up = flies(route((0.0, 0.0, 70.0), (100.0, 0.0, 70.0)))
        assert where(aircraft(), up, 5.0, 9.9, 15.0).north_m[0] == pytest.approx(
            [0.0, 0.0, 19.0], abs=1.0
        )
        seen_s = where(aircraft(velocity=(0.0, 0.0, 2.0)), up, 5.0, 12.0)
        assert seen_s.north_m[0] == pytest.approx([0.0, 0.0])
        assert seen_s.low_m[0, 0] == seen_s.high_m[0, 0] == pytest.approx(49.2, abs=0.2)
        last = flies(route((0.0, 0.0, 41.0), (100.0, 0.0, 41.0)))
        eases = where(aircraft(velocity=(0.0, 0.0, 1.3)), last, 1.5, 3.5)
        assert eases.north_m[0] == pytest.approx([0.0, 4.6], abs=0.3), "easing takes 1.6 s"
        order = FlyMission(route((30.0, 0.0, 70.0), (99.0, 0.0, 70.0)))
        predicted = predict_order(seen(aircraft()), order, SETTINGS)
        flown_s = float(predicted.rows[0, 1])
        assert flown_s == pytest.approx(10.0)
        # Climbs first, then 30 m: its flight as well; and no faster than 2 m/s.
        assert predicted.delay_s == pytest.approx(8.0 + 0.2 + 10.0 + 5.0)

    def test_a_goto_that_climbs_arrives_when_it_has_climbed(self) -> None:
        goto = GoTo(at(10.0, 0.0), 70.0, 5.0)
        predicted = predict_order(seen(aircraft()), goto, SETTINGS)
        assert float(predicted.rows[0, 1]) == pytest.approx(10.0)
        assert predicted.delay_s == pytest.approx(5.0)

    def test_age_is_made_up_for(self) -> None:
        old = aircraft(velocity=(5.0, 0.0, 0.0), age_s=1.0)
        flown = where(old, flies(route((0.0, 0.0), (100.0, 0.0)), 1), 0.0, 1.0)
        assert flown.north_m[0] == pytest.approx([5.0, 10.0], abs=0.01)

    def test_a_mission_over_hovers_or_lands(self) -> None:
        over = route((0.0, 0.0), (10.0, 0.0))
        hovers = where(aircraft(place=(10.0, 0.0)), flies(over, 2), 500.0)
        assert (hovers.low_m[0, 0], hovers.north_m[0, 0]) == pytest.approx((40.0, 10.0))
        lands = where(aircraft(place=(10.0, 0.0)), flies(replace(over, land_at_end=True), 2), 60.0)
        assert lands.low_m[0, 0] == pytest.approx(40.0 - 240.0)

    def test_no_more_is_written_than_is_asked_for(self) -> None:
        legs = route(*((20.0 * n, 0.0) for n in range(1, 90)))
        short = Predictor(seen(aircraft()), SETTINGS, until_s=10.0)
        short.follow(flies(legs))
        assert 2 <= len(short.writer.rows) <= 3


class TestCurved:
    def test_the_corners_are_flown_without_a_stop(self) -> None:
        legs = route((0.0, 0.0), (100.0, 0.0), (100.0, 100.0), curved=True)
        moving = aircraft(velocity=(5.0, 0.0, 0.0))
        flown = where(moving, flies(legs, 1), 20.0, 30.0)
        assert flown.east_m[0] == pytest.approx([0.0, 50.0], abs=0.1)

    @given(
        back=st.floats(5.0, 200.0),
        on=st.floats(5.0, 200.0),
        angle=st.floats(0.05, pi - 0.05),
        radius=st.floats(0.2, 300.0),
    )
    @settings(max_examples=examples(200), deadline=None)
    def test_no_rounded_corner_leaves_its_legs_by_more_than_the_bulge(
        self, back: float, on: float, angle: float, radius: float
    ) -> None:
        """Both readings of a radius: where the curve leaves the leg, and an arc's radius."""
        before, after = (back, 0.0), (on * cos(angle), on * sin(angle))
        bulge_m = corner_bulge_m(before, (0.0, 0.0), after, radius)
        legs = np.array([[before, (0.0, 0.0)], [(0.0, 0.0), after]])
        arc = min(radius / np.tan(angle / 2.0), back, on)
        for reach in (min(radius, back, on), arc):
            start, end = np.array([reach, 0.0]), reach * np.array([cos(angle), sin(angle)])
            for share in np.linspace(0.0, 1.0, 21):
                point = (1 - share) ** 2 * start + share**2 * end
                off = min(
                    float(segments_apart_m(*(np.array([p]) for p in (point, point, *leg)))[0])
                    for leg in legs
                )
                assert off <= bulge_m + 1e-6

    def test_the_gate_allows_for_the_bulge(self) -> None:
        corner = [
            waypoint(0.0, 0.0),
            waypoint(200.0, 0.0, corner_radius_m=80.0),
            waypoint(200.0, 200.0),
        ]
        inside = aircraft("B", (162.0, 38.0))
        own = aircraft("A", (0.0, 0.0))
        assert judged(Mission(tuple(corner)), own, inside) is None
        assert judged(Mission(tuple(corner), curved=True), own, inside) is not None


class TestOtherIntents:
    def test_holding_brakes_in_a_straight_line(self) -> None:
        """From 10 m/s: 20 m in 4 s."""
        moving = aircraft(velocity=(6.0, 8.0, 1.0))
        flown = where(moving, Intent(Commanded.HOLD), 2.0, 4.0, 60.0)
        far_m = np.hypot(flown.north_m[0], flown.east_m[0])
        assert far_m == pytest.approx([15.0, 20.0, 20.0], abs=0.05)
        assert flown.low_m[0, -1] == pytest.approx(40.25, abs=0.1)

    def test_a_standing_one_stands(self) -> None:
        flown = where(aircraft(), Intent(Commanded.HOLD), 60.0)
        assert (flown.north_m[0, 0], flown.low_m[0, 0]) == pytest.approx((0.0, 40.0))

    def test_landing_sinks(self) -> None:
        flown = where(aircraft(), Intent(Commanded.LAND), 60.0)
        assert flown.low_m[0, 0] < -100.0
        assert flown.high_m[0, 0] == 40.0

    def test_a_stick_without_a_place_goes_on_for_five_seconds(self) -> None:
        flown = where(aircraft(velocity=(4.0, 0.0, 1.0)), Intent(Commanded.STICK), 5.0, 60.0)
        assert flown.north_m[0] == pytest.approx([20.0, 23.2], abs=0.05)

    def test_a_stick_that_climbs_may_be_anywhere_up_to_its_height(self) -> None:
        climbs = Intent(Commanded.STICK, target_height_above_takeoff_m=55.0)
        flown = where(aircraft(), climbs, 1.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (40.0, 55.0)

    def test_a_stick_to_a_place_stops_there(self) -> None:
        goes = Intent(Commanded.STICK, target=at(50.0, 0.0))
        assert where(aircraft(), goes, 60.0).north_m[0] == pytest.approx([50.0], abs=0.01)
        assert where(aircraft(), goes, 60.0).low_m[0, 0] == 40.0
        raised = replace(goes, target_height_above_takeoff_m=70.0, speed_mps=5.0)
        flown = where(aircraft(), raised, 1.0, 60.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0], flown.low_m[0, 1]) == (40.0, 70.0, 70.0)
        here = replace(goes, target=at(0.0, 0.0))
        assert where(aircraft(), here, 60.0).north_m[0] == pytest.approx([0.0], abs=0.01)

    def test_returning_climbs_then_flies_then_sinks(self) -> None:
        far = aircraft(place=(0.0, 200.0))
        climbs = where(far, Intent(Commanded.RETURN), 3.0, 6.6, 15.0, 300.0)
        assert climbs.east_m[0] == pytest.approx([200.0, 200.0, 125.0, 0.0], abs=12.0)
        assert climbs.high_m[0, 2] == 60.0
        assert climbs.low_m[0, 2] == 60.0
        assert climbs.low_m[0, 3] < -100.0

    def test_returning_above_the_go_home_height_stays_there(self) -> None:
        high = where(aircraft(place=(0.0, 200.0), height_m=90.0), Intent(Commanded.RETURN), 10.0)
        assert (high.low_m[0, 0], high.high_m[0, 0]) == (90.0, 90.0)

    def test_returning_at_an_unknown_height_may_be_at_any(self) -> None:
        unknown = aircraft(place=(0.0, 200.0), go_home_m=None)
        flown = where(unknown, Intent(Commanded.RETURN), 180.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (40.0, 540.0)

    def test_one_that_is_under_route_home_is_not_waited_for(self) -> None:
        under_way = aircraft(place=(0.0, 200.0), velocity=(0.0, -10.0, 0.0))
        flown = where(under_way, Intent(Commanded.RETURN), 10.0)
        assert flown.east_m[0] == pytest.approx([100.0], abs=1.0)
        assert (flown.low_m[0, 0], flown.high_m[0, 0]) == (40.0, 60.0)

    def test_returning_to_an_unknown_home_may_go_anywhere(self) -> None:
        flown = where(aircraft(home=None), Intent(Commanded.RETURN), 60.0)
        assert flown.radius_m[0, 0] == 150.0

    def test_without_an_intent_it_stands_or_uses_its_speed_in_any_direction(self) -> None:
        assert where(aircraft(), Intent(), 600.0).radius_m[0, 0] == 0.0
        free = where(aircraft(velocity=(4.0, 0.0, 0.0)), Intent(), 2.5, 600.0)
        assert free.radius_m[0] == pytest.approx([13.6, 27.2])
        rises = where(aircraft(velocity=(0.0, 0.0, 2.0)), Intent(), 600.0)
        assert (rises.low_m[0, 0], rises.high_m[0, 0]) == (40.0, 50.0)

    def test_an_intent_without_a_mission_is_like_none(self) -> None:
        assert where(aircraft(), Intent(Commanded.MISSION), 600.0).radius_m[0, 0] == 0.0


class TestOrders:
    def end(self, body: object, state: VehicleState | None = None) -> tuple[float, ...]:
        """East, north, low and high at an order's end, and its last row's radius."""
        trajectory = predict_order(seen(state or aircraft()), body, SETTINGS)  # type: ignore[arg-type]
        last = trajectory.rows[-1]
        return tuple(last[[4, 5, 8, 9, 11]])

    def test_a_mission_begins_with_stopping(self) -> None:
        moving = aircraft(velocity=(5.0, 0.0, 0.0))
        trajectory = predict_order(
            seen(moving), FlyMission(route((0.0, 0.0), (50.0, 0.0))), SETTINGS
        )
        assert trajectory.rows[0, 13] == FlightPart.STOPPING
        assert trajectory.rows[1, 5] == pytest.approx(10.0)

    def test_steered_orders_end_where_they_lead(self) -> None:
        assert self.end(GoTo(at(0.0, 80.0), 50.0, 5.0))[:4] == pytest.approx(
            (80, 0, 50, 50), abs=0.1
        )
        assert self.end(Nudge(3.0, 4.0, 5.0)) == pytest.approx((4, 3, 45, 45, 0), abs=0.1)
        assert self.end(HoldPosition()) == pytest.approx((0, 0, 40, 40, 0), abs=0.1)

    def test_a_nudge_at_an_unknown_height_keeps_it(self) -> None:
        assert self.end(Nudge(3.0, 4.0, 5.0), aircraft(height_m=None))[2] == -ALL_HEIGHTS_M

    def test_a_nudge_from_nowhere_goes_nowhere(self) -> None:
        lost = replace(aircraft(place=None), track=(_track_point(),))
        assert self.end(Nudge(3.0, 4.0, 5.0), lost)[:2] == pytest.approx((0, 0), abs=0.1)

    def test_a_stick_lasts_its_time_the_reaction_and_the_braking(self) -> None:
        stick = VirtualStick(StickFrame.GROUND, 0.0, 5.0, 0.0, 40.0, 1.0)
        standing = self.end(stick)
        assert standing[1] == pytest.approx(5.0 + 5.0 + 5.0 + 5.0, abs=0.1)
        assert self.end(stick, aircraft(velocity=(5.0, 0.0, 0.0)))[1] == pytest.approx(
            15.0, abs=0.1
        )

    def test_a_body_stick_goes_where_the_vehicle_points(self) -> None:
        forward = VirtualStick(StickFrame.BODY, 90.0, 5.0, 0.0, 40.0, 1.0)
        east, north, *_ = self.end(forward, aircraft(yaw_deg=90.0))
        assert (east, north) == pytest.approx((20.0, 0.0), abs=0.1)
        right = VirtualStick(StickFrame.BODY, 90.0, 0.0, 5.0, 40.0, 1.0)
        east, north, *_ = self.end(right, aircraft(yaw_deg=90.0))
        assert (east, north) == pytest.approx((0.0, -20.0), abs=0.1)

    @pytest.mark.parametrize("yaw_deg", [None, 0.0, -100.0])
    def test_one_that_turns_or_has_no_known_yaw_sweeps(self, yaw_deg: float | None) -> None:
        forward = VirtualStick(StickFrame.BODY, 90.0, 5.0, 0.0, 40.0, 1.0)
        assert self.end(forward, aircraft(yaw_deg=yaw_deg))[4] == pytest.approx(15.0)

    def test_a_stick_may_be_at_every_height_between(self) -> None:
        up = VirtualStick(StickFrame.GROUND, 0.0, 5.0, 0.0, 60.0, 1.0)
        assert self.end(up)[2:4] == (40.0, 60.0)


class TestFlyers:
    def test_without_a_position_it_is_where_it_was_last_seen(self) -> None:
        lost = replace(aircraft(place=None), track=(_track_point(),))
        found = seen(lost)
        assert found.age_s == pytest.approx(2.0)
        assert (found.east_m, found.north_m) == pytest.approx((0.0, 0.0), abs=0.01)
        assert placed(aircraft(place=None), AIR, Plane(at(0, 0)), NOW, SETTINGS) is None

    def test_an_unknown_velocity_may_be_any_and_an_implausible_one_is_cut(self) -> None:
        assert seen(aircraft(velocity=None)).speed_mps == 15.0
        fast = seen(aircraft(velocity=(30.0, 40.0, 0.0)))
        assert fast.speed_mps == 23.0
        assert fast.velocity_mps[:2] == pytest.approx((18.4, 13.8))

    def test_a_missing_profile_may_go_home_at_any_height(self) -> None:
        bare = seen(replace(aircraft(), profile=None))
        assert (bare.go_home_up_m, bare.goes_home) == (None, True)

    def test_heights_count_from_the_takeoff_point(self) -> None:
        homeless = seen(aircraft(home=None))
        assert (homeless.low_m, homeless.high_m) == (-ALL_HEIGHTS_M, ALL_HEIGHTS_M)
        assert homeless.up_m(5.0) == (-ALL_HEIGHTS_M, ALL_HEIGHTS_M)
        assert homeless.go_home_up_m is None
        assert seen(aircraft()).up_m(5.0) == (5.0, 5.0)
        on_ground = seen(aircraft(home=None, height_m=0.0, flying=False))
        assert on_ground.low_m == 0.0

    def test_many_vehicles_and_airspaces_have_their_own_takeoff_heights(self) -> None:
        heights = {seen(aircraft(f"V{n}")).takeoff_up_m for n in range(600)}
        assert heights == {0.0}
        other = PreparedAirspace(Airspace())
        moved = replace(aircraft("V599"), takeoff_point=at(9.0, 9.0))
        found = placed(moved, other, Plane(at(0, 0)), NOW, SETTINGS)
        assert found is not None
        assert found.takeoff_up_m == 0.0


class TestHazards:
    def test_it_grows_with_its_commanded_speed(self) -> None:
        mission = Mission((waypoint(0.0, 0.0, speed_mps=3.0), waypoint(90.0, 0.0, speed_mps=12.0)))
        still = aircraft(age_s=5.0)
        for intent, expected in (
            (Intent(), 2.0),
            (flies(mission), 12.0),
            (Intent(Commanded.STICK, speed_mps=7.0), 7.0),
            (Intent(Commanded.STICK), 2.0),
        ):
            found = hazard_area_of(seen(still), intent, SETTINGS)
            assert found is not None
            assert found.growth_mps == expected
            assert found.radius_m == pytest.approx(5.0 * expected)

    def test_a_fast_one_may_be_farther_than_150_m(self) -> None:
        quick = replace(SETTINGS, hazard_radius_m=50.0)
        fast = hazard_area_of(
            seen(aircraft(velocity=(15.0, 0.0, 0.0), age_s=60.0)), Intent(), quick
        )
        assert fast is not None
        assert fast.largest_m == fast.radius_m == pytest.approx(60.0)

    def test_it_reaches_as_high_as_it_may_climb(self) -> None:
        for state, top_m in (
            (aircraft(age_s=5.0), 60.0),
            (aircraft(age_s=5.0, height_m=80.0), 80.0),
            (aircraft(age_s=5.0, failsafe=Failsafe.HOVER), 40.0),
            (aircraft(age_s=5.0, failsafe=Failsafe.HOVER, velocity=(0.0, 0.0, 2.0)), 50.0),
            (aircraft(age_s=60.0, failsafe=Failsafe.HOVER, velocity=(0.0, 0.0, 2.0)), 60.0),
            (aircraft(age_s=5.0, go_home_m=None), 540.0),
        ):
            found = hazard_area_of(seen(state), Intent(), SETTINGS)
            assert found is not None
            assert found.high_m == pytest.approx(top_m)

    def test_its_courses_are_the_circle_the_way_and_the_landing(self) -> None:
        young = hazard_area_of(seen(aircraft(place=(0.0, 300.0), age_s=5.0)), Intent(), SETTINGS)
        old = hazard_area_of(seen(aircraft(home=None, age_s=500.0)), Intent(), SETTINGS)
        assert young is not None
        assert old is not None
        assert [len(trajectory.rows) for trajectory in hazard_trajectories(young)] == [2, 1, 1]
        assert [len(trajectory.rows) for trajectory in hazard_trajectories(old)] == [1]

    def test_one_with_a_mission_is_predicted_to_continue_it(self) -> None:
        stale = seen(aircraft(age_s=5.0))
        assert len(predict_traffic(stale, Intent(), SETTINGS, FOREVER_S)) == 3
        assert (
            len(predict_traffic(stale, flies(route((0.0, 0.0), (9.0, 0.0))), SETTINGS, 60.0)) == 4
        )


def test_every_part_of_a_flight_has_words() -> None:
    words = {part_text(part) for part in (*FlightPart, 0, 1, 2)}
    assert len(words) == len(FlightPart) + 3
    assert part_text(3) == "between waypoints 3 and 4"


class TestAgainstAnIntegrator:
    """What the gate lets pass stays apart, flown by another's arithmetic at another's speed."""

    @given(data=st.data())
    @settings(max_examples=examples(60), deadline=None)
    def test_missions_the_gate_passes_stay_apart(self, data: st.DataObject) -> None:
        coordinate = st.floats(-150.0, 150.0)
        heights = st.sampled_from([4.0, 36.0, 40.0, 44.0, 48.0, 80.0])
        places = st.tuples(coordinate, coordinate, heights)
        paths = [data.draw(st.lists(places, min_size=3, max_size=5)) for _ in range(2)]
        rates = [data.draw(st.floats(0.93, 1.07)) for _ in range(2)]
        delays = [data.draw(st.floats(0.0, 7.0)), 0.0]
        climb_first = [data.draw(st.booleans()) for _ in range(2)]
        own, other = (
            aircraft(name, path[0][:2], path[0][2]) for name, path in zip("AB", paths, strict=True)
        )
        traffic = Traffic(other, flies(route(*paths[1][1:]), 0))
        refusal = judged(route(*paths[0][1:]), own, traffic)
        nearest = _least_closeness(paths, rates, delays, climb_first)
        if refusal is None:
            assert nearest >= 0.98

    def test_a_climb_to_the_first_waypoint_takes_its_time(self) -> None:
        """A climbs to 80 m where it stands, for half a minute; B crosses over it at 57 m."""
        own, other = aircraft("A", (0.0, 0.0), 1.0), aircraft("B", (0.0, 140.0), 57.0)
        climbs = route((0.0, 0.5, 80.0), (-200.0, 0.0, 90.0))
        over = Traffic(other, flies(route((0.0, 0.0, 57.0), (0.0, -200.0, 57.0)), 0))
        assert judged(climbs, own, over) is not None
        beside = Traffic(other, flies(route((60.0, 140.0, 57.0), (60.0, -200.0, 57.0)), 0))
        assert judged(climbs, own, beside) is None

    def test_it_refuses_what_meets_and_passes_what_does_not(self) -> None:
        """The property above is not empty: both answers come."""
        own, other = aircraft("A", (0.0, 0.0)), aircraft("B", (0.0, 100.0))
        meets = Traffic(other, flies(route((0.0, 50.0), (0.0, -50.0)), 0))
        leaves = Traffic(other, flies(route((0.0, 120.0), (0.0, 300.0)), 0))
        path = route((0.0, 10.0), (0.0, 60.0))
        assert judged(path, own, meets) is not None
        assert judged(path, own, leaves) is None


def _least_closeness(
    paths: list[list[tuple[float, float, float]]],
    rates: list[float],
    delays: list[float],
    climb_first: list[bool],
) -> float:
    """Two flown at 10 Hz, stopping at each waypoint, each at its own rate and after its delay."""
    each = zip(paths, rates, delays, climb_first, strict=True)
    tracks = [_flown(*one) for one in each]
    longest = max(len(track) for track in tracks)
    one, other = (
        np.vstack([track, np.repeat(track[-1:], longest - len(track), axis=0)]) for track in tracks
    )
    level = np.hypot(*(one - other)[:, :2].T) / 15.0
    upright = np.abs((one - other)[:, 2]) / 6.0
    start = max(level[0], upright[0])
    # Who begins too near may be led apart; that is another rule's matter.
    return float("inf") if start < 1.0 else float(np.maximum(level, upright).min())


def _flown(
    path: list[tuple[float, float, float]], rate: float, delay_s: float, climbs_first: bool
) -> np.ndarray:
    """Positions each tenth of a second: 5 m/s, 2.5 m/s2, up and down at 2.5 or 3 m/s."""
    track = [path[0]] * max(1, round(delay_s * 10))
    if climbs_first:
        rises = round(10.0 * abs(path[1][2] - path[0][2]) / 2.5)
        track += [(*path[0][:2], z) for z in np.linspace(path[0][2], path[1][2], rises + 1)]
        path = [track[-1], *path[1:]]
    for start, end in pairwise(path):
        long_m = hypot(end[0] - start[0], end[1] - start[1])
        gone, speed = 0.0, 0.0
        climb_s = abs(end[2] - start[2]) / 3.0
        seconds = 0.0
        while gone < long_m - 0.05 or seconds < climb_s:
            room = max(0.0, long_m - gone)
            speed = min(speed + 0.25 * rate, 5.0 * rate, (2.0 * 2.5 * room) ** 0.5 + 0.02)
            gone = min(long_m, gone + 0.1 * speed)
            seconds += 0.1
            share = 1.0 if long_m == 0.0 else gone / long_m
            risen = min(1.0, seconds / climb_s) if climb_s > 0.0 else 1.0
            height = start[2] + max(min(share, 1.0), 0.0) * (end[2] - start[2])
            height = height if long_m > 15.0 else start[2] + risen * (end[2] - start[2])
            track.append(
                (
                    start[0] + share * (end[0] - start[0]),
                    start[1] + share * (end[1] - start[1]),
                    height,
                )
            )
    return np.array(track)


def _track_point() -> TrackPoint:
    place = at(0.0, 0.0)
    return TrackPoint(NOW - 2 * S, place.latitude_deg, place.longitude_deg, 40.0)


def test_times_end_somewhere() -> None:
    assert sample([[(0.0, FOREVER_S, *[0.0] * 11, -1)]], [1e7]).north_m[0, 0] == 0.0
