"""A shade map as motion alone changes it."""

from dataclasses import replace

import numpy as np
import pytest

from recon.forecast import moved_on
from recon.forecast.moved_on import CONFIDENCE_HALVES_S
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S

GRID = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 300.0)), 0.0, 40.0, 4.0, 10, 10)


@pytest.fixture
def shade() -> ShadeMap:
    values = np.random.default_rng(3).uniform(0.0, 1.0, (10, 10)).astype(np.float32)
    valid = np.ones((10, 10), np.bool_)
    valid[0, 0] = False
    light = np.where(valid, values, np.float32(np.nan))
    sure = valid.astype(np.float32)
    return ShadeMap(GRID, 7 * NS_PER_S, ("A",), light, valid, sure, sure)


def test_it_moves_with_the_shadows_and_leaves_unknown_ground(shade: ShadeMap) -> None:
    """4 m/s east and 2 m/s north for 2 s: two columns right, one row up."""
    later = moved_on(shade, (4.0, 2.0), 2.0)
    assert later.captured_at_ns == 9 * NS_PER_S
    assert np.array_equal(later.transmittance[:9, 2:], shade.transmittance[1:, :8], equal_nan=True)
    assert np.array_equal(later.valid[:9, 2:], shade.valid[1:, :8])
    assert not later.valid[9].any()
    assert not later.valid[:, :2].any()
    assert np.isnan(later.transmittance[9]).all()
    assert not later.confidence[9].any()


def test_it_is_believed_less_with_age(shade: ShadeMap) -> None:
    later = moved_on(shade, None, CONFIDENCE_HALVES_S)
    assert later.confidence == pytest.approx(shade.confidence / 2.0)
    assert np.array_equal(later.transmittance, shade.transmittance, equal_nan=True)


def test_at_once_it_is_the_same(shade: ShadeMap) -> None:
    same = moved_on(shade, (5.0, 5.0), 0.0)
    assert np.array_equal(same.transmittance, shade.transmittance, equal_nan=True)
    assert np.array_equal(same.valid, shade.valid)
    assert np.array_equal(same.confidence, shade.confidence)
    assert replace(same, transmittance=shade.transmittance).captured_at_ns == 7 * NS_PER_S
