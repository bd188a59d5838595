"""Where a side-step leads, and when the light counts as mostly unknown."""

import numpy as np
import pytest

from recon.geo.distance import horizontal_distance_m, offset_north_east_m
from recon.guidance.side_step import (
    SideStepSettings,
    bearings_deg,
    is_mostly_unknown,
    place_aside,
)
from recon.model.geo import LatLon

HERE = LatLon(41.9, -93.6)
SETTINGS = SideStepSettings()


def test_across_the_sun_comes_first() -> None:
    assert bearings_deg(200.0)[:2] == (290.0, 110.0)
    assert len(set(bearings_deg(200.0))) == 8


def test_without_the_sun_east_comes_first() -> None:
    assert bearings_deg(None)[0] == 90.0


def test_the_place_lies_at_the_bearing() -> None:
    aside = place_aside(HERE, 90.0, 25.0)
    assert horizontal_distance_m(HERE, aside) == pytest.approx(25.0, abs=0.01)
    north_m, east_m = offset_north_east_m(HERE, aside)
    assert (north_m, east_m) == pytest.approx((0.0, 25.0), abs=0.01)


def test_unknown_counts_only_the_ground_in_view() -> None:
    seen = np.zeros((10, 10), np.bool_)
    seen[:5] = True
    known = np.zeros((10, 10), np.bool_)
    known[:3] = True
    assert not is_mostly_unknown(known, seen, SETTINGS)
    known[2] = False
    assert is_mostly_unknown(known, seen, SETTINGS)


def test_no_ground_in_view_is_not_unknown_light() -> None:
    nothing = np.zeros((10, 10), np.bool_)
    assert not is_mostly_unknown(nothing, nothing, SETTINGS)
