"""Paths with rounded corners: what the curve is, how near the polyline stays, where it ends."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import Footprints, Polygon, corner_hulls, rounded_path, straight_path
from recon.geo.path import corner_reaches_m
from recon.model.airspace import Region

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
def test_the_path_is_connected_and_no_longer_than_its_legs(
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
    legs = Footprints(np.stack([path.starts_m, path.ends_m, path.ends_m], axis=1))
    assert not field.holds(legs).all()
    assert not field.is_clear_of(legs).all()


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
def test_misuse_raises(points: list, radii: list, error_m: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rounded_path(points, radii, error_m)


class TestCornerHulls:
    """The triangle that holds a corner, whichever of two things its radius means."""

    def hull(self, *points: tuple[float, ...], radius_m: float) -> np.ndarray:
        radii = np.full(len(points), radius_m)
        return corner_hulls(np.array(points, dtype=float), radii)[0]

    def test_a_square_corner_starts_and_ends_its_radius_away(self) -> None:
        found = self.hull((0, 0, 9), (50, 0, 9), (50, 50, 9), radius_m=10.0)
        assert found == pytest.approx(np.array([[40, 0, 9], [50, 0, 9], [50, 10, 9]]))

    def test_a_sharp_one_may_be_an_arc_that_starts_farther_away(self) -> None:
        """A turn of 120 degrees: an arc of 10 m touches its legs 10 tan 60 m from the waypoint."""
        back = (100.0 - 50.0, 50.0 * np.sqrt(3.0))
        found = self.hull((0, 0), (100, 0), back, radius_m=10.0)
        assert np.linalg.norm(found - (100.0, 0.0), axis=1) == pytest.approx(
            [17.32, 0, 17.32], abs=0.01
        )

    def test_a_flat_one_starts_its_radius_away(self) -> None:
        found = self.hull((0, 0), (100, 0), (200, 10), radius_m=10.0)
        assert np.linalg.norm(found - (100.0, 0.0), axis=1) == pytest.approx([10, 0, 10])

    @pytest.mark.parametrize("radius_m", [0.2, 10.0, 1000.0])
    def test_turning_back_takes_at_most_each_leg(self, radius_m: float) -> None:
        found = self.hull((0, 0), (100, 0), (60, 0), radius_m=radius_m)
        assert found == pytest.approx(np.array([[0, 0], [100, 0], [60, 0]]))

    def test_heights_go_along_the_legs(self) -> None:
        found = self.hull((0, 0, 0), (30, 0, 40), (30, 50, 40), radius_m=10.0)
        assert found == pytest.approx(np.array([[24, 0, 32], [30, 0, 40], [30, 10, 40]]))

    def test_a_waypoint_twice_is_no_corner(self) -> None:
        found = self.hull((0, 0), (100, 0), (100, 0), radius_m=5.0)
        assert found == pytest.approx(np.array([[95, 0], [100, 0], [100, 0]]))

    @given(
        turn_deg=st.floats(1.0, 175.0), radius_m=st.floats(0.2, 40.0), start_deg=st.floats(0, 360)
    )
    def test_both_curves_lie_in_the_hull(
        self, turn_deg: float, radius_m: float, start_deg: float
    ) -> None:
        """The arc that touches both legs and the Bezier corner, wherever they fit their legs."""
        turn, start = np.radians(turn_deg), np.radians(start_deg)
        ahead = np.array([np.cos(start), np.sin(start)])
        onward = np.array([np.cos(start + turn), np.sin(start + turn)])
        points = np.array([-1_000.0 * ahead, [0.0, 0.0], 1_000.0 * onward])
        found = corner_hulls(points, np.full(3, radius_m))[0]
        outline = Polygon(Region(found))
        arc_reach_m = radius_m * np.tan(turn / 2.0)
        if arc_reach_m < 1_000.0:
            centre = -arc_reach_m * ahead + radius_m * np.array([-ahead[1], ahead[0]])
            angles = start - np.pi / 2.0 + np.linspace(0.0, turn, 50)
            arc = centre + radius_m * np.stack([np.cos(angles), np.sin(angles)], axis=1)
            assert outline.distance_to_edge_m(arc).min() > -1e-6
        bezier = rounded_path(points, [0.2, radius_m, 0.2]).points_m[1:-1]
        assert outline.distance_to_edge_m(bezier).min() > -1e-6
