"""The shortest list: each cell often enough, and the bound below every list."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from recon.product.choose import choose, views_for


def enough(shows: np.ndarray, photos, views: int) -> bool:
    needed = np.minimum(views, shows.sum(axis=0))
    return bool((shows[list(photos)].sum(axis=0) >= needed).all())


def fewest(shows: np.ndarray, views: int) -> int:
    every = range(len(shows))
    return next(
        n
        for n in range(len(shows) + 1)
        if any(enough(shows, each, views) for each in combinations(every, n))
    )


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 3))
def test_lists_are_complete_and_near_the_shortest(seed: int, views: int) -> None:
    random = np.random.default_rng(seed)
    shows = (random.random((9, 25)) < 0.3).astype(np.int32)
    found = choose(csr_array(shows), views)
    best = fewest(shows, views)
    assert enough(shows, found.photos, views)
    assert found.bound <= best <= len(found.photos) <= best + 1


def test_a_line_of_photos_keeps_every_third() -> None:
    shows = np.zeros((60, 62), dtype=np.int32)
    for number in range(60):
        shows[number, number : number + 3] = 1
    found = choose(csr_array(shows), 1)
    assert enough(shows, found.photos, 1)
    assert len(found.photos) <= 22
    assert found.bound == 21


def test_without_sun_nothing_is_chosen() -> None:
    found = choose(csr_array(np.zeros((4, 10), dtype=np.int32)), 6)
    assert (len(found.photos), found.bound) == (0, 0)


@pytest.mark.parametrize(("overlap", "views"), [(0.0, 1), (0.5, 4), (0.6, 6), (0.7, 11)])
def test_views_follow_from_the_overlap(overlap: float, views: int) -> None:
    assert views_for(overlap) == views
