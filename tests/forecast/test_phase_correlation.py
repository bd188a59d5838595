"""Shifts of known size found again, and chance not taken for one."""

from dataclasses import dataclass

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import SEEN, drawn_velocity, noisy_map, shade_map

from recon.forecast import ForecastSettings
from recon.forecast.phase_correlation import agreement_between, between, spectrum_of
from recon.model.shade import ShadeMap

SETTINGS = ForecastSettings()


LEAST_CONTRAST, CLEAR = 0.08, 0.2


@dataclass(frozen=True)
class Shift:
    """Metres east and north to the highest agreement, and the share of phases that agree there."""

    east_m: float
    north_m: float
    peak: float

    @property
    def is_clear(self) -> bool:
        return self.peak >= CLEAR


def shift_of(before: ShadeMap, now: ShadeMap) -> Shift | None:
    spectra = [spectrum_of(each, SETTINGS, LEAST_CONTRAST) for each in (before, now)]
    agreement = agreement_between(*spectra, SETTINGS)
    if agreement is None:
        return None
    row, col = (int(i) for i in np.unravel_index(int(np.argmax(agreement)), agreement.shape))
    down = row - agreement.shape[0] // 2 + between(agreement[:, col], row)
    right = col - agreement.shape[1] // 2 + between(agreement[row], col)
    cell_m = before.grid.cell_m
    return Shift(right * cell_m, -down * cell_m, float(agreement[row, col]))


@pytest.mark.parametrize("gap_s", [10.0, 20.0])
def test_a_known_shift_is_found_to_a_fraction_of_a_cell(gap_s: float) -> None:
    errors_m, clear = [], []
    for seed in range(600, 620):
        velocity = drawn_velocity(seed)
        shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
        shift = shift_of(noisy_map(shade, 50.0), noisy_map(shade, 50.0 + gap_s))
        assert shift is not None
        clear.append(shift.is_clear)
        if clear[-1]:
            wrong_m = (shift.east_m - gap_s * velocity[0], shift.north_m - gap_s * velocity[1])
            errors_m.append(np.hypot(*wrong_m))
    assert np.mean(clear) >= 0.8, clear
    # Cells are of 4 m; whole-cell shifts would miss by 1.5 m on the mean.
    assert np.median(errors_m) < 1.5, errors_m
    assert max(errors_m) < 8.0, errors_m


def test_no_shift_without_motion() -> None:
    shade = DriftingShade(621, cover=0.4, velocity_mps=(0.0, 0.0))
    shift = shift_of(noisy_map(shade, 0.0), noisy_map(shade, 10.0))
    assert shift is not None
    assert shift.is_clear
    assert (shift.east_m, shift.north_m) == pytest.approx((0.0, 0.0), abs=0.8)


def test_the_edge_of_the_visible_area_is_not_taken_as_standing_shade() -> None:
    """A patch that moves in front of a footprint that does not."""
    shade = DriftingShade(622, cover=0.5, velocity_mps=(8.0, 0.0))
    narrow = SEEN & (np.arange(FIELD.rows) > 40)[:, np.newaxis]
    maps = [shade_map(shade.transmittance(FIELD, at_s), at_s, narrow) for at_s in (0.0, 10.0)]
    shift = shift_of(maps[0], maps[1])
    assert shift is not None
    assert (shift.east_m, shift.north_m) == pytest.approx((80.0, 0.0), abs=4.0)


def test_unrelated_maps_have_no_clear_shift() -> None:
    clear = []
    for seed in range(630, 660):
        before = noisy_map(DriftingShade(seed), 0.0)
        now = noisy_map(DriftingShade(seed + 1_000), 20.0)
        shift = shift_of(before, now)
        clear.append(shift is not None and shift.is_clear)
    assert np.mean(clear) < 0.1, clear


@pytest.mark.parametrize("level", [0.0, 0.7, 1.0])
def test_an_even_sky_has_no_shift(level: float) -> None:
    even = np.full(SEEN.shape, level)
    assert shift_of(shade_map(even, 0.0), shade_map(even, 10.0)) is None
    unseen = np.zeros_like(SEEN)
    assert shift_of(shade_map(even, 0.0, unseen), shade_map(even, 9.0)) is None


def test_maps_are_not_modified() -> None:
    maps: list[ShadeMap] = [noisy_map(DriftingShade(662), at_s) for at_s in (0.0, 10.0)]
    before = [(m.transmittance.copy(), m.valid.copy()) for m in maps]
    shift_of(maps[0], maps[1])
    for one, (transmittance, valid) in zip(maps, before, strict=True):
        assert np.array_equal(one.transmittance, transmittance, equal_nan=True)
        assert np.array_equal(one.valid, valid)
