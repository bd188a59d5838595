"""How near vehicles are to a hazard area with a route home: a circle, a corridor, a landing."""

from dataclasses import replace

import numpy as np
import pytest

from recon.safety.prediction import HazardArea
from recon.safety.prediction.trajectory import Samples
from recon.safety.separation_minima import SeparationMinima
from recon.safety.watchdogs.closest_approach import hazard_closeness

NEED = SeparationMinima(10.0, 5.0)
AREA = HazardArea("B", 4.0, 100.0, 200.0, 20.0, 5.0, 60.0, 30.0, 50.0, None, 40.0, 8.0)
"""At 100 m east and 200 m north, 20 m wide and growing to 60 m; its corridor is 16 m wide."""
HOME = replace(AREA, home_m=(400.0, 600.0))
"""Its route home is 500 m long, towards 3 east and 4 north."""


def shares(
    area: HazardArea, east_m: float, north_m: float, up_m: float, *, is_height_known: bool = True
) -> tuple[float, float]:
    """Closeness and vertical gap of a vehicle; a second one's heights are always known."""
    east, north, up = (np.array([[value]] * 2) for value in (east_m, north_m, up_m))
    where = Samples(east, north, up, up, np.zeros((2, 1)))
    unknown = np.array([not is_height_known, False])
    close, _, gap_m = hazard_closeness(where, np.array([0.0]), area, NEED, unknown)
    known, _, known_gap_m = hazard_closeness(where, np.array([0.0]), area, NEED)
    assert (close[1, 0], gap_m[1, 0]) == (known[1, 0], known_gap_m[1, 0])
    return float(close[0, 0]), float(gap_m[0, 0])


def horizontal_m(area: HazardArea, east_m: float, north_m: float, after_s: float = 0.0) -> float:
    """From a vehicle at 45 m, in the band of heights of the area and of its corridor."""
    east, north, up = (np.array([[value]]) for value in (east_m, north_m, 45.0))
    where = Samples(east, north, up, up, np.zeros((1, 1)))
    _, gap_m, _ = hazard_closeness(where, np.array([after_s]), area, NEED)
    return float(gap_m[0, 0])


@pytest.mark.parametrize(("after_s", "radius_m"), [(0.0, 20.0), (2.0, 30.0), (8.0, 60.0), (9, 60)])
def test_the_circle_grows_to_its_largest(after_s: float, radius_m: float) -> None:
    assert horizontal_m(AREA, 400.0, 600.0, after_s) == pytest.approx(500.0 - radius_m)
    assert horizontal_m(AREA, -200.0, -200.0, after_s) == pytest.approx(500.0 - radius_m)


@pytest.mark.parametrize(
    ("along_m", "beside_m", "gap_m"),
    [
        (250.0, 100.0, 92.0),
        (250.0, -100.0, 92.0),
        (500.0, 100.0, 92.0),
        (800.0, 0.0, 292.0),
        (800.0, 400.0, 492.0),
        (-300.0, 0.0, 280.0),
        (-300.0, 400.0, 480.0),
    ],
)
def test_the_route_home_ends_where_it_lands(along_m: float, beside_m: float, gap_m: float) -> None:
    east_m = 100.0 + 0.6 * along_m - 0.8 * beside_m
    north_m = 200.0 + 0.8 * along_m + 0.6 * beside_m
    assert horizontal_m(HOME, east_m, north_m) == pytest.approx(gap_m)


def test_one_at_home_has_no_way() -> None:
    there = replace(AREA, home_m=(100.0, 200.0))
    assert horizontal_m(there, 160.0, 280.0) == pytest.approx(80.0)
    near = replace(AREA, radius_m=0.0, home_m=(100.5, 200.0))
    assert horizontal_m(near, 150.5, 200.0) == pytest.approx(42.0)
    assert horizontal_m(near, 100.25, 200.0) == pytest.approx(-8.0)


@pytest.mark.parametrize(
    ("up_m", "gap_m", "closeness"),
    [(53.0, 3.0, 0.6), (60.0, 10.0, 2.0), (28.0, 2.0, 0.5), (10.0, 20.0, 4.0), (35.0, 0.0, 0.5)],
)
def test_height_separates_from_the_circle_and_from_the_landing(
    up_m: float, gap_m: float, closeness: float
) -> None:
    """5 m beside the circle, and 5 m beside the place where it lands."""
    assert shares(HOME, 100.0, 175.0, up_m) == pytest.approx((closeness, gap_m))
    assert shares(HOME, 413.0, 600.0, up_m) == pytest.approx((closeness, gap_m))


@pytest.mark.parametrize(
    ("up_m", "closeness"), [(53.0, 0.6), (60.0, 2.0), (37.0, 0.6), (30.0, 2.0), (45.0, 0.5)]
)
def test_the_route_home_keeps_above_the_height_it_begins_at(up_m: float, closeness: float) -> None:
    """5 m beside its corridor, half-path."""
    assert shares(HOME, 250.0 - 0.8 * 13.0, 400.0 + 0.6 * 13.0, up_m)[0] == pytest.approx(closeness)


@pytest.mark.parametrize(("up_m", "gap_m"), [(53.0, 0.0), (500.0, 0.0), (45.0, 0.0)])
def test_no_height_above_it_separates_where_heights_cannot_be_compared(
    up_m: float, gap_m: float
) -> None:
    assert shares(AREA, 100.0, 175.0, up_m, is_height_known=False)[1] == pytest.approx(gap_m)


@pytest.mark.parametrize(("up_m", "closeness"), [(500.0, -0.08), (10.0, -0.08), (45.0, -0.88)])
def test_no_height_separates_from_the_route_home_where_heights_cannot_be_compared(
    up_m: float, closeness: float
) -> None:
    """In the middle of its corridor, half-path: 8 m deep, which is a tenth of 0.8 nearer."""
    found = shares(HOME, 250.0, 400.0, up_m, is_height_known=False)
    assert found[0] == pytest.approx(closeness)
