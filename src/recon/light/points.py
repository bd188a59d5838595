"""Light sensors on the ground (pyranometers, inverters, PAR loggers) as truth.

A sensor's index of light is its value over its own 98th percentile; a quarter of full light is
diffuse, so the direct share is (index - 0.25) / 0.75. Half of it is sun.
"""

from dataclasses import dataclass

import numpy as np

from recon.model.arrays import FloatArray, IntArray
from recon.model.geo import LocalFrame
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, MaskMap
from recon.model.units import NS_PER_S

FULL_PERCENTILE = 98.0
DIFFUSE_SHARE = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class LightPoints:
    """Values of N sensors at T times, all on one clock; times rise strictly."""

    names: tuple[str, ...]
    times_ns: IntArray
    """(T,) Unix time."""
    light: FloatArray
    """(T, N) in the sensors' own unit; NaN where unknown."""
    east_m: FloatArray
    north_m: FloatArray
    """(N,) from the origin of `frame`."""
    frame: LocalFrame | None
    """None where only metres are known."""
    notes: tuple[str, ...] = ()
    """What was skipped, and how often."""

    @property
    def direct(self) -> FloatMap:
        """Return (T, N): the share of the clear sky's direct beam, in [0, 1]; NaN if unknown."""
        return direct_share(self.light, np.nanpercentile(self.light, FULL_PERCENTILE, axis=0))

    @property
    def step_s(self) -> float:
        """Usual seconds between two times: their median."""
        return float(np.median(np.diff(self.times_ns))) / NS_PER_S


def direct_share(light: FloatArray, full: FloatArray | float) -> FloatMap:
    """Return the share of the clear sky's direct beam of values of which `full` is full light."""
    share = (light / full - DIFFUSE_SHARE) / (1.0 - DIFFUSE_SHARE)
    return np.clip(share, 0.0, 1.0).astype(np.float32)


def is_sunlit(direct: FloatMap) -> MaskMap:
    """Return which known values are in sun."""
    with np.errstate(invalid="ignore"):
        return direct >= SUNLIT_TRANSMITTANCE
