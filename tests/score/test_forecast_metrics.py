"""Forecasts of four cells, whose Brier scores can be worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import SunForecast
from recon.score.forecast_figures import HorizonCells, LeadScore, score_lead
from recon.score.shade_figures import Overlap

GRID = GroundGrid(LocalFrame(GeoPoint(45.0, -93.0, 250.0)), 0.0, 8.0, 4.0, 2, 2)
ALL = np.ones((2, 2), dtype=np.bool_)
LEADS_S = (0.0, 60.0)


def forecast(levels: object, horizon_s: object) -> SunForecast:
    """The same levels of 255 at both leads."""
    each = np.array(levels, dtype=np.uint8).reshape(2, 2)
    return SunForecast(
        GRID,
        0,
        np.array(LEADS_S),
        np.stack([each, each]),
        np.array(horizon_s, dtype=np.float32).reshape(2, 2),
        0.5,
        "drawn",
    )


def test_brier_and_iou_of_seen_unseen_and_all() -> None:
    predicted = forecast([255, 0, 51, 204], [60.0, 60.0, 0.0, 30.0])
    is_sunlit = np.array([[True, True], [False, False]])
    found = score_lead(predicted, 60.0, GRID, is_sunlit, ALL)
    # Within: right and in sun; and wrong, in shade. Beyond: 0.2 and 0.8 of sun, both in shade.
    assert found[HorizonCells.WITHIN] == LeadScore(1.0, 2, Overlap(0, 1))
    assert found[HorizonCells.BEYOND].squares == pytest.approx(0.2**2 + 0.8**2)
    assert found[HorizonCells.BEYOND].shade == Overlap(1, 2)
    assert found[HorizonCells.ALL].brier == pytest.approx((1.0 + 0.04 + 0.64) / 4.0)
    assert found[HorizonCells.ALL].shade.iou == pytest.approx(1.0 / 3.0)


def test_a_coin_has_a_quarter() -> None:
    found = score_lead(forecast([128] * 4, [0.0] * 4), 60.0, GRID, ~ALL, ALL)
    assert found[HorizonCells.ALL].brier == pytest.approx(0.25, abs=0.003)


def test_nothing_seen_has_no_brier() -> None:
    assert (
        score_lead(forecast([9] * 4, [0.0] * 4), 60.0, GRID, ALL, ALL)[HorizonCells.WITHIN].brier
        is None
    )


def test_cells_outside_the_footprint_do_not_count() -> None:
    found = score_lead(forecast([255] * 4, [60.0] * 4), 60.0, GRID, ~ALL, np.diag([True, False]))
    assert found[HorizonCells.ALL].cells == 1


def test_cells_off_the_forecasts_grid_have_its_prior() -> None:
    wider = GroundGrid(GRID.frame, GRID.west_m, GRID.north_m, GRID.cell_m, 2, 3)
    counted = np.ones((2, 3), dtype=np.bool_)
    found = score_lead(forecast([255] * 4, [60.0] * 4), 60.0, wider, counted, counted)
    assert found[HorizonCells.WITHIN] == LeadScore(0.0, 4, Overlap())
    assert found[HorizonCells.BEYOND] == LeadScore(2 * 0.5**2, 2, Overlap())


def test_a_lead_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match=r"expected a lead of \[0.0, 60.0\] s, got 45.0"):
        score_lead(forecast([9] * 4, [0.0] * 4), 45.0, GRID, ALL, ALL)


@given(
    levels=arrays(np.uint8, 4),
    horizon_s=arrays(np.float32, 4, elements=st.sampled_from([0.0, 30.0, 60.0])),
    truth=arrays(np.bool_, (2, 2)),
    counted=arrays(np.bool_, (2, 2)),
    lead_s=st.sampled_from(LEADS_S),
)
def test_ranges_and_the_parts_are_the_whole(
    levels: np.ndarray,
    horizon_s: np.ndarray,
    truth: np.ndarray,
    counted: np.ndarray,
    lead_s: float,
) -> None:
    found = score_lead(forecast(levels, horizon_s), lead_s, GRID, truth, counted)
    for score in found.values():
        assert score.brier is None or 0.0 <= score.brier <= 1.0
        assert 0 <= score.shade.both <= score.shade.either <= score.cells
    assert found[HorizonCells.ALL] == found[HorizonCells.WITHIN] + found[HorizonCells.BEYOND]
    assert found[HorizonCells.ALL].cells == counted.sum()
