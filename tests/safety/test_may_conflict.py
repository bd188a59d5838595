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
)

from recon.model.command import FlyMission, GoTo, StickFrame, VirtualStick
from recon.model.control import Commanded, Intent
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import Traffic
from recon.safety.prediction import vehicle_motion
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
from recon.safety.prediction.trajectory import FOREVER_S, FlightPart, Trajectory, TrajectoryWriter
from recon.safety.rules.separation import separation
from recon.safety.separation_minima import SeparationMinima

NEED = SeparationMinima(horizontal_m=15.0, vertical_m=8.0)

places_m = st.floats(-120.0, 120.0)
heights_m = st.floats(20.0, 70.0)


@st.composite
def trajectories(draw: st.DrawFn) -> Trajectory:
    """Some straight pieces, with bands of heights and growing discs; at the end it stays."""
    height_m = draw(heights_m)
    writer = TrajectoryWriter(draw(places_m), draw(places_m), height_m, height_m)
    for _ in range(draw(st.integers(1, 4))):
        low_m = draw(heights_m)
        writer.moves(
            draw(places_m),
            draw(places_m),
            draw(st.floats(1.0, 20.0)),
            0,
            curve=draw(st.sampled_from([0.0, 0.001])),
            band_m=(low_m, low_m + draw(st.floats(0.0, 5.0))),
            radius_m=draw(st.sampled_from([None, 3.0, 10.0])),
        )
    if draw(st.booleans()):
        writer.stays(FlightPart.HOVERING)
    return writer.trajectory("SIM-1", "SIM-1")


@settings(max_examples=examples(300))
@given(trajectories(), trajectories())
def test_what_meets_is_never_sorted_out(own: Trajectory, other: Trajectory) -> None:
    if first_conflict(own, [other], NEED, SETTINGS) is not None:
        assert may_conflict(other, trajectory_bounds(own, NEED, SETTINGS))


def standing(east_m: float, up_m: float) -> Trajectory:
    writer = TrajectoryWriter(east_m, 0.0, up_m, up_m)
    writer.stays(FlightPart.HOVERING)
    return writer.trajectory("SIM-2", "SIM-2")


def test_what_is_elsewhere_or_at_other_heights_is_sorted_out() -> None:
    around = trajectory_bounds(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_conflict(standing(14.9, 40.0), around)
    assert not may_conflict(standing(15.1, 40.0), around)
    assert may_conflict(standing(0.0, 47.9), around)
    assert not may_conflict(standing(0.0, 48.1), around)
    assert not may_conflict(standing(0.0, 31.9), around)


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
