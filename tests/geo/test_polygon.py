"""Regions: shapes whose answers are known, and an independent slow checker on random ones."""

import numpy as np
import numpy.typing as npt
import pytest
import shapely  # type: ignore[import-untyped, unused-ignore]
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import (
    Footprints,
    Polygon,
    enu_from_geo,
    geojson_geometry,
    region_fault,
    shape_of,
)
from recon.model.airspace import Region
from recon.model.geo import GeoPoint, LocalFrame

SQUARE = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
HOLE = np.array([[40.0, 40.0], [60.0, 40.0], [60.0, 60.0], [40.0, 60.0]])
FRAMED = Polygon(Region(SQUARE, (HOLE,)))

finite = st.floats(-200.0, 200.0).map(lambda value: round(value, 3))
point = st.tuples(finite, finite)


def legs(starts: npt.ArrayLike, ends: npt.ArrayLike) -> Footprints:
    """Straight legs as footprints; starts and ends are (N, 2)."""
    return Footprints(np.stack([starts, ends, ends], axis=1))


def star(radii_m: list[float]) -> np.ndarray:
    """A polygon seen whole from the origin: it never crosses itself."""
    angles = np.linspace(0.0, 2.0 * np.pi, len(radii_m), endpoint=False)
    return np.array(radii_m)[:, np.newaxis] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


stars = st.lists(st.floats(5.0, 150.0), min_size=3, max_size=12).map(star)


def winding(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How often the outline goes round each point: the sum of the angles it subtends."""
    to = outline[np.newaxis] - points[:, np.newaxis]
    angles = np.arctan2(to[..., 1], to[..., 0])
    turns = np.diff(angles, axis=1, append=angles[:, :1])
    return np.rint(((turns + np.pi) % (2.0 * np.pi) - np.pi).sum(axis=1) / (2.0 * np.pi))


def slow_distance_m(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The least distance to any edge, edge by edge."""
    nearest = np.full(len(points), np.inf)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        foot = a + along[:, np.newaxis] * (b - a)
        nearest = np.minimum(nearest, np.linalg.norm(points - foot, axis=1))
    return nearest


def test_points_in_a_square_with_a_hole() -> None:
    points = [[10, 50], [50, 50], [100, 50], [40, 50], [130, 140], [-5, 50]]
    assert FRAMED.contains(points).tolist() == [True, False, True, True, False, False]
    assert FRAMED.distance_to_edge_m(points) == pytest.approx([10, -10, 0, 0, -50, -5])
    assert FRAMED.area_m2 == pytest.approx(9_600.0)


@pytest.mark.parametrize(
    ("start", "end", "holds", "clear"),
    [
        ((10, 10), (90, 10), True, False),
        ((10, 50), (90, 50), False, False),  # through the hole
        ((45, 50), (55, 50), False, True),  # wholly in the hole
        ((-10, 50), (-10, 90), False, True),
        ((-10, -10), (110, 110), False, False),
        ((0, 0), (100, 0), True, False),  # along the edge
        ((-50, 50), (50, 150), False, False),  # touches a corner
        ((50, 20), (50, 20), True, False),  # no length
        ((50, 50), (50, 50), False, True),
        ((np.nan, 0), (10, 10), False, False),
        ((-50, 0), (-50, np.inf), False, False),
        ((-50, 0), (-50, 1e300), False, False),
    ],
)
def test_legs(
    start: tuple[float, float], end: tuple[float, float], holds: bool, clear: bool
) -> None:
    assert FRAMED.holds(legs([start], [end])).tolist() == [holds]
    assert FRAMED.is_clear_of(legs([start], [end])).tolist() == [clear]


def test_the_margin_is_kept_on_both_sides() -> None:
    inside, outside = ([[10, 10]], [[90, 10]]), ([[-10, 0]], [[-10, 90]])
    assert FRAMED.holds(legs(*inside), 9.999).all()
    assert not FRAMED.holds(legs(*inside), 10.0).any()
    assert FRAMED.is_clear_of(legs(*outside), 9.999).all()
    assert not FRAMED.is_clear_of(legs(*outside), 10.0).any()


def test_what_is_not_finite_is_neither_inside_nor_at_a_distance() -> None:
    assert not FRAMED.contains([[np.nan, 50.0], [np.inf, 50.0]]).any()
    assert np.isnan(FRAMED.distance_to_edge_m([[np.nan, 50.0], [50.0, -np.inf]])).all()


def test_no_points_give_no_answers() -> None:
    none = np.zeros((0, 2))
    assert FRAMED.contains(none).shape == (0,)
    assert FRAMED.distance_to_edge_m(none).shape == (0,)
    assert FRAMED.holds(legs(none, none)).shape == (0,)


@given(stars, st.lists(point, min_size=1, max_size=20))
def test_points_agree_with_the_slow_checker(outline: np.ndarray, at: list[list[float]]) -> None:
    polygon, points = Polygon(Region(outline)), np.array(at)
    distance_m = slow_distance_m(outline, points)
    assert np.abs(polygon.distance_to_edge_m(points)) == pytest.approx(distance_m, abs=1e-9)
    off_edge = distance_m > 1e-6
    assert (polygon.contains(points) == (winding(outline, points) != 0))[off_edge].all()


@given(stars, point, point, st.floats(0.0, 20.0))
def test_legs_agree_with_dense_sampling(
    outline: np.ndarray,
    start: tuple[float, float],
    end: tuple[float, float],
    margin_m: float,
) -> None:
    polygon = Polygon(Region(outline))
    samples = np.linspace(start, end, 400)
    step_m = np.linalg.norm(np.subtract(end, start)) / 399
    distance_m = slow_distance_m(outline, samples)
    signed_m = np.where(winding(outline, samples) != 0, distance_m, -distance_m)
    holds = polygon.holds(legs([start], [end]), margin_m)[0]
    clear = polygon.is_clear_of(legs([start], [end]), margin_m)[0]
    # The distance changes no faster than the place: between samples by under a step.
    if signed_m.min() > margin_m + step_m:
        assert holds
    if signed_m.min() < margin_m - 1e-6:
        assert not holds
    if signed_m.max() < -margin_m - step_m - 1e-6:
        assert clear
    if signed_m.max() > -margin_m + 1e-6:
        assert not clear


@pytest.mark.parametrize(
    ("outline", "holes", "fault"),
    [
        (
            [(0, 0), (10, 10), (10, 0), (0, 10)],
            [],
            "its edges cross or overlap, 5.0 m east and 5.0",
        ),
        ([(0, 0), (1, 0)], [], "fewer than three corners"),
        ([(0, 0), (1, 0), (np.nan, 1)], [], "not finite"),
        ([(0, 0), (1, 0), (1e300, 1)], [], "not on the earth"),
        ([(0, 0), (0, 0), (0, 0)], [], "fewer than three different corners"),
        ([(0, 0), (1, 0), (2, 0)], [], "its edges cross or overlap"),
        ([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)], [], "its outline touches itself, 1.0"),
        (SQUARE, [HOLE + 200.0], "a hole lies outside its outline"),
        (SQUARE, [HOLE, HOLE + 5.0], "its edges cross or overlap"),
        (SQUARE, [HOLE, (HOLE - 50.0) / 2.0 + 50.0], "a hole lies in another hole"),
        (SQUARE, [[(0, 50), (50, 0), (100, 50), (50, 100)]], "its holes cut it into pieces"),
    ],
)
def test_the_fault_of_an_invalid_region_is_described(
    outline: list[tuple[float, float]], holes: list[list[tuple[float, float]]], fault: str
) -> None:
    region = Region(np.array(outline, float), tuple(np.array(hole, float) for hole in holes))
    assert fault in (region_fault(region) or "")
    with pytest.raises(ValueError, match="expected a polygon whose edges do not meet"):
        Polygon(region)


@given(stars)
def test_a_star_is_a_polygon_whichever_way_it_goes_round(outline: np.ndarray) -> None:
    assert region_fault(Region(outline)) is None
    assert region_fault(Region(outline[::-1])) is None


@given(st.lists(st.tuples(st.floats(), st.floats()), max_size=8))
def test_any_ring_is_a_polygon_or_has_a_fault(corners: list[tuple[float, float]]) -> None:
    region = Region(np.array(corners, float).reshape(-1, 2))
    fault = region_fault(region)
    assert fault or Polygon(region).area_m2 > 0.0


@pytest.mark.parametrize("turn", [1, -1])
def test_geojson_has_longitude_first_and_the_outer_ring_counter_clockwise(turn: int) -> None:
    frame = LocalFrame(GeoPoint(45.0, 8.0, 100.0))
    area = shape_of(Region(SQUARE[::turn], (HOLE[::turn],)))
    geometry = geojson_geometry(frame, area)
    outer, hole = (np.array(ring) for ring in geometry["coordinates"])
    assert geometry["type"] == "Polygon"
    assert shapely.LinearRing(outer).is_ccw
    assert not shapely.LinearRing(hole).is_ccw
    for ring, places_m in ((outer, SQUARE), (hole, HOLE)):
        assert (ring[0] == ring[-1]).all()
        back_m = enu_from_geo(frame, ring[:, 1], ring[:, 0], np.full(len(ring), 100.0))[:-1, :2]
        assert {tuple(p) for p in back_m.round(0)} == {tuple(p) for p in places_m}
