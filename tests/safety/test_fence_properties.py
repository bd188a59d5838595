"""The rules about places and heights on random sites and paths."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.safety.fenced import (
    WIDE,
    airspace,
    asked,
    flier,
    goto,
    mission,
    region,
    square,
)

from recon.geo import Polygon
from recon.model.zone import Region
from recon.safety.rules.boundary import boundary

L_SHAPE = region((-50, -50), (400, -50), (400, 50), (50, 50), (50, 400), (-50, 400))


@given(
    seed=st.integers(0, 1_000_000),
    margin_m=st.floats(0.0, 20.0),
    shape=st.sampled_from([L_SHAPE, square(-50.0, -50.0, 400.0, 400.0)]),
)
def test_it_is_allowed_if_every_sample_of_the_path_is_inside(
    seed: int, margin_m: float, shape: Region
) -> None:
    points = np.random.default_rng(seed).uniform(-20.0, 350.0, (4, 2))
    body = mission(*((*point, 40.0) for point in points))
    air = airspace(boundary=shape, limits=replace(WIDE, boundary_margin_m=margin_m))
    way = np.concatenate([[(0.0, 0.0)], points])
    share = np.linspace(0.0, 1.0, 80)[:, np.newaxis]
    legs = np.concatenate([a + share * (b - a) for a, b in pairwise(way)])
    samples = np.concatenate([legs * factor for factor in np.linspace(0.0, 1.0, 40)])
    worst_m = float(Polygon(shape).distance_to_edge_m(samples).min())
    if asked(boundary, body, air) is None:
        assert worst_m >= margin_m - 0.01
    else:
        # Samples are at most 13 m apart: one is within 10 m of the worst place.
        assert worst_m <= margin_m + 10.0


@given(seed=st.integers(0, 1_000_000), by_m=st.floats(0.0, 60.0))
def test_a_narrower_boundary_allows_nothing_more(seed: int, by_m: float) -> None:
    """For a vehicle that is inside the narrower one: outside, only the way back in is open."""
    random = np.random.default_rng(seed)
    points = random.uniform(-60.0, 420.0, (3, 2))
    here = random.uniform(-40.0, 300.0, 2)
    assume(np.abs(here).max() < 250.0 - by_m)
    wide = square(-300.0, -300.0, 420.0, 420.0)
    narrow = square(-300.0 + by_m, -300.0 + by_m, 420.0 - by_m, 420.0 - by_m)
    state = flier(float(here[0]), float(here[1]))
    for body in (mission(*((*point, 40.0) for point in points)), goto(*points[0])):
        if asked(boundary, body, airspace(boundary=wide), state) is not None:
            assert asked(boundary, body, airspace(boundary=narrow), state) is not None
