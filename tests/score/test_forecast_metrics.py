"""Figures of forecasts, by hand and on any forecast."""

from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from recon.forecast import NextChange
from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import SunForecast
from recon.score.change_figures import ChangeScore, score_change
from recon.score.forecast_figures import (
    BINS,
    Calibration,
    LeadScore,
    SeenCells,
    score_cells,
    sun_probability,
)
from recon.score.interval import log_ratio
from recon.score.shade_figures import Overlap

GRID = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 280.0)), 0.0, 20.0, 10.0, 2, 2)
ALL = np.ones((2, 2), dtype=np.bool_)


def forecast(levels: list[int]) -> SunForecast:
    """The same levels of 255 at both leads."""
    each = np.array(levels, dtype=np.uint8).reshape(2, 2)
    nowhere = np.zeros((2, 2), dtype=np.float32)
    return SunForecast(
        GRID, 0, np.array([0.0, 60.0]), np.stack([each, each]), nowhere, 0.5, "drawn"
    )


def test_brier_and_iou_of_seen_unseen_and_all() -> None:
    chances = np.array([[1.0, 0.0], [0.2, 0.8]])
    is_sunlit = np.array([[True, True], [False, False]])
    found = score_cells(chances, is_sunlit, np.array([[True, True], [False, False]]), ALL)
    # Seen: right and in sun; and wrong, in shade. Not seen: 0.2 and 0.8 of sun, both in shade.
    seen, unseen = found[SeenCells.SEEN], found[SeenCells.UNSEEN]
    assert (seen.squares, seen.cells, seen.shade) == (1.0, 2, Overlap(0, 1))
    assert unseen.squares == pytest.approx(0.2**2 + 0.8**2)
    assert unseen.shade == Overlap(1, 2)
    assert found[SeenCells.ALL].brier == pytest.approx((1.0 + 0.04 + 0.64) / 4.0)
    assert found[SeenCells.ALL].shade.iou == pytest.approx(1.0 / 3.0)


def test_a_coin_has_a_quarter_and_nothing_seen_no_brier() -> None:
    found = score_cells(np.full((2, 2), 0.5), ~ALL, ~ALL, ALL)
    assert found[SeenCells.ALL].brier == 0.25
    assert found[SeenCells.SEEN].brier is None


def test_cells_that_are_not_scored_do_not_count() -> None:
    found = score_cells(np.ones((2, 2)), ~ALL, ALL, np.diag([True, False]))
    assert found[SeenCells.ALL].cells == 1


def test_the_calibration_error_is_that_of_the_bins() -> None:
    """A hundred cells at 0.95 of which 80 are in sun, a hundred at 0.55 of which 55 are."""
    chances = np.repeat([0.95, 0.55], 100).reshape(1, -1)
    sunlit = np.concatenate([np.arange(100) < 80, np.arange(100) < 55]).reshape(1, -1)
    every = np.ones(chances.shape, dtype=np.bool_)
    found = score_cells(chances, sunlit, every, every)[SeenCells.ALL]
    assert found.calibration.error_sum / found.cells == pytest.approx(0.15 / 2.0)
    # Errors of two forecasts may cancel: the sums are pooled first.
    other = score_cells(chances, sunlit | (chances == 0.95), every, every)[SeenCells.ALL]
    pooled = found + other
    assert pooled.calibration.error_sum / pooled.cells == pytest.approx(0.05 / 2.0)


def test_cells_off_the_forecasts_grid_have_its_prior() -> None:
    wider = GroundGrid(GRID.frame, GRID.west_m, GRID.north_m, GRID.cell_m, 2, 3)
    chances = sun_probability(forecast([255, 0, 51, 204]), 60.0, wider)
    assert chances.tolist() == [[1.0, 0.0, 0.5], [0.2, 0.8, 0.5]]


def test_a_lead_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match=r"expected a lead of \[0.0, 60.0\] s, got 45.0"):
        sun_probability(forecast([9] * 4), 45.0, GRID)


def test_a_ratio_of_pairs_is_that_of_their_logarithms() -> None:
    """What all runs share drops out: each is half of its pair, whatever the sky was."""
    found = log_ratio([(0.1, 0.2), (0.01, 0.02), (0.3, 0.6), (None, 0.3), (0.0, 0.1)])
    assert found is not None
    assert found.count == 3
    assert (found.mean, found.low, found.high) == pytest.approx((0.5, 0.5, 0.5))
    spread = log_ratio([(0.1, 0.2), (0.2, 0.2)])
    assert spread is not None
    assert spread.mean == pytest.approx(exp(log(0.5) / 2.0))
    assert spread.low < 0.5 < 1.0 < spread.high
    assert log_ratio([(0.0, 0.0)]) is None


@given(
    chances=arrays(np.float64, (2, 2), elements=st.floats(0.0, 1.0)),
    seen=arrays(np.bool_, (2, 2)),
    truth=arrays(np.bool_, (2, 2)),
    counted=arrays(np.bool_, (2, 2)),
)
def test_ranges_and_the_parts_are_the_whole(
    chances: np.ndarray, seen: np.ndarray, truth: np.ndarray, counted: np.ndarray
) -> None:
    found = score_cells(chances, truth, seen, counted)
    for score in found.values():
        assert score.brier is None or 0.0 <= score.brier <= 1.0
        assert 0 <= score.shade.both <= score.shade.either <= score.cells
        assert sum(score.calibration.predicted) <= score.cells + 1e-9
        assert score.calibration.error_sum <= score.cells + 1e-9
    assert found[SeenCells.ALL] == found[SeenCells.SEEN] + found[SeenCells.UNSEEN]
    assert found[SeenCells.ALL].cells == counted.sum()
    assert LeadScore() + found[SeenCells.ALL] == found[SeenCells.ALL]
    assert len(Calibration().sunlit) == BINS


def changes(
    predicted_s: list[float], horizon_s: float = 60.0, is_sunlit: bool = True
) -> NextChange:
    """Times to shade that are predicted; NaN where none is."""
    after_s = np.array(predicted_s)
    count = len(after_s)
    chance = np.isfinite(after_s).astype(np.float64)
    lit = np.full(count, is_sunlit)
    return NextChange(lit, np.full(count, horizon_s), chance, after_s, after_s, after_s)


NEVER = np.inf


def test_times_to_shade_are_scored_as_counted_by_hand() -> None:
    predicted_s = [20.0, 30.0, 40.0, 50.0, np.nan, np.nan]
    true_s = [20.0, 42.0, 74.0, 76.0, 30.0, NEVER]
    found = score_change(changes(predicted_s), np.array(true_s))
    # The third comes within the grace after the horizon, the fourth too late for it.
    assert (found.predicted, found.false_alarms, found.came, found.missed) == (4, 1, 3, 1)
    assert [i for i, n in enumerate(found.errors) if n] == [0, 2, 6]
    assert found.median_error_s == 12.5
    twice = found + found
    assert (twice.predicted, twice.median_error_s) == (8, 12.5)


def test_cells_in_shade_or_with_no_view_ahead_do_not_count() -> None:
    true_s = np.array([20.0])
    for one in (changes([20.0], is_sunlit=False), changes([20.0], horizon_s=0.0)):
        assert score_change(one, true_s) == ChangeScore()
    assert ChangeScore().median_error_s is None


@given(arrays(np.float64, 12, elements=st.floats(0.0, 200.0)), st.floats(5.0, 100.0))
def test_what_is_predicted_as_it_comes_is_no_error(true_s: FloatArray, horizon_s: float) -> None:
    known_s = np.where(true_s <= horizon_s, true_s, np.nan)
    found = score_change(changes(known_s.tolist(), horizon_s), true_s)
    assert (found.false_alarms, found.missed) == (0, 0)
    assert found.predicted == found.came == sum(found.errors) == found.errors[0]
