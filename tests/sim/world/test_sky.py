"""The sky: the same in any order, drifting with its wind, covered as asked, with soft edges."""

from dataclasses import replace
from math import inf

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import j0
from tests.examples import examples

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.sim.errors import SimulationError
from recon.sim.world import (
    LayerSettings,
    Sky,
    SkySettings,
    SunSettings,
    WindShift,
    fractal_field,
)
from recon.sim.world.keyframes import gaussian
from recon.sim.world.layer import drift_m
from recon.sim.world.penumbra import extinction, penumbra

LOW = LayerSettings()
HIGH = LayerSettings(4_000.0, 14.0, 110.0, 0.3, softness=0.5)
STILL = replace(LOW, lifetime_s=inf, modulation=0.0)
PLACES = st.floats(-40_000.0, 40_000.0)
TIMES = st.floats(20_000.0, 20_400.0)
"""Some keyframes of each band, not all the day's."""


def sky(*layers: LayerSettings, seed: int = 4, sun: SunSettings | None = None) -> Sky:
    return Sky(SkySettings(seed, sun or SunSettings(), layers))


@settings(max_examples=examples(25), deadline=None)
@given(st.lists(st.tuples(PLACES, PLACES, TIMES), min_size=1, max_size=400))
def test_a_point_has_one_value_to_the_bit(points) -> None:
    east, north, time = np.array(points).T
    above = sky(LOW, HIGH)
    together = above.transmittance(east, north, time)
    backwards = above.transmittance(east[::-1], north[::-1], time[::-1])[::-1]
    assert np.array_equal(together, backwards)
    k = len(points) // 2
    assert above.transmittance(east[k], north[k], time[k]) == together[k]
    at_once = above.transmittance(east, north, float(time[k]))
    assert at_once[k] == together[k]


def test_a_new_sky_with_empty_caches_is_the_same(ground) -> None:
    first = sky(LOW, HIGH).transmittance(*ground, 1234.5)
    fractal_field.tile.cache_clear()
    assert np.array_equal(first, sky(LOW, HIGH).transmittance(*ground, 1234.5))
    assert not np.array_equal(first, sky(LOW, HIGH, seed=5).transmittance(*ground, 1234.5))


def test_the_number_of_threads_changes_nothing(ground) -> None:
    before = cv2.getNumThreads()
    found = []
    for threads in (1, 2):
        cv2.setNumThreads(threads)
        found.append(sky(LOW).transmittance(*ground, 50.0))
    cv2.setNumThreads(before)
    assert np.array_equal(*found)


def test_values_do_not_depend_on_the_number_of_points(ground) -> None:
    above = sky(LOW)
    east, north = (np.repeat(axis.ravel(), 7).reshape(7, -1) for axis in ground)
    assert np.array_equal(
        above.transmittance(east, north, 9.0)[3], above.transmittance(east[3], north[3], 9.0)
    )


@pytest.mark.parametrize("time_s", [1.0, 30.0, 600.0])
def test_a_frozen_sky_drifts_with_its_wind_and_the_sun(ground, noon, time_s) -> None:
    """The shadow goes where the cloud goes, and from the sun as that moves."""
    above = sky(STILL, sun=noon)
    east, north = ground
    now = above.transmittance(east, north, 0.0)
    moved_east, moved_north = (part[0] for part in drift_m(STILL, np.array([time_s])))
    (east_0, north_0), (east_1, north_1) = (sun_offset(above, t) for t in (0.0, time_s))
    later = above.transmittance(
        east + moved_east - (east_1 - east_0), north + moved_north - (north_1 - north_0), time_s
    )
    assert 0.1 < (now < 0.5).mean() < 0.9
    # All that changes is the penumbra's width, by a hundredth in ten minutes.
    assert np.abs(now - later).max() < 0.02
    assert np.abs(now - above.transmittance(east, north, 30.0)).max() > 0.2


def sun_offset(above: Sky, time_s: float) -> tuple[float, float]:
    edge = penumbra([above.sun_at(time_s)], above.settings.layers[0].base_height_m)
    offset_m = float(edge.offset_m[0])
    return offset_m * float(edge.toward_east[0]), offset_m * float(edge.toward_north[0])


def test_a_shadow_lies_away_from_the_sun_by_height_over_tangent(noon, ground) -> None:
    """A layer twice as high shades what lies twice as far from under the cloud."""
    above = sky(replace(STILL, finest_scale_m=700.0), sun=noon)
    doubled = sky(replace(STILL, finest_scale_m=700.0, base_height_m=2_800.0), sun=noon)
    sun = above.sun_at(0.0)
    away_m = 1_400.0 / np.tan(np.radians(sun.elevation_deg))
    azimuth = np.radians(sun.azimuth_deg)
    east, north = ground
    one = above.transmittance(east, north, 0.0)
    two = doubled.transmittance(
        east - away_m * np.sin(azimuth), north - away_m * np.cos(azimuth), 0.0
    )
    assert away_m > 300.0
    # The higher layer's penumbra is wider, nothing else differs.
    assert np.abs(one - two).max() < 0.1
    assert np.abs(one - doubled.transmittance(east, north, 0.0)).max() > 0.5


def test_a_wind_shift_turns_the_drift_evenly() -> None:
    shifted = replace(LOW, speed_mps=10.0, heading_deg=90.0, shifts=(WindShift(100, 60, 6.0, 0.0),))
    east, north = drift_m(shifted, np.array([100.0, 130.0, 160.0, 260.0]))
    assert east == pytest.approx([1000.0, 1225.0, 1300.0, 1300.0])
    assert north == pytest.approx([0.0, 45.0, 180.0, 780.0])


def test_clouds_change_with_time_the_small_ones_first() -> None:
    """Each band's correlation with itself has fallen to 1/e after its lifetime."""
    fractal = sky(LOW).layers[0].field
    x, y = (np.random.default_rng(0).uniform(0.0, 90_000.0, 4_000) for _ in range(2))
    lifetimes = [band.lifetime_s for band in fractal.bands]
    assert lifetimes == sorted(lifetimes, reverse=True)
    for band in fractal.bands:
        assert band.lifetime_s == pytest.approx(900.0 * (band.scale_m / 1000.0) ** (2 / 3))
    last = replace(fractal, finest_scale_m=fractal.outer_scale_m)
    products = []
    for start_s in np.arange(0.0, 40.0) * 3_331.0:
        now, later = (
            last.sample(x, y, np.array([t]), np.zeros(1)).value
            for t in (start_s, start_s + last.bands[0].lifetime_s)
        )
        products.append(float((now * later).mean()))
    assert np.mean(products) == pytest.approx(np.exp(-1.0), abs=0.06)


def test_the_field_is_gaussian_of_unit_deviation_with_its_slope() -> None:
    """Differences over some distances are those of the spectrum that was asked for."""
    fractal = sky(LOW).layers[0].field
    rng = np.random.default_rng(1)
    values, steps = [], {100.0: [], 400.0: [], 1_600.0: [], 6_400.0: []}
    for start_s in np.arange(20.0) * 9_000.0:
        x, y = (rng.uniform(0.0, 90_000.0, 4_000) for _ in range(2))
        time, blur = np.array([start_s]), np.zeros(1)
        here = fractal.sample(x, y, time, blur).value
        values.append(here)
        for step_m, found in steps.items():
            found.append(fractal.sample(x + step_m, y, time, blur).value - here)
    whole = np.concatenate(values)
    assert whole.mean() == pytest.approx(0.0, abs=0.05)
    assert whole.std() == pytest.approx(1.0, abs=0.05)
    assert (np.abs(whole) > 1.0).mean() == pytest.approx(0.317, abs=0.03)
    truth = [difference_deviation(step_m, 3.4, 12_000.0) for step_m in steps]
    deviations = [float(np.std(found)) for found in steps.values()]
    assert deviations == pytest.approx(truth, rel=0.06)


def difference_deviation(step_m: float, slope: float, outer_m: float) -> float:
    """Return the deviation of differences: 2 (1 - J0(k r)), averaged over the spectrum."""
    waves = np.geomspace(1e-3, 400.0, 40_000) / outer_m
    power = (1.0 + (waves * outer_m) ** 2) ** (-0.5 * slope) * waves**2
    uneven = 2.0 * (1.0 - j0(2.0 * np.pi * waves * step_m))
    return float(np.sqrt((power * uneven).sum() / power.sum()))


def test_the_fields_slopes_are_its_differences() -> None:
    fractal = sky(LOW).layers[0].field
    x, y = (np.random.default_rng(k).uniform(0.0, 9_000.0, 2_000) for k in range(2))
    time, blur = np.array([77.0]), np.array([30.0**2])
    found = fractal.sample(x, y, time, blur)
    for axis, slope in enumerate((found.slope_x_per_m, found.slope_y_per_m)):
        forth, back = (
            fractal.sample(x + s * (axis == 0), y + s * (axis == 1), time, blur).value
            for s in (2.0, -2.0)
        )
        assert np.corrcoef(slope, forth - back)[0, 1] > 0.98
        assert np.std((forth - back) / 4.0) == pytest.approx(np.std(slope), rel=0.06)


def test_cover_has_its_configured_mean_over_many_skies() -> None:
    east = np.arange(400.0) * 7_001.0
    covers = (0.1, 0.3, 0.6, 0.9)
    shares = np.zeros((24, len(covers)))
    for seed, k in np.ndindex(shares.shape):
        above = sky(replace(LOW, cover=covers[k], finest_scale_m=1_000.0), seed=seed)
        shares[seed, k] = (above.transmittance(east, 2.0 * east, 5_000.0) < 0.5).mean()
    error = shares.std(axis=0) / np.sqrt(len(shares))
    assert np.all(np.abs(shares.mean(axis=0) - covers) < 3.5 * error + 0.01)
    assert error.max() < 0.07


def test_no_clouds_and_nothing_but_clouds(ground) -> None:
    assert np.all(sky().transmittance(*ground, 0.0) == 1.0)
    assert np.all(sky(replace(LOW, cover=0.0)).transmittance(*ground, 0.0) == 1.0)
    assert sky(replace(LOW, cover=1.0)).transmittance(*ground, 0.0).max() < 1e-6


def test_thin_cirrus_dims_and_never_shades(ground) -> None:
    cirrus = replace(HIGH, base_height_m=9_000.0, cover=0.7, largest_optical_depth=0.4)
    found = sky(cirrus).transmittance(*ground, 300.0)
    assert found.min() >= np.exp(-0.4) - 1e-4
    assert found.min() < 0.8


def test_two_layers_multiply(ground) -> None:
    both = sky(LOW, HIGH).transmittance(*ground, 60.0)
    low = sky(LOW).transmittance(*ground, 60.0)
    assert np.all(both <= low + 1e-6)
    assert (both < low - 0.1).mean() > 0.02


def test_the_threshold_varies_slowly() -> None:
    """Unit deviation over long times, and hardly any change within a minute."""
    times = np.arange(0.0, 4_000_000.0, 600.0)
    wandering = gaussian((3, 0, 1), times, 2_400.0)
    assert wandering.std() == pytest.approx(1.0, abs=0.1)
    assert np.abs(gaussian((3, 0, 1), times + 60.0, 2_400.0) - wandering).max() < 0.25


def test_a_grid_has_its_cells_centres() -> None:
    grid = GroundGrid(LocalFrame(GeoPoint(42.0, -93.0, 250.0)), -300.0, 200.0, 10.0, 40, 60)
    above = sky(LOW)
    found = above.on_grid(grid, 90.0)
    assert found.shape == (40, 60)
    assert found[0, 0] == above.transmittance(-295.0, 195.0, 90.0)
    assert found[39, 59] == above.transmittance(295.0, -195.0, 90.0)


def test_the_beam_weakens_with_the_field() -> None:
    excess = np.linspace(-12.0, 12.0, 200)
    for depth in (0.3, 5.0, 20.0):
        share = extinction(excess, depth)
        assert np.all(np.diff(share) <= 0.0)
        assert share[0] > 0.999
        assert share[-1] == pytest.approx(np.exp(-depth), abs=1e-3)
    assert extinction(np.zeros(1), 20.0)[0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"cover": 1.2}, "cover: expected 0 to 1, got 1.2"),
        ({"base_height_m": float("nan")}, "base_height_m: expected 50 to 15000, got nan"),
        ({"finest_scale_m": 20_000.0}, "finest_scale_m: expected 10 to 12000"),
        ({"lifetime_s": 0.0}, "lifetime_s: expected 1 to inf, got 0"),
    ],
)
def test_invalid_settings_are_refused(change, expected) -> None:
    with pytest.raises(SimulationError, match=expected):
        replace(LOW, **change)


def test_shifts_in_disorder_and_three_layers_are_refused() -> None:
    with pytest.raises(SimulationError, match="each after the end of the one before"):
        replace(LOW, shifts=(WindShift(100, 60, 6.0, 0.0), WindShift(120, 60, 6.0, 0.0)))
    with pytest.raises(SimulationError, match="at most two layers, got 3"):
        SkySettings(layers=(LOW, LOW, HIGH))
