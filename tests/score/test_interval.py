"""Means, ratios and cut-off times, checked by hand and for every order of the runs."""

from math import inf, isinf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.score.interval import interval, probability_at_most, ratio, times

values = st.lists(st.one_of(st.none(), st.floats(0.0, 1e6)), min_size=1, max_size=12)
pairs = st.lists(st.tuples(st.integers(0, 50), st.integers(0, 50)), min_size=1, max_size=8)


def test_a_mean_of_four_by_students_t() -> None:
    found = interval([1.0, 2.0, 3.0, 4.0, None])
    assert found is not None
    # t of 3 degrees of freedom is 3.182; the deviation of 1..4 is 1.291.
    assert (found.mean, found.count) == (2.5, 4)
    assert found.high - found.mean == pytest.approx(3.182 * 1.291 / 2.0, abs=0.002)
    assert found.mean - found.low == pytest.approx(found.high - found.mean)


def test_one_run_has_no_bounds_and_none_no_figure() -> None:
    alone = interval([7.0])
    assert alone is not None
    assert (alone.low, alone.mean, alone.high) == (-inf, 7.0, inf)
    assert interval([None, None]) is None
    assert times([], 60.0) is None
    assert ratio([(0.0, 0.0)]) is None


def test_the_interval_holds_the_mean_at_its_confidence() -> None:
    rng = np.random.default_rng(1)
    held = 0
    for _ in range(2_000):
        found = interval(rng.normal(3.0, 2.0, 6).tolist())
        assert found is not None
        held += found.low <= 3.0 <= found.high
    assert 0.93 < held / 2_000 < 0.97


def test_the_probability_of_what_never_happened_is_about_three_in_all_trials() -> None:
    # (1 - p)^n = 0.05, exactly.
    assert probability_at_most(0, 300) == pytest.approx(1.0 - 0.05 ** (1.0 / 300.0), rel=1e-9)
    assert probability_at_most(1, 300) > probability_at_most(0, 300)
    assert probability_at_most(0, 0) == probability_at_most(5, 5) == 1.0


def test_a_ratio_is_of_the_sums() -> None:
    found = ratio([(1.0, 2.0), (9.0, 10.0), (0.0, 0.0)])
    assert found is not None
    assert found.mean == pytest.approx(10.0 / 12.0)
    assert (found.low, found.high, found.count) == (0.5, 0.9, 2)


def test_cut_off_times_count_as_the_limit_and_are_counted() -> None:
    found = times([100.0, None, 300.0, None, 900.0], 600.0)
    assert found is not None
    assert (found.reached, found.count) == (2, 5)
    assert found.mean.mean == pytest.approx((100.0 + 300.0 + 3 * 600.0) / 5.0)
    assert isinf(found.median_s)


def test_the_median_is_known_while_most_came() -> None:
    found = times([100.0, 200.0, None], 600.0)
    assert found is not None
    assert found.median_s == 200.0


@given(values, st.randoms(use_true_random=False))
def test_the_order_of_the_runs_changes_no_bit(
    given_values: list[float | None], rng: object
) -> None:
    shuffled = list(given_values)
    rng.shuffle(shuffled)  # type: ignore[attr-defined]
    assert interval(shuffled) == interval(given_values)
    assert times(shuffled, 500.0) == times(given_values, 500.0)


@given(pairs, st.randoms(use_true_random=False))
def test_nor_does_it_of_ratios(parts: list[tuple[int, int]], rng: object) -> None:
    parts = [(min(a, b), b) for a, b in parts]
    shuffled = list(parts)
    rng.shuffle(shuffled)  # type: ignore[attr-defined]
    found = ratio(parts)
    assert ratio(shuffled) == found
    assert found is None or found.count == 1 or 0.0 <= found.low <= found.high <= 1.0


@given(values)
def test_the_mean_lies_within_its_interval_and_its_values(
    given_values: list[float | None],
) -> None:
    found = interval(given_values)
    there = [value for value in given_values if value is not None]
    assert (found is None) == (not there)
    if found is not None:
        slack = 1e-9 * max(there) + 1e-12
        assert min(there) - slack <= found.mean <= max(there) + slack
        assert found.low <= found.mean <= found.high
