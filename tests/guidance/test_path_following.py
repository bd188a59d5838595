"""A path is followed corner after corner, along the straight lines between its waypoints."""

from itertools import pairwise
from math import dist, inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.closed_loop import SETTINGS, START, Loop, Way

from recon.geo.distance import moved_m
from recon.guidance.path_following import CORNER_M, advanced, goal_on, path_from
from recon.guidance.steering import KinematicState
from recon.model.mission import Mission, Waypoint

HEIGHT_M = 30.0
OFF_LINE_M = 6.0
"""At a corner turned back, with half a second of delay and all of the wind: 1,500 drawn flights."""
Point = tuple[float, float, float]
"""North and east of the start, and height."""


def mission(*points: Point, speed_mps: float = 8.0) -> Mission:
    places = [(moved_m(START, north_m, east_m), height_m) for north_m, east_m, height_m in points]
    return Mission(
        tuple(Waypoint(p.latitude_deg, p.longitude_deg, h, speed_mps) for p, h in places)
    )


def seen(north_m: float, east_m: float, height_m: float = HEIGHT_M) -> KinematicState:
    return KinematicState(moved_m(START, north_m, east_m), 0.0, 0.0, height_m, 0.0, 0.1)


def flown(loop: Loop, points: list[Point], at_most_s: float) -> bool:
    """Fly a path to its end; return whether it came there in time."""
    path, way = None, mission(*points)
    for _ in range(round(at_most_s * 10)):
        now = loop.seen()
        if now is None:
            loop.fly(goal_on(path_from(way, seen(0.0, 0.0)), seen(0.0, 0.0), SETTINGS), 0.1)
            continue
        path = advanced(path or path_from(way, now), now, SETTINGS)
        goal = goal_on(path, now, SETTINGS)
        if path.is_on_last_leg and loop.has_arrived(goal):
            return True
        loop.fly(goal, 0.1)
    return False


def off_line_m(at: Point, a: Point, b: Point) -> float:
    """How far a place is from a straight leg."""
    along = [q - p for p, q in zip(a, b, strict=True)]
    length2 = sum(x * x for x in along)
    share = sum((c - p) * x for c, p, x in zip(at, a, along, strict=True)) / length2
    share = min(1.0, max(0.0, share))
    return dist(at, [p + share * x for p, x in zip(a, along, strict=True)])


corners = st.lists(
    st.tuples(st.floats(-120.0, 120.0), st.floats(-120.0, 120.0), st.floats(20.0, 45.0)),
    min_size=1,
    max_size=4,
)
ways = st.builds(
    Way,
    telemetry_s=st.floats(0.05, 0.3),
    stick_s=st.floats(0.05, 0.25),
    wind_north_mps=st.floats(-1.0, 1.0),
    gust_mps=st.floats(0.0, 0.3),
    seed=st.integers(0, 10_000),
)


@settings(max_examples=examples(40), deadline=None)
@given(ways, corners)
def test_it_keeps_to_the_lines_between_waypoints_and_comes_to_their_end(
    way: Way, points: list[Point]
) -> None:
    loop, line = Loop(way), [(0.0, 0.0, HEIGHT_M), *points]
    legs = [(a, b) for a, b in pairwise(line) if dist(a, b) > 0.1]
    assert flown(loop, points, 60.0 * len(line))
    for motion in loop.trace:
        at = (motion.north_m, motion.east_m, motion.height_m)
        assert min((off_line_m(at, *leg) for leg in legs), default=inf) < OFF_LINE_M or not legs


def test_a_corner_is_turned_near_it_and_at_its_height_only() -> None:
    path = path_from(mission((100.0, 0.0, HEIGHT_M), (100.0, 50.0, HEIGHT_M)), seen(0.0, 0.0))
    assert advanced(path, seen(100.0 - CORNER_M - 0.1, 0.0), SETTINGS).index == 0
    assert advanced(path, seen(100.0, 0.0, HEIGHT_M - 2.0), SETTINGS).index == 0
    turned = advanced(path, seen(99.0, 0.0), SETTINGS)
    assert turned.index == 1
    assert goal_on(turned, seen(99.0, 0.0), SETTINGS).yaw_deg == pytest.approx(90.0, abs=0.1)
    assert advanced(turned, seen(100.0, 50.0), SETTINGS) == turned


def test_on_a_slope_the_height_is_that_of_the_line_and_the_speed_what_it_allows() -> None:
    path = path_from(mission((100.0, 0.0, HEIGHT_M + 50.0)), seen(0.0, 0.0))
    goal = goal_on(path, seen(40.0, 0.0, 50.0), SETTINGS)
    assert goal.height_above_takeoff_m == pytest.approx(50.0, abs=0.5)
    assert (goal.speed_mps, goal.progress_mps) == (8.0, pytest.approx(SETTINGS.climb_mps * 2.0))


def test_wind_carries_no_vehicle_away_from_a_steep_leg() -> None:
    loop = Loop(Way(telemetry_s=0.25, stick_s=0.25, wind_north_mps=1.0))
    assert flown(loop, [(0.0, 2.0, 20.0)], 60.0)
    assert max(abs(motion.north_m) for motion in loop.trace) < 5.0


def test_straight_up_it_keeps_its_heading() -> None:
    path = path_from(mission((0.0, 0.0, 60.0)), seen(0.0, 0.0))
    goal = goal_on(path, seen(0.2, -0.3, 40.0), SETTINGS)
    assert (goal.height_above_takeoff_m, goal.yaw_deg) == (60.0, 0.0)
