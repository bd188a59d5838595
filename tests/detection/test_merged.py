"""Shade maps of several imaging drones become one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.detection import merged
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap

GRID = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 300.0)), -8.0, 8.0, 4.0, 4, 4)
ROWS, COLS = 4, 4


def shade(
    transmittance: float, cols: slice, *, confidence: float = 1.0, coarse_m: float = 1.0, by: str
) -> ShadeMap:
    """A map that knows some columns only."""
    valid = np.zeros((ROWS, COLS), np.bool_)
    valid[:, cols] = True
    nowhere = np.float32(np.nan)
    return ShadeMap(
        GRID,
        5,
        (by,),
        np.where(valid, np.float32(transmittance), nowhere),
        valid,
        np.where(valid, np.float32(confidence), np.float32(0.0)),
        np.where(valid, np.float32(coarse_m), nowhere),
    )


def test_one_alone_is_itself() -> None:
    only = shade(1.0, slice(0, 2), by="A")
    assert merged([only]) is only


def test_each_shows_what_the_others_do_not() -> None:
    one = merged([shade(1.0, slice(0, 2), by="A"), shade(0.0, slice(2, 3), by="B")])
    assert one.source_serials == ("A", "B")
    assert one.valid[0].tolist() == [True, True, True, False]
    assert one.transmittance[0, :3].tolist() == [1.0, 1.0, 0.0]
    assert np.isnan(one.transmittance[0, 3])
    assert one.confidence[0].tolist() == [1.0, 1.0, 1.0, 0.0]
    assert one.metres_per_pixel[0, :3].tolist() == [1.0, 1.0, 1.0]


def test_the_surer_and_the_finer_counts_more() -> None:
    """Half a metre a pixel is four pixels a square metre: as good as four times the confidence."""
    fine = shade(1.0, slice(0, 4), confidence=0.2, coarse_m=0.5, by="A")
    sure = shade(0.0, slice(0, 4), confidence=0.8, coarse_m=1.0, by="B")
    one = merged([fine, sure])
    assert one.transmittance == pytest.approx(np.full((ROWS, COLS), 0.5), abs=1e-6)
    assert one.confidence == pytest.approx(np.full((ROWS, COLS), 0.5), abs=1e-6)
    assert (one.metres_per_pixel == 0.5).all()
    surer = merged([fine, replace(sure, metres_per_pixel=sure.metres_per_pixel / 2)])
    assert surer.transmittance == pytest.approx(np.full((ROWS, COLS), 0.2), abs=1e-6)


@given(
    values=st.lists(
        st.tuples(
            st.floats(0.0, 1.0, width=32),
            st.floats(0.0, 1.0, width=32),
            st.floats(0.125, 8.0, width=32),
        ),
        min_size=1,
        max_size=4,
    )
)
def test_it_lies_between_those_merged(values: list[tuple[float, float, float]]) -> None:
    shades = [shade(t, slice(0, 4), confidence=c, coarse_m=m, by="A") for t, c, m in values]
    one = merged(shades)
    lights = [t for t, _, _ in values]
    assert min(lights) - 1e-6 <= one.transmittance[0, 0] <= max(lights) + 1e-6
    assert one.valid.all()
    assert one.source_serials == ("A",)


def test_other_grids_are_refused() -> None:
    here = shade(1.0, slice(0, 2), by="A")
    there = replace(here, grid=replace(GRID, west_m=0.0))
    with pytest.raises(ValueError, match="expected shade maps on one grid"):
        merged([here, there])
