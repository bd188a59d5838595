"""How near pairs come: gaps and closeness at each moment, and which pairs can be excluded."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.safety.prediction.trajectory import Samples
from recon.safety.separation_minima import SeparationMinima
from recon.safety.watchdogs.closest_approach import Approach, Gaps, approach, closeness, near_pairs

NEED = SeparationMinima(10.0, 5.0)
FIRST, SECOND = np.array([0]), np.array([1])

Cylinder = tuple[float, float, float, float, float]
"""East, north, low, high and radius."""


def samples(*paths: list[Cylinder]) -> Samples:
    """Vehicles at their moments."""
    return Samples(*np.array(paths, dtype=np.float64).transpose(2, 0, 1))


def gaps(
    one: Cylinder, other: Cylinder, *, is_height_known: bool = True
) -> tuple[float, float, float]:
    """Closeness, horizontal and vertical gap, which are the same both ways round."""
    unknown = None if is_height_known else ~np.eye(2, dtype=np.bool_)
    there, back = (
        tuple(
            float(value[0, 0])
            for value in closeness(
                samples([a], [b]), FIRST, samples([a], [b]), SECOND, NEED, unknown
            )
        )
        for a, b in ((one, other), (other, one))
    )
    assert there == back
    return there[0], there[1], there[2]


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ((130.0, 240.0, 52.0, 57.0, 3.0), (4.5, 45.0, 2.0)),
        ((130.0, 240.0, 150.0, 160.0, 3.0), (20.0, 45.0, 100.0)),
        ((106.0, 208.0, 54.0, 57.0, 3.0), (0.8, 5.0, 4.0)),
        ((106.0, 208.0, 34.0, 36.0, 3.0), (0.8, 5.0, 4.0)),
        ((106.0, 208.0, 45.0, 57.0, 3.0), (0.5, 5.0, -5.0)),
        ((106.0, 208.0, 54.0, 57.0, 18.0), (0.7, -10.0, 4.0)),
        ((106.0, 208.0, 55.0, 57.0, 18.0), (1.0, -10.0, 5.0)),
    ],
)
def test_closeness_is_the_larger_share_and_less_the_deeper_in_a_circle(
    other: Cylinder, expected: tuple[float, float, float]
) -> None:
    assert gaps((100.0, 200.0, 40.0, 50.0, 2.0), other) == pytest.approx(expected)


@pytest.mark.parametrize(("up_m", "gap_m"), [(90.0, 0.0), (44.0, -4.0)])
def test_heights_that_cannot_be_compared_leave_no_gap_in_height(up_m: float, gap_m: float) -> None:
    one, other = (0.0, 0.0, 40.0, 50.0, 0.0), (8.0, 0.0, up_m, up_m, 0.0)
    assert gaps(one, other, is_height_known=False) == pytest.approx((0.8, 8.0, gap_m))


def test_only_pairs_with_incomparable_heights_lose_their_gap_in_height() -> None:
    stacked = samples(*([(0.0, 0.0, up_m, up_m, 0.0)] for up_m in (0.0, 20.0, 50.0)))
    unknown = np.zeros((3, 3), dtype=np.bool_)
    unknown[0, 2] = unknown[2, 0] = True
    first, second = near_pairs(stacked, NEED, unknown)
    assert [*zip(first, second, strict=True)] == [(0, 2)]
    every = np.array([0, 0, 1]), np.array([1, 2, 2])
    _, _, vertical_m = closeness(stacked, every[0], stacked, every[1], NEED, unknown)
    assert vertical_m[:, 0].tolist() == [20.0, 0.0, 30.0]


class TestPairsThatAreNear:
    """A flies 30 m east and back to 10 m within heights of 40 to 50 m; B stands, 2 m wide."""

    WAY: tuple[Cylinder, ...] = (
        (0.0, 0.0, 40.0, 41.0, 0.0),
        (30.0, 0.0, 42.0, 50.0, 1.0),
        (10.0, 0.0, 44.0, 45.0, 3.0),
    )

    @pytest.mark.parametrize(
        ("east_m", "north_m", "low_m", "high_m", "is_near"),
        [
            (44.9, 0.0, 40.0, 40.0, True),
            (45.0, 0.0, 40.0, 40.0, False),
            (-44.9, 0.0, 40.0, 40.0, True),
            (0.0, 44.9, 40.0, 40.0, True),
            (0.0, -45.1, 40.0, 40.0, False),
            (0.0, 0.0, 54.9, 60.0, True),
            (0.0, 0.0, 55.0, 60.0, False),
            (0.0, 0.0, 30.0, 35.1, True),
            (0.0, 0.0, 30.0, 35.0, False),
        ],
    )
    def test_reach_is_the_farthest_place_and_the_largest_radius(
        self, east_m: float, north_m: float, low_m: float, high_m: float, is_near: bool
    ) -> None:
        stands = [(east_m, north_m, low_m, high_m, 2.0)] * 3
        for paths in ([[*self.WAY], stands], [stands, [*self.WAY]]):
            first, second = near_pairs(samples(*paths), NEED)
            assert [*zip(first, second, strict=True)] == ([(0, 1)] if is_near else [])

    def test_reach_counts_from_where_each_one_is(self) -> None:
        """Each flies 30 m north and 40 m east from 500 m off the origin, 109 m beside the other."""
        paths = [
            [(east_m, 500.0, 40.0, 40.0, 0.0), (east_m + 40.0, 530.0, 40.0, 40.0, 0.0)]
            for east_m in (500.0, 609.0)
        ]
        assert len(near_pairs(samples(*paths), NEED)[0]) == 1
        paths[1] = [(611.0, 500.0, 40.0, 40.0, 0.0), (651.0, 530.0, 40.0, 40.0, 0.0)]
        assert len(near_pairs(samples(*paths), NEED)[0]) == 0


places = st.tuples(
    *[st.floats(-40.0, 40.0)] * 2, st.floats(0.0, 30.0), st.floats(0.0, 5.0), st.floats(0.0, 5.0)
).map(lambda at: (at[0], at[1], at[2], at[2] + at[3], at[4]))


@given(st.lists(st.lists(places, min_size=3, max_size=3), min_size=2, max_size=4))
def test_no_pair_that_comes_too_near_is_excluded(paths: list[list[Cylinder]]) -> None:
    ahead = samples(*paths)
    first, second = np.triu_indices(len(paths), k=1)
    close, _, _ = closeness(ahead, first, ahead, second, NEED)
    too_near = {
        (int(a), int(b))
        for a, b, is_near in zip(first, second, (close < 1.0).any(axis=1), strict=True)
        if is_near
    }
    assert too_near <= {(int(a), int(b)) for a, b in zip(*near_pairs(ahead, NEED), strict=True)}


def test_an_approach_has_the_first_moment_and_the_nearest_one() -> None:
    times_s = np.array([0.0, 0.5, 1.0, 1.5])
    close, far_m = np.array([2.0, 0.9, 0.4, 0.8]), np.array([20.0, 9.0, 4.0, 8.0])
    up_m = np.array([-9.0, 3.0, 2.0, 1.0])
    gaps = Gaps(
        np.array([close, close, close + 0.6]),
        np.array([far_m, -far_m, far_m]),
        np.array([up_m, -up_m, up_m]),
    )
    assert approach(gaps, 0, times_s) == Approach(0.5, 0.4, 4.0, 2.0, 1.0)
    assert approach(gaps, 1, times_s) == Approach(0.5, 0.4, 0.0, 0.0, -3.0)
    assert approach(gaps, 2, times_s) == Approach(None, 1.0, 4.0, 2.0, inf)
