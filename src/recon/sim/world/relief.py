"""Gentle relief: ground heights as a sum of long waves, and their slopes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.settings import expect

WAVES = 9


@dataclass(frozen=True, slots=True)
class ReliefSettings:
    """Amplitude and wavelengths of the relief."""

    seed: int = 0
    height_m: float = 4.0
    """Standard deviation; till plains of the corn belt rise and fall by ten metres."""
    shortest_m: float = 250.0
    longest_m: float = 1_400.0
    """Wavelengths; shorter ones are levelled by ploughing, longer ones are hills."""

    def __post_init__(self) -> None:
        expect("relief: seed", self.seed, 0, 2**63)
        expect("relief: height_m", self.height_m, 0.0, 60.0)
        expect("relief: shortest_m", self.shortest_m, 50.0, self.longest_m)
        expect("relief: longest_m", self.longest_m, 50.0, 1e5)


@dataclass(frozen=True)
class Relief:
    """Ground heights over a site; the origin lies at height 0."""

    settings: ReliefSettings

    def height_m(self, east_m: npt.ArrayLike, north_m: npt.ArrayLike) -> FloatImage:
        """Return heights above the origin at ground points (broadcast together)."""
        phase = self._phase(east_m, north_m)
        at_origin = float(np.sum(self._amplitudes_m * np.sin(self._phases)))
        return (np.sin(phase) @ self._amplitudes_m - at_origin).astype(np.float32)

    def slope(self, east_m: npt.ArrayLike, north_m: npt.ArrayLike) -> tuple[FloatImage, FloatImage]:
        """Return the rise per metre towards east and towards north."""
        rises = np.cos(self._phase(east_m, north_m)) * self._amplitudes_m
        east, north = rises @ self._waves[0], rises @ self._waves[1]
        return east.astype(np.float32), north.astype(np.float32)

    def _phase(self, east_m: npt.ArrayLike, north_m: npt.ArrayLike) -> FloatArray:
        east, north = np.asarray(east_m)[..., np.newaxis], np.asarray(north_m)[..., np.newaxis]
        phase: FloatArray = east * self._waves[0] + north * self._waves[1] + self._phases
        return phase

    @cached_property
    def _lengths_m(self) -> FloatArray:
        at = self.settings
        return np.geomspace(at.longest_m, at.shortest_m, WAVES)

    @cached_property
    def _waves(self) -> FloatArray:
        """Wave numbers (2, WAVES) in radians per metre towards east and north."""
        random = np.random.default_rng((self.settings.seed, 0))
        bearings = random.uniform(0.0, 2.0 * np.pi, WAVES)
        waves: FloatArray = np.stack([np.sin(bearings), np.cos(bearings)]) * 2.0 * np.pi
        return waves / self._lengths_m

    @cached_property
    def _phases(self) -> FloatArray:
        return np.random.default_rng((self.settings.seed, 1)).uniform(0.0, 2.0 * np.pi, WAVES)

    @cached_property
    def _amplitudes_m(self) -> FloatArray:
        """Return amplitudes, larger for longer waves, with the settings' deviation of the sum."""
        # A power of 1.2 gives gentle short waves; the sum of sines has variance sum(a^2) / 2.
        raw = self._lengths_m**1.2
        together = float(np.sqrt(0.5 * np.sum(raw * raw)))
        return raw * (self.settings.height_m / together)
