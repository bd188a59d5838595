"""How near vehicles are to a hazard area with a way home: a circle, a corridor, a landing."""

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
"""Its way home is 500 m long, towards 3 east and 4 north."""


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
def test_the_way_home_ends_where_it_lands(along_m: float, beside_m: float, gap_m: float) -> None:
    east_m = 100.0 + 0.6 * along_m - 0.8 * beside_m
    north_m = 200.0 + 0.8 * along_m + 0.6 * beside_m
    assert horizontal_m(HOME, east_m, north_m) == pytest.approx(gap_m)


def test_one_at_home_has_no_way() -> None:
    there = replace(AREA, home_m=(100.0, 200.0))
    assert horizontal_m(there, 160.0, 280.0) == pytest.approx(80.0)
    near = replace(AREA, radius_m=0.0, home_m=(100.5, 200.0))
    assert horizontal_m(near, 150.5, 200.0) == pytest.approx(42.0)
