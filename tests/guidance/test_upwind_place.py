"""Where the imaging drone sees most: geometry by hand, and places that may not be used."""

from math import cos, hypot, radians, sin, tan

import numpy as np
import pytest

from recon.camera.sight import farthest_sight_m
from recon.guidance.upwind_place import (
    LEAD_S,
    GroundView,
    best_place,
    field_points_m,
    seen_from,
    upwind_deg,
)

HALF_M = 194.0
"""Of a square of 15 ha."""
SQUARE_M = np.array([[-HALF_M, -HALF_M], [HALF_M, -HALF_M], [HALF_M, HALF_M], [-HALF_M, HALF_M]])
HEIGHT_M, FIELD_RAD = 118.0, radians(65.0)
LEVEL = GroundView(HEIGHT_M, FIELD_RAD)
TILTED = GroundView(HEIGHT_M, FIELD_RAD, radians(20.0), farthest_sight_m(HEIGHT_M, 250.0, 12.0))


def everywhere(points_m: np.ndarray) -> np.ndarray:
    return np.ones(len(points_m), dtype=np.bool_)


FIELD_M = field_points_m(SQUARE_M, everywhere)


def test_a_level_view_is_a_circle() -> None:
    radius_m = HEIGHT_M * tan(FIELD_RAD)
    for bearing in np.linspace(0.0, 6.0, 7):
        for share, is_shown in ((0.99, True), (1.01, False)):
            ahead, aside = (np.array([share * radius_m * f(bearing)]) for f in (cos, sin))
            assert LEVEL.shows(ahead, aside).item() is is_shown


def test_a_tilted_view_reaches_ahead_and_less_behind() -> None:
    """Behind: to the tilt less the field from straight down. Ahead: as far as a pixel is fine."""
    behind_m = HEIGHT_M * tan(FIELD_RAD - radians(20.0))
    ahead_m = np.sqrt(TILTED.farthest_m**2 - HEIGHT_M**2)
    edges_m = np.array([-behind_m - 1.0, -behind_m + 1.0, ahead_m - 1.0, ahead_m + 1.0])
    assert TILTED.shows(edges_m, np.zeros(4)).tolist() == [False, True, True, False]
    assert ahead_m == pytest.approx(583.0, abs=2.0)


def test_a_pixel_at_the_farthest_sight_shows_so_much_ground() -> None:
    sight_m = farthest_sight_m(HEIGHT_M, 250.0, 12.0)
    down = np.arccos(HEIGHT_M / sight_m)
    nearer, farther = (HEIGHT_M * tan(down + half / 250.0) for half in (-0.5, 0.5))
    assert farther - nearer == pytest.approx(12.0, rel=0.01)


@pytest.mark.parametrize(("velocity", "bearing"), [((0.0, -5.0), 0.0), ((-5.0, 0.0), 90.0)])
def test_upwind_is_where_shadows_come_from(velocity: tuple[float, float], bearing: float) -> None:
    assert upwind_deg(velocity) == pytest.approx(bearing)


def test_the_shares_are_those_of_shifted_areas() -> None:
    """A lens that sees a half plane: what remains of the square when it is moved upwind."""
    half_plane = GroundView(HEIGHT_M, radians(89.999), 0.0, 300.0)
    square = field_points_m(0.5 * SQUARE_M, everywhere)
    found = seen_from(square, (0.0, 0.0), 270.0, (4.0, 0.0), half_plane, 60.0)
    assert found.predicted_at(0.0) == 1.0
    radius_m = np.sqrt(300.0**2 - HEIGHT_M**2)
    for lead_s in LEAD_S[1:]:
        seen = np.hypot(square[:, 0] - 4.0 * lead_s, square[:, 1]) <= radius_m
        assert found.predicted_at(lead_s) == pytest.approx(seen.mean())


@pytest.mark.parametrize("view", [LEVEL, TILTED])
@pytest.mark.parametrize("bearing", [0.0, 50.0, 200.0])
def test_the_best_place_lies_upwind_and_foresees_more_than_the_middle(
    view: GroundView, bearing: float
) -> None:
    velocity = (7.5 * sin(radians(bearing)), 7.5 * cos(radians(bearing)))
    best = best_place(FIELD_M, velocity, view, 60.0, everywhere)
    assert best is not None
    middle = seen_from(FIELD_M, (0.0, 0.0), upwind_deg(velocity), velocity, view, 60.0)
    assert best.worth > middle.worth
    assert best.predicted_at(60.0) > middle.predicted_at(60.0)
    upwind_m = -(best.east_m * velocity[0] + best.north_m * velocity[1]) / 7.5
    assert upwind_m > 0.9 * hypot(best.east_m, best.north_m) > 0.0


def test_only_allowed_places_are_chosen() -> None:
    def is_near(points_m: np.ndarray) -> np.ndarray:
        return np.hypot(*points_m.T) < 100.0

    best = best_place(FIELD_M, (7.5, 0.0), LEVEL, 60.0, is_near)
    assert best is not None
    assert hypot(best.east_m, best.north_m) < 100.0
    nowhere = best_place(FIELD_M, (7.5, 0.0), LEVEL, 60.0, lambda p: ~everywhere(p))
    assert nowhere is None


def test_shadows_that_stand_still_are_seen_best_from_the_middle() -> None:
    best = best_place(FIELD_M, (0.1, 0.0), LEVEL, 60.0, everywhere)
    assert best is not None
    assert (best.east_m, best.north_m) == pytest.approx((0.0, 0.0), abs=10.0)


def test_a_region_smaller_than_a_sample_is_its_corners() -> None:
    tiny = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    assert field_points_m(tiny, everywhere).tolist() == tiny.tolist()
    hollow = field_points_m(SQUARE_M, lambda p: np.hypot(*p.T) > 100.0)
    assert 0 < len(hollow) < len(FIELD_M)


def test_a_field_of_any_size_has_few_points() -> None:
    assert 1_000 < len(field_points_m(100.0 * SQUARE_M, everywhere)) < 2_500


def test_without_following_more_of_the_field_stays_in_view() -> None:
    """What has left the view is lost then: places far upwind are worth less."""
    velocity = (7.5, 0.0)
    followed, plain = (best_place(FIELD_M, velocity, LEVEL, s, everywhere) for s in (60.0, 0.0))
    assert followed is not None
    assert plain is not None
    assert plain.predicted_at(0.0) > followed.predicted_at(0.0)
    assert max(plain.followed) == 0.0
