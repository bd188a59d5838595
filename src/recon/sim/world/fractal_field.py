"""An evolving fractal Gaussian field on the plane: any place at any time, in any order.

Bands of noise, each two octaves finer than the one before and made of periodic tiles of 8 waves, so
that the sum repeats after 8 times the outer scale (96 km by default). Each band changes over its
own lifetime. All operations act on single points and round the same whatever is asked beside them:
same place and time, same bits.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import log

import cv2
import numpy as np
import numpy.typing as npt
from scipy.fft import irfft2

from recon.sim.noise import FloatImage
from recon.sim.world.keyframes import FloatArray, blend, generator, phase

BAND_RATIO = 4.0
TILE_CELLS = 256
CELLS_PER_WAVE = 32.0
"""At a band's middle; its shortest waves have 8 cells, its strongest 16 and more."""
PADDING = 2
"""Columns and rows repeated at a tile's end, so that no point lies between its two edges."""
ROW_POINTS = 256
"""Points are sampled in rows of this many, the last one filled up: all go the same way."""
FIRST_ZERO_SQUARED = 3.8317**2
TILES_KEPT = 64
"""A megabyte each; two layers of five bands need 20 at any moment."""


@dataclass(frozen=True, slots=True)
class Band:
    """One band of a field: waves around `scale_m`, of deviation `strength`."""

    stream: tuple[int, ...]
    scale_m: float
    outer_share: float
    """Its scale over the field's outer scale."""
    strength: float
    lifetime_s: float
    slope: float


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """The field and its gradient per metre along the field's own axes, (N,) float32 each."""

    value: FloatImage
    slope_x_per_m: FloatImage
    slope_y_per_m: FloatImage


@dataclass(frozen=True)
class FractalField:
    """Mean 0, deviation 1; power falls with wave number to the power `-slope`."""

    stream: tuple[int, ...]
    slope: float
    outer_scale_m: float
    finest_scale_m: float
    lifetime_s: float
    """Of structures of 1 km."""
    lifetime_exponent: float

    @cached_property
    def bands(self) -> tuple[Band, ...]:
        """From the outer scale down; the last one's middle is the first below twice the finest."""
        octaves = log(self.outer_scale_m / self.finest_scale_m, BAND_RATIO)
        shares = [BAND_RATIO**-k for k in range(int(octaves + 0.5) + 1)]
        powers = [
            (share * self.outer_scale_m) ** (self.slope - 2.0)
            * _wave_power(self.slope, share).sum()
            for share in shares
        ]
        return tuple(
            self._band(k, share, float(power / sum(powers)) ** 0.5)
            for k, (share, power) in enumerate(zip(shares, powers, strict=True))
        )

    def _band(self, number: int, share: float, strength: float) -> Band:
        scale_m = share * self.outer_scale_m
        lifetime_s = self.lifetime_s * (scale_m / 1000.0) ** self.lifetime_exponent
        return Band((*self.stream, number), scale_m, share, strength, lifetime_s, self.slope)

    @property
    def period_m(self) -> float:
        """After which the field repeats along its axes."""
        return self.outer_scale_m * TILE_CELLS / CELLS_PER_WAVE

    def sample(
        self, x_m: FloatArray, y_m: FloatArray, time_s: FloatArray, blur_m2: FloatArray
    ) -> Sample:
        """Return the field at N points; times and blurs are (N,) or (1,).

        Waves are weakened as by a disk of diameter squared `blur_m2`: those much longer not at all.
        """
        total = np.zeros((_rows(x_m.size), ROW_POINTS, 4), dtype=np.float32)
        x_tiles, y_tiles = x_m / self.period_m, y_m / self.period_m
        for band in self.bands:
            x_tiles, y_tiles = _within_tile(x_tiles), _within_tile(y_tiles)
            weight = band.strength * disk_weight(band.scale_m, blur_m2)
            _add_band(total, band, weight, _cells(x_tiles), _cells(y_tiles), time_s)
            x_tiles *= BAND_RATIO
            y_tiles *= BAND_RATIO
        points = total.reshape(-1, 4)[: x_m.size]
        return Sample(points[:, 0], points[:, 1], points[:, 2])


def disk_weight(wave_m: float, blur_m2: FloatArray) -> FloatArray:
    """Return what is left of a wave averaged over disks of diameter squared `blur_m2`.

    That is 2 J1(x) / x of x = pi diameter / wave, by its series up to its first zero, then nothing.
    """
    y = np.minimum(np.pi * np.pi * blur_m2 / (wave_m * wave_m), FIRST_ZERO_SQUARED)
    series = 1.0 - y * (1.0 / 8.0 - y * (1.0 / 192.0 - y * (1.0 / 9216.0 - y / 737280.0)))
    return np.where(y < FIRST_ZERO_SQUARED, series, 0.0)


def _add_band(
    total: FloatImage,
    band: Band,
    weight: FloatArray,
    cols: FloatImage,
    rows: FloatImage,
    time_s: FloatArray,
) -> None:
    """Add value and slopes of one band at N points to rows (R, ROW_POINTS, 4)."""
    blended = blend(time_s, band.lifetime_s, phase(band.stream))
    numbers = np.unique(blended.number)
    for step, share in enumerate((blended.share, blended.next_share)):
        if numbers.size == 1:
            found = _remap(band, int(numbers[0]) + step, cols, rows)
        else:
            found = _remap_each(band, blended.number + step, cols, rows)
        found *= _by_rows(weight * share)
        total += found


def _remap_each(
    band: Band, number: npt.NDArray[np.int64], cols: FloatImage, rows: FloatImage
) -> FloatImage:
    """Sample each point from the keyframe of its own number (N,)."""
    flat_cols, flat_rows = cols.ravel(), rows.ravel()
    found = np.zeros((flat_cols.size, 4), dtype=np.float32)
    for one in np.unique(number):
        places = np.flatnonzero(number == one)
        part = [_filled(values[places]) for values in (flat_cols, flat_rows)]
        found[places] = _remap(band, int(one), *part).reshape(-1, 4)[: places.size]
    return found.reshape(*cols.shape, 4)


def _remap(band: Band, number: int, cols: FloatImage, rows: FloatImage) -> FloatImage:
    tile = _tile(band, number)
    found = cv2.remap(tile, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return found.astype(np.float32, copy=False)


def _within_tile(tiles: FloatArray) -> FloatArray:
    """Return the part of a tile beyond the last whole one: no digit is lost by this."""
    return tiles - np.floor(tiles)


def _cells(tiles: FloatArray) -> FloatImage:
    """Return places within the tile in cells, by rows."""
    return _filled((tiles * TILE_CELLS).astype(np.float32))


def _rows(count: int) -> int:
    return -(-count // ROW_POINTS)


def _filled(values: FloatImage) -> FloatImage:
    """Return (N,) values as full rows, zeros at the end."""
    full = np.zeros(_rows(values.size) * ROW_POINTS, dtype=np.float32)
    full[: values.size] = values
    return full.reshape(-1, ROW_POINTS)


def _by_rows(share: FloatArray) -> FloatImage:
    """Return shares, (N,) or (1,), so that they multiply rows of four channels."""
    if share.size == 1:
        return share.astype(np.float32).reshape(1, 1, 1)
    return _filled(share.astype(np.float32))[:, :, np.newaxis]


@lru_cache(maxsize=TILES_KEPT)
def _tile(band: Band, number: int) -> FloatImage:
    """Return one keyframe of a band: value, slope along x, along y, and a zero, as float32."""
    shape = (TILE_CELLS, TILE_CELLS // 2 + 1, 2)
    drawn = generator(band.stream, number).standard_normal(shape, dtype=np.float32)
    spectrum = drawn.view(np.complex64)[:, :, 0] * _amplitude(band.slope, band.outer_share)
    tile = np.zeros((TILE_CELLS, TILE_CELLS, 4), dtype=np.float32)
    per_m = np.complex64(2j * np.pi * CELLS_PER_WAVE / band.scale_m)
    cycles_x, cycles_y = (cycles.astype(np.float32) for cycles in _cycles_per_cell())
    spectra = (spectrum, spectrum * (per_m * cycles_x), spectrum * (per_m * cycles_y))
    for channel, part in enumerate(spectra):
        tile[:, :, channel] = irfft2(part, (TILE_CELLS, TILE_CELLS))
    return np.pad(tile, ((0, PADDING), (0, PADDING), (0, 0)), mode="wrap")


@lru_cache(maxsize=64)
def _amplitude(slope: float, outer_share: float) -> FloatImage:
    """Return the waves' strengths that give a tile the variance one."""
    power = _wave_power(slope, outer_share)
    # A wave and its mirror image: 2 Re(a (n1 + i n2) e^..) has the power 4 a^2; a wave that is its
    # own column's mirror image keeps only its real part: a^2. irfft2 divides by the cells' number.
    amplitude: FloatArray = np.sqrt(power / power.sum()) / _sides() * TILE_CELLS**2
    return amplitude.astype(np.float32)


def _wave_power(slope: float, outer_share: float) -> FloatArray:
    """Return each wave's power (its mirror image's too) in a band, up to a common factor.

    Beyond the outer scale the spectrum is flat, below it falls with the slope. Each band has a
    window of one band to each side; neighbouring windows add up to one, the first is open to long
    waves.
    """
    cycles_x, cycles_y = _cycles_per_cell()
    waves = np.hypot(cycles_y, cycles_x) * CELLS_PER_WAVE
    waves[0, 0] = 1e-9
    bands_off = np.clip(np.log(waves) / log(BAND_RATIO), -1.0, 1.0)
    if outer_share == 1.0:
        bands_off = np.maximum(bands_off, 0.0)
    window = np.cos(0.5 * np.pi * bands_off) ** 2
    power: FloatArray = (waves**2 + outer_share**2) ** (-0.5 * slope) * window
    power[0, 0] = 0.0
    return power * _sides()


def _cycles_per_cell() -> tuple[FloatArray, FloatArray]:
    cycles_x = np.fft.rfftfreq(TILE_CELLS)[np.newaxis, :].astype(np.float64)
    return cycles_x, np.fft.fftfreq(TILE_CELLS)[:, np.newaxis].astype(np.float64)


def _sides() -> FloatArray:
    """Return how many waves each of a half spectrum's stands for, (1, columns)."""
    sides = np.full((1, TILE_CELLS // 2 + 1), 2.0)
    sides[0, [0, -1]] = 1.0
    return sides
