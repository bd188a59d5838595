"""Maps drawn by hand, whose agreement can be counted on fingers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap
from recon.score.shade_scoring import (
    FARTHEST_EDGE_M,
    Overlap,
    boundary_error_m,
    overlap,
    shade_or_wrong,
)

FRAME = LocalFrame(GeoPoint(45.0, -93.0, 250.0))
ALL = np.ones((6, 8), dtype=np.bool_)
masks = arrays(np.bool_, (6, 8))


def strip(first: int, after: int) -> np.ndarray:
    """Shade from one column up to another."""
    mask = np.zeros((6, 8), dtype=np.bool_)
    mask[:, first:after] = True
    return mask


def shade_map(is_shade: np.ndarray, valid: np.ndarray) -> ShadeMap:
    transmittance = np.where(valid, np.where(is_shade, 0.1, 0.9), np.nan).astype(np.float32)
    grid = GroundGrid(FRAME, 0.0, 24.0, 4.0, 6, 8)
    return ShadeMap(
        grid, 0, (), transmittance, valid, valid.astype(np.float32), valid.astype(np.float32)
    )


def test_two_strips_that_share_two_of_six_columns() -> None:
    found = overlap(strip(0, 4), strip(2, 6), ALL)
    assert found == Overlap(both=12, either=36)
    assert found.iou == pytest.approx(1.0 / 3.0)


def test_cells_outside_the_footprint_do_not_count() -> None:
    assert overlap(strip(0, 4), strip(2, 6), strip(2, 4)).iou == 1.0


def test_no_shade_at_all_has_no_iou() -> None:
    assert overlap(strip(0, 0), strip(0, 0), ALL).iou is None


def test_what_is_unknown_counts_as_wrong_in_sun_and_in_shade() -> None:
    truth, valid = strip(0, 4), ALL.copy()
    valid[:, 3:5] = False
    detected = shade_or_wrong(shade_map(truth, valid), truth)
    assert (detected != truth).tolist() == (~valid).tolist()
    # Three columns are detected in shade and are; one is missed, and one in sun counts as shade.
    assert overlap(detected, truth, ALL) == Overlap(both=18, either=30)


def test_an_edge_two_cells_off_is_so_many_metres_off() -> None:
    assert boundary_error_m(strip(0, 3), strip(0, 5), ALL, 4.0) == pytest.approx(8.0)


def test_the_same_edges_are_nothing_off() -> None:
    assert boundary_error_m(strip(1, 3), strip(1, 3), ALL, 4.0) == 0.0


def test_an_edge_on_one_map_alone_counts_as_far_off() -> None:
    assert boundary_error_m(strip(0, 3), strip(0, 0), ALL, 4.0) == FARTHEST_EDGE_M
    assert boundary_error_m(strip(0, 0), strip(0, 0), ALL, 4.0) is None


def test_edges_at_the_footprints_end_are_none() -> None:
    assert boundary_error_m(strip(0, 3), strip(0, 3), strip(0, 3), 4.0) is None


@given(detected=masks, truth=masks, counted=masks)
def test_ranges_and_sameness(detected: np.ndarray, truth: np.ndarray, counted: np.ndarray) -> None:
    found = overlap(detected, truth, counted)
    assert 0 <= found.both <= found.either <= counted.sum()
    assert found == overlap(truth, detected, counted)
    error_m = boundary_error_m(detected, truth, counted, 4.0)
    assert error_m is None or 0.0 <= error_m <= FARTHEST_EDGE_M
    back_m = boundary_error_m(truth, detected, counted, 4.0)
    assert (error_m is None) == (back_m is None)
    assert error_m is None or error_m == pytest.approx(back_m, rel=1e-5)
    assert overlap(truth, truth, counted).iou in (1.0, None)


@given(truth=masks, valid=masks, mapped=masks)
def test_more_unknown_cells_never_help(
    truth: np.ndarray, valid: np.ndarray, mapped: np.ndarray
) -> None:
    known = shade_or_wrong(shade_map(mapped, ALL), truth)
    less = shade_or_wrong(shade_map(mapped, valid), truth)
    assert ((less != truth) >= (known != truth)).all()


@given(st.integers(0, 5), st.integers(0, 5))
def test_overlaps_add_up(first: int, second: int) -> None:
    one, other = Overlap(first, 2 * first), Overlap(second, 3 * second)
    assert one + other == Overlap(first + second, 2 * first + 3 * second) == other + one
