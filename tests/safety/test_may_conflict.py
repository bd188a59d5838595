"""What is sorted out before trajectories are compared piece by piece never meets."""

import sys
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import (
    AIR,
    NOW,
    PLANE,
    SETTINGS,
    aircraft,
    at,
    flies,
    judged,
    route,
    seen,
)
from tests.safety.trajectories import NEED, heights_m, places_m, standing, trajectories

from recon.model.command import FlyMission, GoTo, StickFrame, VirtualStick
from recon.model.control import Commanded, Intent
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import Traffic
from recon.safety.prediction import VehicleMotion, vehicle_motion
from recon.safety.prediction.conflicts import first_conflict
from recon.safety.prediction.predicted_trajectories import (
    TrajectoryBounds,
    is_too_far,
    may_conflict,
    may_enter,
    predict_order,
    predict_traffic,
    trajectory_bounds,
)
from recon.safety.prediction.trajectory import FOREVER_S, Trajectory
from recon.safety.rules.separation import separation


@settings(max_examples=examples(300))
@given(trajectories(), trajectories())
def test_what_meets_is_never_sorted_out(own: Trajectory, other: Trajectory) -> None:
    if first_conflict(own, [other], NEED, SETTINGS) is not None:
        assert may_conflict(other, trajectory_bounds(own, NEED, SETTINGS))


@pytest.mark.parametrize(
    ("east_m", "north_m", "up_m"),
    [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
)
def test_what_is_elsewhere_or_at_other_heights_is_sorted_out(
    east_m: float, north_m: float, up_m: float
) -> None:
    """15 m away, or 8 m above or below; what rounding may hide is in doubt."""
    around = trajectory_bounds(standing(0.0, 40.0), NEED, SETTINGS)

    def may_conflict_beyond(minima_m: float) -> bool:
        place = (15.0 + minima_m) * east_m, (15.0 + minima_m) * north_m
        up = 40.0 + (8.0 + minima_m) * up_m
        return may_conflict(standing(place[0], up, place[1]), around)

    assert may_conflict_beyond(-0.01)
    assert may_conflict_beyond(1e-7)
    assert not may_conflict_beyond(0.01)


def test_what_is_nowhere_is_in_doubt() -> None:
    around = trajectory_bounds(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_conflict(standing(float("nan"), 40.0), around)
    assert may_conflict(standing(0.0, float("nan")), around)


far_places_m = st.tuples(st.floats(-600.0, 600.0), st.floats(-600.0, 600.0))


@st.composite
def others(draw: st.DrawFn) -> tuple[VehicleState, Intent]:
    """Another vehicle with whatever it was commanded, also lost or without velocity or home."""
    place = draw(far_places_m)
    velocity = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(-4.0, 4.0))
    state = aircraft(
        "B",
        place,
        draw(st.none() | heights_m),
        draw(st.none() | velocity),
        home=draw(st.none() | far_places_m),
        age_s=draw(st.sampled_from([0.0, 0.2, 2.0, 5.0, 60.0])),
    )
    intent = draw(st.sampled_from([Intent(commanded, NOW) for commanded in Commanded]))
    if intent.commanded is Commanded.MISSION:
        return state, flies(route(draw(far_places_m), draw(far_places_m)))
    return state, intent


@settings(max_examples=examples(300))
@given(others(), places_m, places_m, st.floats(1.0, 200.0), st.floats(0.0, 60.0))
def test_what_is_too_far_away_never_enters(
    other: tuple[VehicleState, Intent],
    east_m: float,
    north_m: float,
    radius_m: float,
    until_s: float,
) -> None:
    state, intent = other
    around = TrajectoryBounds(east_m, north_m, radius_m, -1.0e6, 1.0e6, until_s)
    if is_too_far(state, intent, PLANE, around, NOW, SETTINGS):
        motion = vehicle_motion(state, AIR, PLANE, NOW, SETTINGS)
        assert motion is not None
        assert not may_enter(motion, intent, around, SETTINGS)


def test_far_traffic_is_sorted_out_before_its_motion() -> None:
    around = TrajectoryBounds(0.0, 0.0, 20.0, 0.0, 100.0, 5.0)
    hold, back = Intent(Commanded.HOLD), Intent(Commanded.RETURN)
    far = aircraft("B", (0.0, 600.0))
    assert is_too_far(far, hold, PLANE, around, NOW, SETTINGS)
    assert not is_too_far(aircraft("B", (0.0, 10.0)), hold, PLANE, around, NOW, SETTINGS)
    assert not is_too_far(far, back, PLANE, around, NOW, SETTINGS)
    assert not is_too_far(aircraft("B", None), hold, PLANE, around, NOW, SETTINGS)
    lost = aircraft("B", (0.0, 600.0), age_s=60.0)
    assert not is_too_far(lost, hold, PLANE, around, NOW, SETTINGS)


PLACE = (40.0, -30.0)
HOLD, STICK, BACK = (Intent(it) for it in (Commanded.HOLD, Commanded.STICK, Commanded.RETURN))
AWAY = flies(route((90.0, 0.0), (99.0, 0.0)))
EVERYWHERE_M = 1.0e6


def beyond(motion: VehicleMotion, far_m: float, until_s: float = 5.0) -> TrajectoryBounds:
    """A circle of 20 m whose edge is so far from a vehicle, to its north-east."""
    east_m, north_m = motion.east_m + 0.6 * (20.0 + far_m), motion.north_m + 0.8 * (20.0 + far_m)
    return TrajectoryBounds(east_m, north_m, 20.0, -EVERYWHERE_M, EVERYWHERE_M, until_s)


class TestReach:
    @pytest.mark.parametrize(
        ("speed_mps", "age_s", "intent", "until_s", "reach_m"),
        [
            (0.0, 0.0, HOLD, 5.0, 0.0),
            (0.0, 3.0, HOLD, 5.0, 0.0),
            (10.0, 0.0, HOLD, 5.0, 50.0 + 30.0),
            (10.0, 0.0, HOLD, 1.0, 50.0 + 30.0),
            (10.0, 0.0, HOLD, 20.0, 200.0 + 30.0),
            (10.0, 2.0, HOLD, 5.0, 70.0 + 30.0),
            (0.0, 0.0, STICK, 5.0, 75.0 + 60.0),
            (0.0, 0.0, AWAY, 5.0, 75.0 + 60.0),
        ],
    )
    def test_it_is_a_vehicles_flight_and_its_stop(
        self, speed_mps: float, age_s: float, intent: Intent, until_s: float, reach_m: float
    ) -> None:
        """At 10 m/s it stops in 30 m, at the 15 m/s of a command in 60 m."""
        state = aircraft("B", PLACE, velocity=(speed_mps, 0.0, 0.0), age_s=age_s)
        motion = seen(state)
        for far_m, enters in ((reach_m - 1.0, True), (reach_m + 1.0, False)):
            around = beyond(motion, far_m, until_s)
            assert may_enter(motion, intent, around, SETTINGS) is enters
            assert is_too_far(state, intent, PLANE, around, NOW, SETTINGS) is not enters

    @pytest.mark.parametrize(
        ("home", "age_s", "intent", "hazard_radius_m", "reach_m"),
        [
            (None, 3.1, HOLD, 150.0, 150.0),
            (None, 3.1, HOLD, 300.0, 300.0),
            (PLACE, 3.1, HOLD, 300.0, 300.0),
            ((520.0, -390.0), 3.1, HOLD, 150.0, 600.0 + 10.0),
            (None, 0.0, BACK, 50.0, 150.0),
            (PLACE, 0.0, BACK, 150.0, 75.0 + 60.0),
        ],
    )
    def test_of_one_that_is_lost_or_returns_it_is_its_hazard_area_and_its_route_home(
        self,
        home: tuple[float, float] | None,
        age_s: float,
        intent: Intent,
        hazard_radius_m: float,
        reach_m: float,
    ) -> None:
        wide = replace(SETTINGS, hazard_radius_m=hazard_radius_m)
        state = aircraft("B", PLACE, home=home, age_s=age_s)
        motion = seen(state)
        for far_m, enters in ((reach_m - 1.0, True), (reach_m + 1.0, False)):
            around = beyond(motion, far_m)
            assert may_enter(motion, intent, around, wide) is enters
            assert not is_too_far(state, intent, PLANE, around, NOW, wide)


def between(low_m: float, high_m: float) -> TrajectoryBounds:
    return TrajectoryBounds(0.0, 0.0, 1_000.0, low_m, high_m, 5.0)


class TestHeights:
    """At 40 m, for 5 s: 20 m up or down at 4 m/s."""

    up_first = route((90.0, 0.0, 80.0), (99.0, 0.0, 40.0))

    @pytest.mark.parametrize(
        ("intent", "drift_m", "age_s", "up_mps", "low_m", "high_m"),
        [
            (HOLD, 0.0, 0.0, 0.0, 20.0, 60.0),
            (HOLD, 0.0, 3.0, 0.0, 8.0, 72.0),
            (HOLD, 0.0, 0.0, -8.0, 0.0, 80.0),
            (HOLD, 5.0, 0.0, 0.0, 15.0, 65.0),
            (replace(STICK, target_height_above_takeoff_m=80.0), 5.0, 0.0, 0.0, 15.0, 105.0),
            (replace(STICK, target_height_above_takeoff_m=10.0), 5.0, 0.0, 0.0, -15.0, 65.0),
            (flies(up_first), 0.0, 0.0, 0.0, 20.0, 100.0),
            (flies(up_first, 1), 0.0, 0.0, 0.0, 20.0, 60.0),
        ],
    )
    def test_they_hold_its_climb_its_descent_and_what_it_was_sent_to(
        self,
        intent: Intent,
        drift_m: float,
        age_s: float,
        up_mps: float,
        low_m: float,
        high_m: float,
    ) -> None:
        state = aircraft("B", velocity=(0.0, 0.0, up_mps), age_s=age_s)
        motion = seen(state)._replace(drift_m=drift_m)
        for around, enters in (
            (between(-EVERYWHERE_M, low_m + 0.1), True),
            (between(-EVERYWHERE_M, low_m - 0.1), False),
            (between(high_m - 0.1, EVERYWHERE_M), True),
            (between(high_m + 0.1, EVERYWHERE_M), False),
        ):
            assert may_enter(motion, intent, around, SETTINGS) is enters

    def test_a_faster_climb_takes_it_higher(self) -> None:
        quick = replace(SETTINGS, climb_mps=6.0)
        assert may_enter(seen(aircraft()), HOLD, between(69.0, 90.0), quick)
        assert not may_enter(seen(aircraft()), HOLD, between(71.0, 90.0), quick)

    @pytest.mark.parametrize(
        ("intent", "age_s"), [(HOLD, 3.1), (Intent(Commanded.LAND), 0.0), (BACK, 0.0)]
    )
    def test_one_that_is_lost_lands_or_returns_may_be_at_any(
        self, intent: Intent, age_s: float
    ) -> None:
        motion = seen(aircraft("B", age_s=age_s))
        assert may_enter(motion, intent, between(-9.0, 0.0), SETTINGS)
        assert may_enter(motion, intent, between(900.0, 999.0), SETTINGS)


bodies = st.one_of(
    st.builds(
        lambda east_mps, north_mps, height_m: VirtualStick(
            StickFrame.GROUND, 0.0, north_mps, east_mps, height_m, 1.0
        ),
        st.floats(-10.0, 10.0),
        st.floats(-10.0, 10.0),
        heights_m,
    ),
    st.builds(lambda place, height_m: GoTo(at(*place), height_m, 5.0), far_places_m, heights_m),
    st.builds(lambda a, b: FlyMission(route(a, b)), far_places_m, far_places_m),
)


@settings(max_examples=examples(200), deadline=None)
@given(bodies, st.lists(others(), min_size=1, max_size=3))
def test_sorting_out_far_traffic_changes_no_refusal(
    body: VirtualStick | GoTo | FlyMission, traffic: list[tuple[VehicleState, Intent]]
) -> None:
    own, known = aircraft("A"), [Traffic(state, intent) for state, intent in traffic]
    with_bound = judged(body, own, *known)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys.modules[separation.__module__], "is_too_far", lambda *_: False)
        assert judged(body, own, *known) == with_bound


@settings(max_examples=examples(300), deadline=None)
@given(bodies, others())
def test_what_cannot_enter_is_never_met(
    body: VirtualStick | GoTo | FlyMission, other: tuple[VehicleState, Intent]
) -> None:
    state, intent = other
    motion = vehicle_motion(state, AIR, PLANE, NOW, SETTINGS)
    assert motion is not None
    own = predict_order(seen(aircraft("A")), body, SETTINGS)
    around = trajectory_bounds(own, NEED, SETTINGS)
    if not may_enter(motion, intent, around, SETTINGS):
        met = predict_traffic(motion, intent, SETTINGS, around.until_s)
        assert first_conflict(own, met, NEED, SETTINGS) is None


def short_orders() -> st.SearchStrategy[VirtualStick | GoTo]:
    """Orders that end soon, so that others are predicted only for a while."""
    stick = st.builds(
        VirtualStick,
        st.just(StickFrame.GROUND),
        st.just(0.0),
        st.floats(-5.0, 5.0),
        st.floats(-5.0, 5.0),
        st.just(40.0),
        st.floats(0.5, 5.0),
    )
    goto = st.builds(lambda north: GoTo(at(north, 0.0), 40.0, 5.0), st.floats(5.0, 40.0))
    return st.one_of(stick, goto)


@given(
    short_orders(),
    st.lists(st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0)), min_size=3, max_size=12),
    st.floats(100.0, 250.0),
)
@settings(max_examples=examples(300), deadline=None)
def test_the_end_of_interest_leaves_out_no_conflict(
    body: VirtualStick | GoTo, places: list[tuple[float, float]], far_m: float
) -> None:
    """Traffic on its mission may come early: it is predicted for as long as that can matter."""
    own = vehicle_motion(aircraft("A", (0.0, 0.0)), AIR, PLANE, NOW, SETTINGS)
    mission = route((far_m, 0.0), *places)
    coming = aircraft("B", (far_m, 0.0), velocity=(0.0, 0.0, 0.0), mode=FlightMode.GPS_WAYPOINT)
    other = vehicle_motion(coming, AIR, PLANE, NOW, SETTINGS)
    assert own is not None
    assert other is not None
    trajectory = predict_order(own, body, SETTINGS)
    bounds = trajectory_bounds(trajectory, NEED, SETTINGS)
    whole = predict_traffic(other, flies(mission, 1), SETTINGS, FOREVER_S)
    asked = predict_traffic(other, flies(mission, 1), SETTINGS, bounds.until_s)
    found = first_conflict(trajectory, whole, NEED, SETTINGS)
    assert (found is None) is (first_conflict(trajectory, asked, NEED, SETTINGS) is None)
    if found is not None:
        assert may_enter(other, flies(mission, 1), bounds, SETTINGS)


def test_where_times_are_wholly_uncertain_all_of_the_traffic_is_of_interest() -> None:
    endless = replace(SETTINGS, time_uncertainty=1.0)
    assert trajectory_bounds(standing(0.0, 40.0), NEED, endless).until_s == FOREVER_S
