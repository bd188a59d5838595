"""Paths with rounded corners: what the curve is, how near the polyline stays, where it ends."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import Polygon, rounded_path, straight_path
from recon.geo.path import corner_reaches_m
from recon.model.zone import Region

coordinate = st.integers(-20_000, 20_000).map(lambda decimetres: decimetres / 10.0)
waypoints = st.integers(2, 3).flatmap(
    lambda axes: st.lists(st.tuples(*[coordinate] * axes), min_size=2, max_size=8)
)
chord_errors = st.floats(0.01, 5.0)


@st.composite
def routes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(draw(waypoints))
    radii = draw(st.lists(st.floats(0.0, 1_000.0), min_size=len(points), max_size=len(points)))
    return points, np.array(radii)


def bezier(a: np.ndarray, b: np.ndarray, c: np.ndarray, share: np.ndarray) -> np.ndarray:
    """The quadratic curve by de Casteljau's repeated lines."""
    t = share[:, np.newaxis]
    return (1 - t) * ((1 - t) * a + t * b) + t * ((1 - t) * b + t * c)


def distance_to_path_m(points: np.ndarray, path: np.ndarray) -> np.ndarray:
    nearest = np.full(len(points), np.inf)
    for a, b in pairwise(path):
        square = (b - a) @ (b - a)
        along = np.clip((points - a) @ (b - a) / square, 0, 1) if square > 0 else np.zeros(1)
        foot = a + along[:, np.newaxis] * (b - a)
        nearest = np.minimum(nearest, np.linalg.norm(points - foot, axis=1))
    return nearest


def test_a_right_angle_is_cut_as_a_quadratic_curve() -> None:
    path = rounded_path([[0, 0], [100, 0], [100, 100]], [0.2, 40.0, 0.2], 0.1)
    assert path.points_m[0].tolist() == [0, 0]
    assert path.points_m[1] == pytest.approx([60, 0])
    assert path.points_m[-2] == pytest.approx([100, 40])
    assert path.points_m[-1].tolist() == [100, 100]
    # The middle of a quadratic curve lies half way from the chord to the waypoint.
    assert path.points_m[len(path.points_m) // 2] == pytest.approx([90, 10])
    assert path.leg.tolist() == [0] * (len(path.leg) // 2) + [1] * (len(path.leg) // 2)
    assert 160 + 40 * np.sqrt(2) - 40 < path.length_m < 200


def test_a_straight_path_is_its_waypoints() -> None:
    path = straight_path([[0, 0, 10], [3, 4, 10], [3, 4, 20]])
    assert path.length_m == pytest.approx(15.0)
    assert path.leg.tolist() == [0, 1]
    assert (path.starts_m[1] == path.ends_m[0]).all()


def test_one_waypoint_is_a_path_without_legs() -> None:
    path = rounded_path([[1, 2]], [5.0])
    assert (path.points_m.tolist(), path.leg.tolist(), path.length_m) == ([[1, 2]], [], 0.0)


@given(routes(), chord_errors)
def test_no_point_of_the_curve_is_farther_than_the_chord_error(
    route: tuple[np.ndarray, np.ndarray], chord_error_m: float
) -> None:
    points, radii = route
    path = rounded_path(points, radii, chord_error_m)
    reaches = corner_reaches_m(points, radii)
    for index in range(1, len(points) - 1):
        if reaches[index] <= 0:
            continue
        before, corner, after = points[index - 1 : index + 2]
        start = corner + reaches[index] * (before - corner) / np.linalg.norm(before - corner)
        end = corner + reaches[index] * (after - corner) / np.linalg.norm(after - corner)
        curve = bezier(start, corner, end, np.linspace(0, 1, 60))
        assert distance_to_path_m(curve, path.points_m).max() <= chord_error_m + 1e-6


@given(routes(), chord_errors)
def test_the_path_hangs_together_and_is_no_longer_than_its_legs(
    route: tuple[np.ndarray, np.ndarray], chord_error_m: float
) -> None:
    points, radii = route
    path = rounded_path(points, radii, chord_error_m)
    assert (path.points_m[0] == points[0]).all()
    assert (path.points_m[-1] == points[-1]).all()
    assert path.length_m <= straight_path(points).length_m + 1e-6
    assert len(path.leg) == len(path.points_m) - 1
    assert set(np.diff(path.leg)) <= {0, 1}
    assert (path.leg[0], path.leg[-1]) == (0, len(points) - 2)


@given(routes())
def test_neighbouring_corners_never_overlap_and_fitting_ones_keep_their_radius(
    route: tuple[np.ndarray, np.ndarray],
) -> None:
    points, radii = route
    reaches = corner_reaches_m(points, radii)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert (reaches[:-1] + reaches[1:] <= lengths + 1e-6).all()
    whole = radii.copy()
    whole[[0, -1]] = 0.0
    assert (reaches <= whole).all()
    if (whole[:-1] + whole[1:] <= lengths).all():
        assert (reaches == whole).all()


@given(
    st.lists(st.floats(), min_size=3, max_size=3),
    st.integers(0, 2),
    st.sampled_from([np.nan, np.inf, -np.inf, 1e300]),
)
def test_what_is_not_finite_stays_in_the_path_and_no_fence_holds_it(
    values: list[float], at: int, nowhere: float
) -> None:
    points = np.array([[0.0, 0.0], [50.0, 0.0], [50.0, 50.0]])
    points[at, 0] = nowhere
    path = rounded_path(points, np.abs(values))
    field = Polygon(Region(np.array([[-1e3, -1e3], [1e3, -1e3], [1e3, 1e3], [-1e3, 1e3]])))
    assert not field.holds_legs(path.starts_m, path.ends_m).all()
    assert not field.is_clear_of_legs(path.starts_m, path.ends_m).all()


@given(routes())
def test_radii_given_are_not_changed(route: tuple[np.ndarray, np.ndarray]) -> None:
    points, radii = route
    kept = radii.copy()
    rounded_path(points, radii)
    assert (radii == kept).all()


@pytest.mark.parametrize(
    ("points", "radii", "error_m", "message"),
    [
        ([[0, 0], [1, 1]], [0, 0], 0.0, "chord error above 0"),
        ([[0, 0], [1, 1]], [0, 0], float("nan"), "chord error above 0"),
        ([[0, 0], [1, 1]], [0], 0.1, "expected 2 corner radii"),
        ([], [], 0.1, "waypoints, got"),
    ],
)
def test_misuse_is_told(points: list, radii: list, error_m: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rounded_path(points, radii, error_m)
