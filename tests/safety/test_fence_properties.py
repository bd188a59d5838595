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
    height_zone,
    hills,
    keep_out_zone,
    mission,
    region,
    square,
)

from recon.geo import Polygon
from recon.model.airspace import FlightLimits, Region
from recon.safety.rules.boundary import boundary
from recon.safety.rules.height_zones import height_zones
from recon.safety.rules.home_distance import home_distance
from recon.safety.rules.keep_out import keep_out
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height
from recon.safety.rules.speed import speed

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
    path = np.concatenate([[(0.0, 0.0)], points])
    share = np.linspace(0.0, 1.0, 80)[:, np.newaxis]
    legs = np.concatenate([a + share * (b - a) for a, b in pairwise(path)])
    samples = np.concatenate([legs * factor for factor in np.linspace(0.0, 1.0, 40)])
    worst_m = float(Polygon(shape).distance_to_edge_m(samples).min())
    if asked(boundary, body, air) is None:
        assert worst_m >= margin_m - 0.01
    else:
        # Samples are at most 13 m apart: one is within 10 m of the worst place.
        assert worst_m <= margin_m + 10.0


@given(seed=st.integers(0, 1_000_000), by_m=st.floats(0.0, 60.0))
def test_a_narrower_boundary_allows_nothing_more(seed: int, by_m: float) -> None:
    """For a vehicle that is inside the narrower one: outside, only the path back in is open."""
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


@given(seed=st.integers(0, 1_000_000), by_m=st.floats(0.0, 60.0), grows_m=st.floats(0.0, 30.0))
def test_a_larger_or_higher_keep_out_zone_allows_nothing_more(
    seed: int, by_m: float, grows_m: float
) -> None:
    """For a vehicle that is clear of the larger one: inside, only the path out is open."""
    random = np.random.default_rng(seed)
    points = random.uniform(-150.0, 250.0, (3, 2))
    heights_m = random.uniform(20.0, 80.0, 3)
    small = keep_out_zone(square(100.0, -50.0, 200.0, 50.0), floor_m=20.0, ceiling_m=40.0)
    large = keep_out_zone(
        square(100.0 - by_m, -50.0 - by_m, 200.0 + by_m, 50.0 + by_m),
        floor_m=20.0 - grows_m,
        ceiling_m=40.0 + grows_m,
    )
    state = flier(0.0, 0.0, 60.0)
    body = mission(*zip(*points.T, heights_m, strict=True), curved=True, radius_m=20.0)
    for order in (body, goto(*points[0], float(heights_m[0]))):
        if asked(keep_out, order, airspace(small), state) is not None:
            assert asked(keep_out, order, airspace(large), state) is not None


@given(seed=st.integers(0, 1_000_000), by_m=st.floats(0.0, 60.0))
def test_a_narrower_height_zone_allows_nothing_more(seed: int, by_m: float) -> None:
    random = np.random.default_rng(seed)
    points = random.uniform(-150.0, 250.0, (3, 2))
    heights_m = random.uniform(10.0, 130.0, 3)
    region_m = square(60.0, -50.0, 200.0, 50.0)
    wide = height_zone(region_m, floor_m=20.0, ceiling_m=120.0)
    narrow = height_zone(region_m, floor_m=20.0 + by_m / 2.0, ceiling_m=120.0 - by_m / 2.0)
    body = mission(*zip(*points.T, heights_m, strict=True))
    if asked(height_zones, body, airspace(wide)) is not None:
        assert asked(height_zones, body, airspace(narrow)) is not None


@given(seed=st.integers(0, 1_000_000), by_m=st.floats(0.0, 40.0))
def test_tighter_limits_allow_nothing_more(seed: int, by_m: float) -> None:
    """For a vehicle that keeps the tighter ones now, over hills."""
    random = np.random.default_rng(seed)
    points = random.uniform(-350.0, 350.0, (3, 2))
    heights_m = random.uniform(10.0, 150.0, 3)
    ground = hills(random.uniform(-10.0, 10.0, (12, 12)))
    loose = FlightLimits(110.0, 10.0, 300.0, 10.0)
    tight = FlightLimits(110.0 - by_m / 2.0, 10.0 + by_m / 4.0, 300.0 - by_m, 10.0 - by_m / 8.0)
    state = flier(0.0, 0.0, 45.0, go_home_m=50.0)
    body = mission(*zip(*points.T, heights_m, strict=True), curved=True, radius_m=30.0)
    for rule in (max_height, min_height, home_distance, speed):
        for order in (body, goto(*points[0], float(heights_m[0]), 9.0)):
            if asked(rule, order, airspace(limits=loose, elevation=ground), state) is not None:
                tightened = airspace(limits=tight, elevation=ground)
                assert asked(rule, order, tightened, state) is not None


@given(seed=st.integers(0, 1_000_000))
def test_heights_above_ground_are_kept_at_every_sample_of_the_path(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = random.uniform(-350.0, 350.0, (3, 2))
    ground = hills(random.uniform(-10.0, 10.0, (12, 12)))
    air = airspace(limits=FlightLimits(60.0, 10.0, 900.0), elevation=ground)
    height_m = float(random.uniform(10.0, 60.0))
    body = mission(*((*point, height_m) for point in points))
    state = flier(0.0, 0.0, height_m, go_home_m=height_m)
    path = np.concatenate([[(0.0, 0.0)], points])
    share = np.linspace(0.0, 1.0, 60)[:, np.newaxis]
    legs = np.concatenate([a + share * (b - a) for a, b in pairwise(path)])
    samples = np.concatenate([legs * factor for factor in np.linspace(0.02, 1.0, 50)])
    far = samples[np.hypot(*samples.T) > 5.0]
    takeoff_m = float(air.ground_up_m(np.zeros((1, 2)))[0])
    above_m = takeoff_m + height_m - air.ground_up_m(far)
    if asked(min_height, body, air, state) is None:
        assert above_m.min() >= 10.0 - 1e-6
    else:
        assert above_m.min() <= 10.0 + 4.0  # the ground changes by less between samples
    if asked(max_height, body, air, state) is None:
        assert above_m.max() <= 60.0 + 1e-6
    else:
        assert above_m.max() >= 60.0 - 4.0
