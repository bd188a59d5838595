"""Keyframes of a fractal field's bands: periodic tiles of noise, each drawn once from its seed."""

from dataclasses import dataclass
from functools import lru_cache
from math import log

import numpy as np
import numpy.typing as npt
from scipy.fft import ifft, irfft

from recon.sim.land.noise import FloatImage
from recon.sim.world.keyframes import FloatArray, generator

ComplexImage = npt.NDArray[np.complex64]

BAND_RATIO = 4.0
TILE_CELLS = 256
CELLS_PER_WAVE = 32.0
"""At a band's middle; its strongest have 16 and more."""
SHORTEST_CELLS = 8
"""Of a band's shortest waves: neighbours in scale are one band ratio off."""
PADDING = 2
"""Columns and rows repeated at a tile's end, so that no point lies between its two edges."""
TILES_KEPT = 64
"""A megabyte each; two layers of five bands need 20 at any moment."""
COLUMNS = TILE_CELLS // SHORTEST_CELLS + 1
"""Of half a spectrum, from the longest waves on: beyond, a band has none."""


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


@lru_cache(maxsize=TILES_KEPT)
def tile(band: Band, number: int) -> FloatImage:
    """Return one keyframe of a band: value, slope along x, along y, and a zero, as float32."""
    shape = (TILE_CELLS, TILE_CELLS // 2 + 1, 2)
    drawn = generator(band.stream, number).standard_normal(shape, dtype=np.float32)
    waves = drawn.view(np.complex64)[:, :COLUMNS, 0] * _amplitude(band.slope, band.outer_share)
    per_m = np.complex64(2j * np.pi * CELLS_PER_WAVE / band.scale_m)
    found = np.zeros((TILE_CELLS + PADDING, TILE_CELLS + PADDING, 4), dtype=np.float32)
    whole = found[:TILE_CELLS, :TILE_CELLS]
    for channel, part in enumerate((waves, *(waves * (per_m * c) for c in _float32_cycles()))):
        whole[:, :, channel] = irfft(ifft(part, axis=0), TILE_CELLS, axis=1)
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
