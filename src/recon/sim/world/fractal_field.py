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
from scipy.fft import ifft, irfft

from recon.model.arrays import FloatArray
from recon.sim.world.keyframes import FloatImage, blend, generator, phase

BAND_RATIO = 4.0
TILE_CELLS = 256
CELLS_PER_WAVE = 32.0
"""Cells per wave at a band's middle; its strongest waves have 16 cells and more."""
SHORTEST_CELLS = 8
"""Cells of a band's shortest waves: the window ends one band ratio from the middle."""
PADDING = 2
"""Columns and rows repeated at a tile's end, so that interpolation never crosses its edge."""
TILES_KEPT = 64
"""A megabyte each; two layers of five bands need 20 at any moment."""
COLUMNS = TILE_CELLS // SHORTEST_CELLS + 1
"""Columns of half a spectrum that are not zero."""


@dataclass(frozen=True, slots=True)
class Band:
    """One band of a field: waves around `scale_m`, of deviation `strength`."""

    stream: tuple[int, ...]
    scale_m: float
    outer_share: float
    """Ratio of its scale to the field's outer scale."""
    strength: float
    lifetime_s: float
    slope: float


@lru_cache(maxsize=TILES_KEPT)
def tile(band: Band, number: int) -> FloatImage:
    """Return one keyframe of a band: value, slope along x, along y, and a zero, as float32."""
    shape = (TILE_CELLS, TILE_CELLS // 2 + 1, 2)
    drawn = generator(band.stream, number).standard_normal(shape, dtype=np.float32)
    # Noise is drawn in the frequency domain: real and imaginary parts are one complex wave.
    waves = drawn.view(np.complex64)[:, :COLUMNS, 0] * _amplitude(band.slope, band.outer_share)
    per_m = np.complex64(2j * np.pi * CELLS_PER_WAVE / band.scale_m)
    found = np.zeros((TILE_CELLS + PADDING, TILE_CELLS + PADDING, 4), dtype=np.float32)
    whole = found[:TILE_CELLS, :TILE_CELLS]
    for channel, part in enumerate((waves, *(waves * (per_m * c) for c in _float32_cycles()))):
        whole[:, :, channel] = irfft(ifft(part, axis=0), TILE_CELLS, axis=1)
    # Wrap around: interpolation at the end of the tile reads its start.
    found[TILE_CELLS:, :TILE_CELLS] = whole[:PADDING]
    found[:, TILE_CELLS:] = found[:, :PADDING]
    return found


@lru_cache(maxsize=64)
def _amplitude(slope: float, outer_share: float) -> FloatImage:
    """Return the waves' strengths that give a tile the variance one."""
    power = wave_power(slope, outer_share)
    # A wave and its mirror image: 2 Re(a (n1 + i n2) e^..) has the power 4 a^2; a wave that is its
    # own column's mirror image keeps only its real part: a^2. The transform divides by the cells.
    amplitude: FloatArray = np.sqrt(power / power.sum()) / _sides() * TILE_CELLS**2
    return amplitude[:, :COLUMNS].astype(np.float32)


def wave_power(slope: float, outer_share: float) -> FloatArray:
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


@lru_cache(maxsize=1)
def _float32_cycles() -> tuple[FloatImage, FloatImage]:
    """Return cycles per cell along x and along y of the waves that bands have."""
    cycles_x, cycles_y = (cycles.astype(np.float32) for cycles in _cycles_per_cell())
    return cycles_x[:, :COLUMNS], cycles_y


def _sides() -> FloatArray:
    """Return how many waves each of a half spectrum's stands for, (1, columns)."""
    sides = np.full((1, TILE_CELLS // 2 + 1), 2.0)
    sides[0, [0, -1]] = 1.0
    return sides


IndexArray = npt.NDArray[np.int64]
AT_ONCE: IndexArray = np.zeros(1, dtype=np.int64)
"""Index for `moment` where all points share one time."""
ROW_POINTS = 256
"""Points are sampled in rows of this length, the last one padded: the rest of a row may take
another code path in OpenCV, and a value must not depend on what else is asked for."""
FIRST_ZERO_SQUARED = 3.8317**2
"""First zero of the Bessel function J1."""


@dataclass(frozen=True, slots=True, eq=False)
class FieldSample:
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
    """Lifetime of structures of 1 km."""
    lifetime_exponent: float

    @cached_property
    def bands(self) -> tuple[Band, ...]:
        """Return the bands, largest scale first; the last is the first below twice the finest."""
        octaves = log(self.outer_scale_m / self.finest_scale_m, BAND_RATIO)
        shares = [BAND_RATIO**-k for k in range(int(octaves + 0.5) + 1)]
        powers = [
            (share * self.outer_scale_m) ** (self.slope - 2.0) * wave_power(self.slope, share).sum()
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
        """Distance after which the field repeats along its axes."""
        return self.outer_scale_m * TILE_CELLS / CELLS_PER_WAVE

    def sample(
        self,
        x_m: FloatArray,
        y_m: FloatArray,
        time_s: FloatArray,
        blur_m2: FloatArray,
        moment: IndexArray = AT_ONCE,
    ) -> FieldSample:
        """Return the field at N points at K moments; times and blurs are (K,).

        `moment` (N,) is the number of each point's moment; (1,) if that is one for all.
        Waves are weakened as by a disk of diameter squared `blur_m2`: those much longer not at all.
        """
        places = _Places(x_m / self.period_m, y_m / self.period_m)
        total = np.zeros((*places.shape, 4), dtype=np.float32)
        columns = self._columns
        blended = blend(time_s, columns.lifetime_s, columns.phase)
        weights = columns.strength * disk_weight(columns.scale_m, blur_m2)
        for k, band in enumerate(self.bands):
            places.enter_tile()
            for later, share in enumerate((blended.share[k], blended.next_share[k])):
                found = _remap_at(band, blended.number[k] + later, places, moment)
                found *= _by_rows((weights[k] * share).astype(np.float32)[moment])
                total += found
            places.refine()
        points = total.reshape(-1, 4)[: x_m.size]
        return FieldSample(points[:, 0], points[:, 1], points[:, 2])

    @cached_property
    def _columns(self) -> "_BandColumns":
        rows = [(b.scale_m, b.strength, b.lifetime_s, phase(b.stream)) for b in self.bands]
        return _BandColumns(*(column[:, np.newaxis] for column in np.array(rows).T))


@dataclass(frozen=True, slots=True, eq=False)
class _BandColumns:
    """Parameters of the bands as columns (bands, 1), to compute all bands at once."""

    scale_m: FloatArray
    strength: FloatArray
    lifetime_s: FloatArray
    phase: FloatArray


class _Places:
    """Points in padded rows, as fractions of the current band's tile."""

    def __init__(self, x_tiles: FloatArray, y_tiles: FloatArray) -> None:
        self._tiles = [_filled(tiles) for tiles in (x_tiles, y_tiles)]
        self.shape = self._tiles[0].shape
        self._spare = np.empty(self.shape)
        self.cols, self.rows = (np.empty(self.shape, dtype=np.float32) for _ in self._tiles)
        """Columns and rows in cells."""

    def enter_tile(self) -> None:
        """Reduce to the part beyond the last whole tile; exact in floating point."""
        for tiles, cells in zip(self._tiles, (self.cols, self.rows), strict=True):
            np.subtract(tiles, np.floor(tiles, out=self._spare), out=tiles)
            np.multiply(tiles, TILE_CELLS, out=cells, casting="same_kind")

    def refine(self) -> None:
        """Move on to the next finer band."""
        for tiles in self._tiles:
            tiles *= BAND_RATIO


def disk_weight(wave_m: float | FloatArray, blur_m2: FloatArray) -> FloatArray:
    """Return the attenuation of a wave averaged over disks of diameter squared `blur_m2`.

    That is 2 J1(x) / x of x = pi diameter / wave, by its series up to its first zero, then nothing.
    Waves and blurs are broadcast together.
    """
    # y = x squared. Beyond the first zero the weight is set to 0: the lobes after it are small.
    y = np.minimum(np.pi * np.pi * blur_m2 / (wave_m * wave_m), FIRST_ZERO_SQUARED)
    series = 1.0 - y * (1.0 / 8.0 - y * (1.0 / 192.0 - y * (1.0 / 9216.0 - y / 737280.0)))
    return np.where(y < FIRST_ZERO_SQUARED, series, 0.0)


def _remap_at(band: Band, number: IndexArray, places: _Places, moment: IndexArray) -> FloatImage:
    """Sample each point from the keyframe of its moment's number (K,)."""
    # Fast path: all points share one keyframe.
    if number.size == 1 or number.min() == number.max():
        return _remap(band, int(number[0]), places.cols, places.rows)
    flat_cols, flat_rows = places.cols.ravel(), places.rows.ravel()
    found = np.zeros((flat_cols.size, 4), dtype=np.float32)
    for one in np.unique(number):
        here = np.flatnonzero((number == one)[moment])
        part = [_filled(values[here]) for values in (flat_cols, flat_rows)]
        found[here] = _remap(band, int(one), *part).reshape(-1, 4)[: here.size]
    return found.reshape(*places.shape, 4)


def _remap(band: Band, number: int, cols: FloatImage, rows: FloatImage) -> FloatImage:
    keyframe = tile(band, number)
    found = cv2.remap(keyframe, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return found.astype(np.float32, copy=False)


def _filled(values: npt.NDArray[np.floating]) -> npt.NDArray[np.floating]:
    """Return (N,) values as full rows of their own, zeros at the end."""
    full = np.zeros(-(-values.size // ROW_POINTS) * ROW_POINTS, dtype=values.dtype)
    full[: values.size] = values
    return full.reshape(-1, ROW_POINTS)


def _by_rows(share: FloatImage) -> FloatImage:
    """Return shares, (N,) or (1,), so that they multiply rows of four channels."""
    if share.size == 1:
        return share.reshape(1, 1, 1)
    return _filled(share)[:, :, np.newaxis]
