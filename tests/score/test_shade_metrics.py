"""Maps drawn by hand, whose agreement can be counted on fingers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from recon.score.boundary_error import FARTHEST_EDGE_M, edge_error
from recon.score.shade_figures import Overlap, ShadeFigures, map_figures, overlap

ROWS, COLS, CELL_M = 6, 8, 4.0
ALL = np.ones((ROWS, COLS), dtype=np.bool_)
masks = arrays(np.bool_, (ROWS, COLS))


def strip(first: int, after: int) -> np.ndarray:
    """Shade from one column up to another."""
    mask = np.zeros((ROWS, COLS), dtype=np.bool_)
    mask[:, first:after] = True
    return mask


def light(is_shade: np.ndarray, shade: float = 0.1, sun: float = 0.9) -> np.ndarray:
    return np.where(is_shade, shade, sun).astype(np.float32)


def figures(
    called: np.ndarray, truth: np.ndarray, known: np.ndarray = ALL, counted: np.ndarray = ALL
) -> ShadeFigures:
    return map_figures(light(called), known, light(truth), counted, CELL_M)


def test_two_strips_that_share_two_of_six_columns() -> None:
    found = overlap(strip(0, 4), strip(2, 6), ALL)
    assert found == Overlap(both=12, either=36)
    assert found.iou == pytest.approx(1.0 / 3.0)


def test_cells_that_do_not_count_change_nothing() -> None:
    assert overlap(strip(0, 4), strip(2, 6), strip(2, 4)).iou == 1.0
    assert figures(strip(0, 4), strip(2, 6), ALL, strip(2, 4)).cells == 12


def test_no_shade_at_all_has_no_iou() -> None:
    found = figures(strip(0, 0), strip(0, 0))
    assert found.iou is None
    assert found.mixed_ious == ()
    assert found.right_share == 1.0


def test_false_missed_wrong_and_unknown_cells_are_counted_apart() -> None:
    # Columns: 0-3 in shade, 4-7 in sun. Called shade: 1-4. Unknown: 3 and 7.
    known = ALL.copy()
    known[:, [3, 7]] = False
    found = figures(strip(1, 5), strip(0, 4), known)
    assert (found.cells, found.shaded, found.unknown) == (48, 24, 12)
    assert (found.missed, found.false, found.wrong, found.known) == (6, 6, 12, 36)
    assert found.right_share == pytest.approx(24.0 / 48.0)
    # Both: columns 1, 2. Either: 0-4 and 7: unknown ground in sun counts as called shade.
    assert found.shade == Overlap(both=12, either=36)


def test_an_unknown_map_is_never_wrong_and_has_no_overlap() -> None:
    found = figures(strip(0, 4), strip(0, 4), ~ALL)
    assert (found.wrong, found.unknown, found.right_share) == (0, 48, 0.0)
    assert found.iou == 0.0
    assert found.transmittance_error == 0.0


def test_only_maps_with_some_shade_and_some_sun_are_mixed() -> None:
    one_cell, two_cells, most = (np.zeros_like(ALL) for _ in range(3))
    one_cell.flat[0] = two_cells.flat[:3] = True  # 2.1 % and 6.3 % of 48 cells
    most.flat[:46] = True  # 95.8 %
    assert figures(one_cell, one_cell).mixed == Overlap()
    assert figures(two_cells, two_cells).mixed_ious == (1.0,)
    assert figures(most, most).mixed_ious == ()
    total = figures(one_cell, strip(0, 4)) + figures(strip(2, 6), strip(0, 4))
    assert total.mixed_ious == (pytest.approx(1.0 / 24.0), pytest.approx(1.0 / 3.0))
    assert total.mixed == Overlap(1 + 12, 24 + 36)


def test_the_transmittance_error_is_the_mean_over_known_cells() -> None:
    truth, known = light(strip(0, 4), 0.0, 1.0), ~strip(4, 6)
    found = map_figures(light(strip(0, 4), 0.2, 0.7), known, truth, ALL, CELL_M)
    # 24 cells are 0.2 off, 12 known cells in sun 0.3 off.
    assert found.transmittance_error / found.known == pytest.approx((24 * 0.2 + 12 * 0.3) / 36)


def test_values_of_unknown_cells_are_not_read() -> None:
    nothing = np.full((ROWS, COLS), np.nan, dtype=np.float32)
    found = map_figures(nothing, ~ALL, light(strip(0, 4)), ALL, CELL_M)
    assert found == figures(strip(0, 4), strip(0, 4), ~ALL)


def boundary_m(
    called: np.ndarray, truth: np.ndarray, known: np.ndarray | None = None
) -> float | None:
    every = np.ones_like(truth)
    return edge_error(called, every if known is None else known, truth, every, CELL_M).mean_m


def test_an_edge_two_cells_off_is_so_many_metres_off() -> None:
    assert boundary_m(strip(0, 3), strip(0, 5)) == pytest.approx(2 * CELL_M)


def test_the_same_edges_are_nothing_off() -> None:
    assert boundary_m(strip(1, 3), strip(1, 3)) == 0.0


def test_a_true_edge_that_is_not_on_the_map_counts_as_far_off() -> None:
    assert boundary_m(strip(0, 0), strip(0, 3)) == FARTHEST_EDGE_M
    assert boundary_m(strip(0, 3), strip(0, 3), ~ALL) == FARTHEST_EDGE_M


def test_without_a_true_edge_there_is_no_boundary_error() -> None:
    assert boundary_m(strip(0, 3), strip(0, 0)) is None
    assert boundary_m(strip(0, 0), strip(0, 0)) is None


def test_unknown_ground_has_no_edge_of_its_own() -> None:
    # The edge of the shade, at column 4, is known; columns 6 and 7 are not.
    assert boundary_m(strip(0, 4), strip(0, 4), strip(0, 6)) == 0.0


def test_a_stray_cell_weighs_as_one_cell() -> None:
    truth = np.zeros((40, 40), dtype=np.bool_)
    truth[:, :20] = True
    called = truth.copy()
    called[10, 32] = True
    # Regions with edges: half of the ground in truth, half of it and one cell on the map. The
    # stray cell's four edges are 12 to 13 cells from the true edge; all others are in place.
    sides = [12.0, 13.0, 12.5, 12.5]
    mean_cells = np.mean(sides)
    assert boundary_m(called, truth) == pytest.approx(
        CELL_M * mean_cells / (800 + 800 + 1), rel=0.01
    )


def test_many_stray_cells_of_a_perfect_map_make_little_error() -> None:
    rng = np.random.default_rng(1)
    truth = np.zeros((100, 100), dtype=np.bool_)
    truth[:, :45] = True
    called = truth ^ (rng.random(truth.shape) < 0.02)
    error_m = boundary_m(called, truth)
    assert error_m is not None
    assert error_m < 5.0


def test_a_large_cloud_missed_weighs_more_than_a_small_one() -> None:
    truth = np.zeros((60, 60), dtype=np.bool_)
    truth[5:35, 5:35] = True
    truth[50:54, 50:54] = True
    large, small = truth.copy(), truth.copy()
    large[5:35, 5:35] = small[50:54, 50:54] = False
    without_large, without_small = boundary_m(large, truth), boundary_m(small, truth)
    assert without_large is not None
    assert without_small is not None
    assert without_large > 10.0 * without_small > 0.0


def test_boundary_errors_add_up_by_area() -> None:
    one = edge_error(strip(0, 3), ALL, strip(0, 5), ALL, CELL_M)
    other = edge_error(strip(0, 4), ALL, strip(0, 4), ALL, CELL_M)
    # Areas of the smaller regions: 18 cells (both ways) two cells off, 24 cells not off.
    assert (one.area, other.area) == (36.0, 48.0)
    assert (one + other).mean_m == pytest.approx(8.0 * 36.0 / 84.0)


@given(called=masks, truth=masks, known=masks, counted=masks)
def test_ranges_and_sums(
    called: np.ndarray, truth: np.ndarray, known: np.ndarray, counted: np.ndarray
) -> None:
    found = figures(called, truth, known, counted)
    assert 0 <= found.shade.both <= found.shade.either <= found.cells == counted.sum()
    assert found.unknown + found.wrong <= found.cells
    assert found.iou is None or 0.0 <= found.iou <= 1.0
    error_m = found.edges.mean_m
    assert error_m is None or 0.0 <= error_m <= FARTHEST_EDGE_M
    assert figures(truth, truth, ALL, counted).iou in (1.0, None)


@given(truth=masks, known=masks, called=masks)
def test_more_unknown_cells_never_raise_the_iou(
    truth: np.ndarray, known: np.ndarray, called: np.ndarray
) -> None:
    whole, part = figures(called, truth), figures(called, truth, known)
    assert (part.iou or 0.0) <= (1.0 if whole.iou is None else whole.iou)
    assert part.wrong <= whole.wrong


@given(st.integers(0, 5), st.integers(0, 5))
def test_overlaps_add_up(first: int, second: int) -> None:
    one, other = Overlap(first, 2 * first), Overlap(second, 3 * second)
    assert one + other == Overlap(first + second, 2 * first + 3 * second) == other + one
