"""Waypoints are counted as they are passed: never back, never onto a neighbouring row."""

from dataclasses import replace
from itertools import pairwise
from math import cos, hypot, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.fleet.mission_progress import Seen, distance_to_m, waypoints_passed
from recon.geo.distance import moved_m
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import VelocityNed

ORIGIN = LatLon(42.0, -93.6)
Place = tuple[float, float]


def mission(*places: Place, height_m: float = 40.0) -> Mission:
    points = [moved_m(ORIGIN, *place) for place in places]
    return Mission(tuple(Waypoint(p.latitude_deg, p.longitude_deg, height_m, 5.0) for p in points))


def count(flown: Mission, passed: int, place: Place, since_s: float = 0.1) -> int:
    return waypoints_passed(flown, passed, Seen(moved_m(ORIGIN, *place), 40.0), since_s)


def along(places: list[Place], step_m: float) -> list[Place]:
    """Points of a path flown at even steps."""
    flown: list[Place] = []
    for (n1, e1), (n2, e2) in pairwise(places):
        steps = max(1, round(hypot(n2 - n1, e2 - e1) / step_m))
        flown += [
            (n1 + (n2 - n1) * k / steps, e1 + (e2 - e1) * k / steps) for k in range(steps + 1)
        ]
    return flown


ROWS = [(0.0, 0.0), (100.0, 0.0), (100.0, 6.0), (0.0, 6.0), (0.0, 12.0), (100.0, 12.0)]


def test_none_is_passed_on_the_way_to_the_first() -> None:
    assert count(mission(*ROWS), 0, (50.0, 0.0)) == 0
    assert count(mission(*ROWS), 0, (2.0, 1.0)) == 1


def test_along_narrow_rows_it_counts_one_after_the_other() -> None:
    flown, passed, counts = mission(*ROWS), 0, [0]
    for place in along(ROWS, 0.5):
        passed = count(flown, passed, place)
        counts.append(passed)
    assert counts == sorted(counts)
    assert set(counts) == {0, 1, 2, 3, 4, 5, 6}


def test_the_neighbouring_row_is_not_taken_for_the_present_one() -> None:
    """Half way along the first row, 3.4 m beside it: nearer to the second."""
    assert count(mission(*ROWS), 1, (50.0, 3.4)) == 1


def test_a_corner_that_was_cut_is_passed_all_the_same() -> None:
    flown = mission((0.0, 0.0), (100.0, 0.0), (100.0, 100.0))
    assert count(flown, 1, (80.0, 0.5)) == 1
    assert count(flown, 1, (90.0, 15.0)) == 2


def test_turning_back_on_the_same_line_is_seen_at_the_turning_point() -> None:
    flown = mission((0.0, 0.0), (100.0, 0.0), (2.0, 0.0))
    assert count(flown, 1, (98.0, 0.0)) == 2
    assert count(flown, 1, (50.0, 0.0)) == 1


def test_after_a_gap_the_newest_place_tells() -> None:
    flown = mission(*ROWS)
    assert count(flown, 1, (50.0, 6.0), since_s=12.0) == 3
    assert count(flown, 0, (60.0, 0.0), since_s=12.0) == 1
    assert count(flown, 1, (100.0, 12.0), since_s=60.0) == 6


def test_what_is_passed_stays_passed() -> None:
    assert count(mission(*ROWS), 4, (0.0, 0.0)) == 4
    assert count(mission(*ROWS), 6, (0.0, 0.0)) == 6


def test_heights_count_when_they_are_known() -> None:
    flown = mission((0.0, 0.0), (50.0, 0.0))
    here = moved_m(ORIGIN, 0.0, 0.0)
    assert waypoints_passed(flown, 0, Seen(here, 10.0), 0.1) == 0
    assert waypoints_passed(flown, 0, Seen(here, None), 0.1) == 1
    assert distance_to_m(flown.waypoints[0], here, 10.0) == 30.0


def test_one_that_climbs_to_a_waypoint_has_not_passed_it() -> None:
    """It eases into the height for another second or two, above the same place."""
    flown = mission((0.0, 0.0), (50.0, 0.0))
    here = moved_m(ORIGIN, 0.5, 0.0)

    def passed(height_m: float, climb_mps: float) -> int:
        return waypoints_passed(
            flown, 0, Seen(here, height_m, VelocityNed(0.0, 0.0, -climb_mps)), 0.1
        )

    assert passed(37.5, 2.0) == 0
    assert passed(38.9, 1.4) == 0
    assert passed(39.7, 0.7) == 1
    assert passed(39.0, 0.4) == 1, "it holds there: heights may differ by a little"
    assert passed(40.8, 1.4) == 1, "it leaves upwards"
    assert passed(42.0, -1.4) == 0


@pytest.mark.parametrize(("is_curved", "expected"), [(False, 1), (True, 2)])
def test_one_that_brakes_at_a_corner_has_not_passed_it(is_curved: bool, expected: int) -> None:
    flown = mission((0.0, 0.0), (50.0, 0.0), (50.0, 50.0))
    flown = replace(flown, curved=is_curved)
    brakes = Seen(moved_m(ORIGIN, 48.0, 0.0), 40.0, VelocityNed(2.0, 0.0, 0.0))
    assert waypoints_passed(flown, 1, brakes, 0.1) == expected
    stands = brakes._replace(velocity=VelocityNed(0.1, 0.0, 0.0))
    assert waypoints_passed(flown, 1, stands, 0.1) == 2


PLACES = st.tuples(st.floats(-300.0, 300.0), st.floats(-300.0, 300.0))


@settings(max_examples=examples(300), deadline=None)
@given(st.lists(PLACES, min_size=2, max_size=12), st.lists(PLACES, max_size=20), st.data())
def test_the_count_only_grows_and_stays_within_the_mission(
    points: list[Place], places: list[Place], data: st.DataObject
) -> None:
    flown, passed = mission(*points), 0
    for place in places:
        newer = count(flown, passed, place, data.draw(st.floats(0.0, 30.0)))
        assert passed <= newer <= len(points)
        passed = newer


@settings(max_examples=examples(200), deadline=None)
@given(st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(20.0, 80.0)), min_size=2, max_size=8))
def test_a_path_without_sharp_turns_is_counted_to_its_end(turns: list[tuple[float, float]]) -> None:
    """By construction: each leg at most a radian off the one before."""
    places, course = [(0.0, 0.0)], 0.0
    for turn, length_m in turns:
        course += turn
        north, east = places[-1]
        places.append((north + length_m * cos(course), east + length_m * sin(course)))
    flown, passed = mission(*places), 0
    for place in along(places, 1.0):
        passed = count(flown, passed, place)
    assert passed == len(places)
