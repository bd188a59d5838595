"""Soft edges: as wide as the sun's disk makes them, and close to the true average over the disk."""

from dataclasses import replace
from math import inf, radians, sin

import numpy as np
import pytest

from recon.geo.sun import SunPosition
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.sim.world.fractal_field import FieldSample, disk_weight
from recon.sim.world.penumbra import (
    EXCESS_STEP,
    MOST_EXCESS,
    extinction,
    extinction_table,
    look_up,
    penumbra,
    spread,
)


@pytest.mark.parametrize("elevation_deg", [12.0, 35.0, 70.0])
@pytest.mark.parametrize("height_m", [800.0, 1_500.0, 5_000.0])
def test_the_ellipse_has_the_suns_width(height_m, elevation_deg) -> None:
    edge = penumbra([SunPosition(130.0, elevation_deg, 1.0)], height_m)
    assert edge.across_m[0] == pytest.approx(0.0093 * height_m / sin(radians(elevation_deg)))
    assert edge.along_m[0] == pytest.approx(0.0093 * height_m / sin(radians(elevation_deg)) ** 2)


@pytest.mark.parametrize("along", [True, False])
def test_a_sharp_straight_edge_becomes_as_wide_as_the_ellipse(along) -> None:
    """A field that rises along (or across) the sun's azimuth, with next to no softness."""
    sun = SunPosition(0.0, 40.0, 1.0)
    edge = penumbra([sun], 1_500.0)
    width_m = float((edge.along_m if along else edge.across_m)[0])
    softness, rise_per_m = 0.01, 0.006
    place_m = np.arange(-40.0, 40.0, 0.25)
    zero = np.zeros(place_m.size, dtype=np.float32)
    rise = np.full(place_m.size, rise_per_m, dtype=np.float32)
    field = FieldSample(zero, zero if along else rise, rise if along else zero)
    spreads = spread(edge, 0.0, field) / np.float32(softness)
    excess = (place_m * rise_per_m / softness).astype(np.float32)
    share = look_up(extinction_table(20.0), excess[np.newaxis], spreads[np.newaxis])[0]
    lit = np.flatnonzero(share > 0.8)[-1]
    dark = np.flatnonzero(share < 0.2)[0]
    # Between a fifth and four fifths of a disk's area lie 49 % of its diameter.
    assert place_m[dark] - place_m[lit] == pytest.approx(0.49 * width_m, rel=0.1)
    assert np.all(np.diff(share) <= 1e-6)


def test_the_axes_may_be_turned() -> None:
    """The spread of a field does not depend on its axes."""
    edge = penumbra([SunPosition(75.0, 30.0, 1.0)], 2_000.0)
    east, north = 0.002, -0.003
    found = []
    for axes_rad in (0.0, 0.7, 3.0):
        x = east * np.cos(axes_rad) - north * np.sin(axes_rad)
        y = east * np.sin(axes_rad) + north * np.cos(axes_rad)
        slopes = (np.array([v], dtype=np.float32) for v in (0.0, x, y))
        found.append(float(spread(edge, axes_rad, FieldSample(*slopes))[0]))
    assert found == pytest.approx([found[0]] * 3, rel=1e-5)


def test_the_table_averages_over_the_disk() -> None:
    table = extinction_table(20.0)
    angles, radii = np.meshgrid(np.linspace(0, 2 * np.pi, 721)[:-1], (np.arange(400) + 0.5) / 400)
    offsets, areas = radii * np.cos(angles), radii
    for excess, wide in ((-2.0, 1.0), (0.0, 3.0), (1.5, 6.0)):
        truth = float((extinction(excess + wide * offsets, 20.0) * areas).sum() / areas.sum())
        row = round((excess + MOST_EXCESS) / EXCESS_STEP)
        assert table[row, round(wide / 0.1)] == pytest.approx(truth, abs=2e-3)


def test_a_wave_averaged_over_a_disk_keeps_its_weight() -> None:
    angles, radii = np.meshgrid(np.linspace(0, 2 * np.pi, 721)[:-1], (np.arange(400) + 0.5) / 400)
    for wave_m, diameter_m in ((100.0, 20.0), (50.0, 30.0), (30.0, 30.0)):
        place_m = 0.5 * diameter_m * radii * np.cos(angles)
        truth = float((np.cos(2 * np.pi * place_m / wave_m) * radii).sum() / radii.sum())
        assert disk_weight(wave_m, np.array([diameter_m**2]))[0] == pytest.approx(truth, abs=0.01)
    assert disk_weight(20.0, np.array([40.0**2]))[0] == 0.0


def test_the_soft_sky_is_close_to_the_hard_one_averaged_over_the_disk(noon) -> None:
    """The same clouds, first lit by a point, then by the whole sun: brute force over its disk."""
    layer = LayerSettings(4_000.0, softness=0.1, lifetime_s=inf, modulation=0.0)
    soft = Sky(SkySettings(8, noon, (layer,)))
    edge = penumbra([soft.sun_at(0.0)], layer.base_height_m)
    point = replace(edge, across_m=np.zeros(1), along_m=np.zeros(1))
    rng = np.random.default_rng(2)
    east, north = rng.uniform(-40_000.0, 40_000.0, (2, 3_000))
    cloud = soft.layers[0]
    total = np.zeros(east.size)
    for along, across in disk(64):
        toward = along * edge.along_m / 2.0
        aside = across * edge.across_m / 2.0
        shift_east = toward * edge.toward_east + aside * edge.toward_north
        shift_north = toward * edge.toward_north - aside * edge.toward_east
        total += cloud.transmittance(east + shift_east, north + shift_north, np.zeros(1), point)
    error = soft.transmittance(east, north, 0.0) - total / 64
    assert ((total > 6.4) & (total < 57.6)).mean() > 0.1
    assert np.sqrt((error**2).mean()) < 0.02
    hard = cloud.transmittance(east, north, np.zeros(1), point) - total / 64
    assert np.sqrt((error**2).mean()) < 0.75 * np.sqrt((hard**2).mean())


def disk(count: int) -> np.ndarray:
    """Return points spread evenly over the unit disk (sunflower)."""
    radii = np.sqrt((np.arange(count) + 0.5) / count)
    angles = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
