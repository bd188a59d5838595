"""Where cells are, and which cell of one grid lies at those of another."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import cell_centres_m, nearest_cells
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 280.0))
SOURCE = GroundGrid(FRAME, 0.0, 30.0, 10.0, 3, 3)
TARGET = GroundGrid(FRAME, -4.0, 32.0, 4.0, 3, 3)


def test_centres_count_from_the_north_west_corner() -> None:
    east_m, north_m = cell_centres_m(TARGET)
    assert east_m.tolist() == [-2.0, 2.0, 6.0]
    assert north_m.tolist() == [30.0, 26.0, 22.0]


def test_a_centre_on_an_edge_belongs_to_the_cell_below() -> None:
    rows, cols, is_on = nearest_cells(SOURCE, TARGET)
    assert rows.ravel().tolist() == [0, 0, 0]
    assert cols.ravel().tolist() == [0, 0, 0]
    assert is_on.tolist() == [[False, True, True]] * 3


def test_cells_are_read_east_and_north_of_their_places() -> None:
    rows, cols, is_on = nearest_cells(SOURCE, TARGET, (10.0, -20.0))
    assert rows.ravel().tolist() == [2, 2, 2]
    assert cols.ravel().tolist() == [0, 1, 1]
    assert is_on.all()


@given(
    west_m=st.integers(-50, 50),
    north_m=st.integers(-50, 50),
    off_m=st.tuples(st.integers(-40, 40), st.integers(-40, 40)),
)
def test_each_is_the_cell_around_the_place(
    west_m: int, north_m: int, off_m: tuple[int, int]
) -> None:
    target = GroundGrid(FRAME, float(west_m), float(north_m), 3.0, 5, 4)
    rows, cols, is_on = nearest_cells(SOURCE, target, (float(off_m[0]), float(off_m[1])))
    east_m, north = cell_centres_m(target)
    for row, col in np.ndindex(5, 4):
        down = (SOURCE.north_m - north[row] - off_m[1]) / SOURCE.cell_m
        right = (east_m[col] + off_m[0] - SOURCE.west_m) / SOURCE.cell_m
        inside = 0.0 <= down < 3.0 and 0.0 <= right < 3.0
        assert is_on[row, col] == inside
        if inside:
            assert (rows[row, 0], cols[0, col]) == (int(down), int(right))
