"""Polygons asked about whole footprints: known shapes, and dense sampling on random ones."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import Box, Footprints, Polygon
from recon.model.airspace import Region

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
HOLE = np.array([[40.0, 40.0], [60.0, 40.0], [60.0, 60.0], [40.0, 60.0]])
FRAMED = Polygon(Region(SQUARE, (HOLE,)))
L_SHAPE = np.array([[0, 0], [100, 0], [100, 40], [40, 40], [40, 100], [0, 100.0]])


def one(*points: tuple[float, float]) -> Footprints:
    """A place, a leg or a triangle."""
    padded = (*points, points[-1], points[-1])[:3]
    return Footprints([padded])


@pytest.mark.parametrize(
    ("points", "inset_m", "holds"),
    [
        (((10, 10), (30, 10), (10, 30)), 0.0, True),
        (((10, 10), (30, 10), (10, 30)), 9.99, True),
        (((10, 10), (30, 10), (10, 30)), 10.0, False),  # not more than 10 m from the edge
        (((10, 10), (90, 10), (50, 90)), 0.0, False),  # round the hole
        (((0, 0), (100, 0)), 0.0, True),  # along the edge
        (((0, 0), (100, 0)), 0.001, False),
        (((20, 20),), 19.99, True),
        (((50, 50),), 0.0, False),
        (((10, 10),), -1e-170, True),
        (((-1, 10),), -1e-170, False),
        (((50, 50),), -9.99, False),
        (((50, 50),), -10.01, True),
        (((-5, 50), (50, 20)), -5.01, True),
        (((-5, 50), (50, 20)), -4.99, False),
        (((np.nan, 0), (10, 10)), 0.0, False),
        (((np.nan, 0), (10, 10)), -1e6, False),
    ],
)
def test_what_a_region_holds(
    points: tuple[tuple[float, float], ...], inset_m: float, holds: bool
) -> None:
    assert FRAMED.holds(one(*points), inset_m).tolist() == [holds]


@pytest.mark.parametrize(
    ("points", "gap_m", "clear"),
    [
        (((-10, 0), (-10, 90), (-30, 50)), 9.99, True),
        (((-10, 0), (-10, 90), (-30, 50)), 10.0, False),
        (((-10, -10), (-10, 200), (200, -10)), 0.0, False),  # over a part of it
        (((-300, -300), (400, -300), (50, 400)), 0.0, False),  # round it
        (((0, 0), (0, -10)), 0.0, False),  # touches
        (((50, 50),), 9.99, True),  # in the hole
        (((50, 50),), 10.0, False),
        (((10, 50),), -1e-170, False),
        (((-1, 50),), -1e-170, True),
        (((10, 50),), -10.01, True),
        (((10, 50),), -9.99, False),
        (((10, 50), (90, 50)), -25.0, True),  # nowhere deeper than 20 m
        (((10, 50), (90, 50)), -19.0, False),
        (((20, 20), (80, 20)), -60.0, True),  # nothing is as deep as that
        (((500, 500),), 5.0, True),
        (((np.inf, 0),), 0.0, False),
        (((np.nan, 0),), -1e6, False),
    ],
)
def test_what_is_clear_of_a_region(
    points: tuple[tuple[float, float], ...], gap_m: float, clear: bool
) -> None:
    assert FRAMED.is_clear_of(one(*points), gap_m).tolist() == [clear]


def test_how_far() -> None:
    inside, over, outside = ((10, 10), (30, 10)), ((50, 20), (130, 20)), ((-7, 0), (-7, 90))
    every = Footprints([(*leg, leg[-1]) for leg in (inside, over, outside)])
    assert FRAMED.room_m(every) == pytest.approx([10.0, -30.0, -7.0])
    assert FRAMED.gap_m(every) == pytest.approx([0.0, 0.0, 7.0])
    broken = one((np.nan, 0.0))
    assert np.isnan([FRAMED.room_m(broken)[0], FRAMED.gap_m(broken)[0]]).all()
    assert len(every) == 3
    assert FRAMED.holds(every.only(np.array([2, 0]))).tolist() == [False, True]


@given(
    seed=st.integers(0, 100_000),
    inset_m=st.floats(-30.0, 30.0),
)
def test_a_footprint_is_held_when_all_its_points_are(seed: int, inset_m: float) -> None:
    random = np.random.default_rng(seed)
    outline = L_SHAPE if seed % 2 else SQUARE
    polygon = Polygon(Region(outline))
    centre = random.uniform(-20.0, 120.0, 2)
    triangle = centre + random.uniform(-40.0, 40.0, (3, 2))
    samples = random.dirichlet([0.5, 0.5, 0.5], 1_500) @ triangle
    inside_m = polygon.distance_to_edge_m(np.concatenate([samples, triangle]))
    footprint = Footprints([triangle])
    if polygon.holds(footprint, inset_m)[0]:
        assert inside_m.min() >= inset_m - 0.01
    elif polygon.holds(footprint, inset_m - 8.0)[0]:
        # What is not held but nearly: a sample is not far from the worst point.
        assert inside_m.min() <= inset_m + 8.0
    if polygon.is_clear_of(footprint, -inset_m)[0]:
        assert inside_m.max() <= inset_m + 0.01


millimetres = st.floats(-30.0, 130.0).map(lambda value: round(value, 3))


@given(
    st.lists(st.tuples(*[millimetres] * 6), min_size=1, max_size=6),
    st.sampled_from([0.0, 0.5, 5.0, 20.0]),
)
def test_answers_without_geos_agree_with_geos(
    corners: list[tuple[float, ...]], inset_m: float
) -> None:
    """The inscribed circle answers most questions, and never more than the exact answer."""
    outline = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 90.0], [55.0, 40.0], [0.0, 100.0]])
    hole = np.array([[70.0, 10.0], [80.0, 10.0], [75.0, 20.0]])
    triangles_m = np.array(corners).reshape(-1, 3, 2)
    area = shapely.Polygon(outline, [hole])
    hulls = shapely.convex_hull(shapely.multipoints(triangles_m))
    exactly = shapely.covers(area, hulls)
    if inset_m > 0.0:
        exactly &= ~shapely.dwithin(shapely.boundary(area), hulls, inset_m)
    held = Polygon(Region(outline, (hole,))).holds(Footprints(triangles_m), inset_m)
    assert held.tolist() == exactly.tolist()


def test_a_place_in_the_middle_and_places_near_the_edge() -> None:
    square = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
    places = [(50.0, 50.0), (50.0, 3.0), (50.0, -1.0), (np.nan, 50.0), (1.0, 1.0)]
    triangles_m = np.array([[place] * 3 for place in places])
    held = Polygon(Region(square)).holds(Footprints(triangles_m), 2.0)
    assert held.tolist() == [True, True, False, False, False]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 2e8])
@pytest.mark.parametrize("coordinate", range(6))
def test_the_box_round_footprints_is_unbounded_if_any_number_of_one_is_no_place(
    coordinate: int, bad: float
) -> None:
    triangles_m = np.array([[(1.0, 2.0), (3.0, 4.0), (5.0, 0.0)]] * 3)
    assert Footprints(triangles_m).box == Box(1.0, 0.0, 5.0, 4.0)
    triangles_m[1].flat[coordinate] = bad
    footprints = Footprints(triangles_m)
    assert footprints.box == Box(-np.inf, -np.inf, np.inf, np.inf)
    assert footprints.is_finite.tolist() == [True, False, True]
    assert footprints.only(np.array([0, 2])).box == Box(1.0, 0.0, 5.0, 4.0)


def test_the_box_round_no_footprint_is_unbounded() -> None:
    assert Footprints(np.zeros((0, 3, 2))).box == Box(-np.inf, -np.inf, np.inf, np.inf)
