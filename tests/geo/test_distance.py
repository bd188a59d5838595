"""Lengths that a scale bar shows."""

from math import floor, log10

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from recon.geo import round_length_m


@given(st.floats(1e-3, 1e6))
@example(999_999.9999999999)
def test_a_round_length_is_the_longest_that_fits(most_m: float) -> None:
    length_m = round_length_m(most_m)
    assert length_m <= most_m < 2.5 * length_m * (1.0 + 1e-9)
    digit = length_m / 10.0 ** floor(log10(length_m) + 1e-9)
    assert digit == pytest.approx(round(digit))
    assert round(digit) in (1, 2, 5)


@pytest.mark.parametrize(("most_m", "length_m"), [(1.0, 1.0), (4.9, 2.0), (70.0, 50.0), (0.2, 0.2)])
def test_round_lengths(most_m: float, length_m: float) -> None:
    assert round_length_m(most_m) == pytest.approx(length_m)
