"""Paths between rows: inside the region, and the shortest."""

from itertools import pairwise
from math import hypot, inf

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import planned, star, survey_of

from recon.guidance.survey.region_paths import MOST_CORNERS, RegionPaths, _corners

Place = tuple[float, float]


def box_with_hole() -> shapely.Polygon:
    return shapely.Polygon(
        [(0, 0), (100, 0), (100, 100), (0, 100)], [[(40, 20), (60, 20), (60, 80), (40, 80)]]
    )


def found(paths: RegionPaths, start: Place, end: Place) -> list[Place]:
    """The whole path, ends and all."""
    between = paths.between(start, end)
    assert between is not None
    return [start, *between, end]


def length_m(path: list[Place]) -> float:
    return sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(path))


def test_where_nothing_is_in_the_way_it_is_straight() -> None:
    assert RegionPaths(box_with_hole()).between((10.0, 10.0), (10.0, 90.0)) == ()


def test_round_a_hole_by_the_shorter_side() -> None:
    path = found(RegionPaths(box_with_hole()), (20.0, 30.0), (80.0, 30.0))
    shortest_m = 2.0 * hypot(20.0, 10.0) + 20.0
    assert shortest_m <= length_m(path) < shortest_m + 1.0
    assert all(north_m < 20.0 for _, north_m in path[1:-1])


def test_where_there_is_no_way_there_is_none() -> None:
    apart = shapely.MultiPolygon([shapely.box(0, 0, 10, 10), shapely.box(50, 0, 60, 10)])
    assert RegionPaths(apart).between((5.0, 5.0), (55.0, 5.0)) is None


def test_round_things_are_taken_with_few_corners() -> None:
    rough = (
        shapely.Point(0, 0)
        .buffer(100.0, quad_segs=600)
        .difference(shapely.Point(0, 0).buffer(50.0, quad_segs=600))
    )
    paths = RegionPaths(rough)
    assert len(_corners(rough)) <= MOST_CORNERS
    path = found(paths, (-80.0, 0.0), (80.0, 0.0))
    assert shapely.covers(rough, shapely.LineString(path))
    angle = np.arccos(50.0 / 80.0)
    shortest_m = 2.0 * (80.0 * np.sin(angle)) + 50.0 * (np.pi - 2.0 * angle)
    assert shortest_m <= length_m(path) < 1.03 * shortest_m


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(0, 10**9))
def test_ways_between_all_rows_of_a_drawn_field_stay_inside(seed: int) -> None:
    rng = np.random.default_rng(seed)
    plan = planned(survey_of(star(rng, float(rng.uniform(80.0, 250.0)), has_hole=True)))
    ends = [
        (float(place[0]), float(place[1]))
        for piece in plan.pieces
        for place in plan.lattice.east_north_m(
            [
                (along_m, plan.lattice.row_across_m(piece.row))
                for along_m in (piece.start_m, piece.end_m)
            ]
        )
    ]
    area = plan.paths.area
    for _ in range(10):
        start, end = (ends[int(i)] for i in rng.integers(0, len(ends), 2))
        if shapely.distance(*(_part(area, place) for place in (start, end))) > 0.0:
            assert plan.paths.between(start, end) is None
            continue
        path = found(plan.paths, start, end)
        assert start == end or shapely.covers(area, shapely.LineString(path))


def _part(area: shapely.Geometry, place: Place) -> shapely.Geometry:
    """The part of an area that a place is in."""
    parts = shapely.get_parts(area)
    return min(parts, key=lambda part: shapely.distance(part, shapely.Point(place)) or -inf)


@pytest.mark.parametrize("seed", range(5))
def test_no_way_over_three_corners_is_shorter(seed: int) -> None:
    """Every chain of up to two corners of the area, tried one by one."""
    rng = np.random.default_rng(seed)
    paths = RegionPaths(box_with_hole())
    start, end = ((float(e), float(n)) for e, n in rng.uniform((0, 25), (39, 75), (2, 2)))
    end = (100.0 - end[0], end[1])
    found_m = length_m(found(paths, start, end))
    corners = [(float(e), float(n)) for e, n in _corners(box_with_hole())]
    area = box_with_hole()
    tried = [
        length_m([start, a, b, end])
        for a in corners
        for b in corners
        if shapely.covers(area, shapely.LineString([start, a, b, end]))
    ]
    assert found_m == pytest.approx(min(tried))
