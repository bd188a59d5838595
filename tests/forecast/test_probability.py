"""The probability over a time span, compared with a slow sum over moments."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import SunForecast
from recon.model.units import NS_PER_S

GRID = GroundGrid(LocalFrame(GeoPoint(44.5, -92.9, 320.0)), 0.0, 8.0, 4.0, 2, 3)
ISSUED_NS = 5 * NS_PER_S


def forecast(lead_s: list[float], seed: int = 0, prior: float = 0.4) -> SunForecast:
    shape = (len(lead_s), GRID.rows, GRID.cols)
    probability = np.random.default_rng(seed).integers(0, 256, shape, dtype=np.uint8)
    horizon_s = np.full(shape[1:], lead_s[-1], np.float32)
    leads = np.array(lead_s)
    return SunForecast(GRID, ISSUED_NS, leads, probability, horizon_s, prior, "drawn")


def at_moment(sun: SunForecast, row: int, col: int, at_s: float) -> float:
    """Return the probability of one cell at one moment, by definition."""
    if at_s > sun.lead_s[-1]:
        return sun.prior_sunlit
    return float(np.interp(at_s, sun.lead_s, sun.sun_probability[:, row, col] / 255.0))


moments = st.integers(-50_000, 900_000).map(lambda ms: ms / 1000.0)


@given(
    st.lists(st.integers(0, 600).map(float), min_size=1, max_size=8, unique=True),
    st.integers(0, 99),
    st.tuples(moments, moments).map(sorted),
)
def test_a_span_gives_the_mean_over_its_moments(
    leads: list[float], seed: int, span_s: list[float]
) -> None:
    sun = forecast(sorted(leads), seed)
    from_s, to_s = span_s
    cells = np.array([(row, col) for row in range(2) for col in range(3)])
    got = sun.probability_sunlit(
        cells, ISSUED_NS + round(from_s * NS_PER_S), ISSUED_NS + round(to_s * NS_PER_S)
    )
    middles_s = from_s + (np.arange(500) + 0.5) / 500 * (to_s - from_s)
    for (row, col), value in zip(cells, got, strict=True):
        slow = np.mean([at_moment(sun, row, col, s) for s in middles_s])
        # A jump to the prior within the span falls into one of the 500 slices.
        assert value == pytest.approx(slow, abs=3e-3)
        assert 0.0 <= value <= 1.0


def test_one_moment_is_interpolated_between_its_leads() -> None:
    sun = forecast([0.0, 30.0, 60.0])
    at_ns = ISSUED_NS + 40 * NS_PER_S
    (got,) = sun.probability_sunlit(np.array([[1, 2]]), at_ns, at_ns)
    at_30, at_60 = sun.sun_probability[1:, 1, 2] / 255.0
    assert got == pytest.approx(at_30 * 2 / 3 + at_60 / 3)


def test_each_cell_may_have_its_own_times() -> None:
    sun = forecast([0.0, 30.0, 60.0])
    cells = np.array([[0, 0], [1, 2], [0, 1]])
    from_ns = ISSUED_NS + np.array([0, 10, 50]) * NS_PER_S
    to_ns = from_ns + 15 * NS_PER_S
    together = sun.probability_sunlit(cells, from_ns, to_ns)
    alone = [
        sun.probability_sunlit(cells[i : i + 1], int(from_ns[i]), int(to_ns[i]))[0]
        for i in range(3)
    ]
    assert together == pytest.approx(alone)


def test_beyond_the_leads_and_the_grid_it_is_the_prior() -> None:
    sun = forecast([0.0, 30.0], prior=0.7)
    late_ns = ISSUED_NS + 31 * NS_PER_S
    cells = np.array([[0, 0], [1, 1]])
    assert sun.probability_sunlit(cells, late_ns, late_ns + NS_PER_S) == pytest.approx([0.7, 0.7])
    outside = np.array([[-1, 0], [0, -1], [2, 0], [0, 3]])
    assert sun.probability_sunlit(outside, ISSUED_NS, ISSUED_NS) == pytest.approx([0.7] * 4)


def test_a_span_that_ends_before_it_begins_is_an_error() -> None:
    with pytest.raises(ValueError, match="t1 <= t2"):
        forecast([0.0]).probability_sunlit(np.array([[0, 0]]), 2, 1)


@pytest.mark.parametrize("leads", [[], [-1.0, 0.0], [0.0, 0.0], [30.0, 0.0]])
def test_leads_that_do_not_rise_are_an_error(leads: list[float]) -> None:
    shape = (len(leads), GRID.rows, GRID.cols)
    with pytest.raises(ValueError, match="rising leads"):
        SunForecast(
            GRID, 0, np.array(leads), np.zeros(shape, np.uint8), np.zeros(shape[1:], np.float32),
            0.5, "drawn",
        )  # fmt: skip


def test_arrays_of_another_shape_are_an_error() -> None:
    with pytest.raises(ValueError, match=r"sun_probability: expected shape \(1, 2, 3\)"):
        SunForecast(
            GRID, 0, np.zeros(1), np.zeros((1, 3, 2), np.uint8), np.zeros((2, 3), np.float32),
            0.5, "drawn",
        )  # fmt: skip
