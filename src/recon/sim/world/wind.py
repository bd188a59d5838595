"""Wind: a mean that grows and turns with height, and gusts.

Gusts are octaves of noise carried by the mean wind (Taylor's frozen turbulence): places farther
downwind have them later. A pure function of seed, place and time.
"""

from dataclasses import dataclass
from math import cos, floor, radians, sin, sqrt

from recon.sim.world.keyframes import PERIODS_PER_LIFETIME, number
from recon.sim.world.settings import WindSettings

REFERENCE_M = 10.0
LOWEST_M = 1.0
"""Height below which, in the crop, the power law does not apply."""
HIGHEST_M = 600.0
"""Height above which the wind is taken as constant."""
OCTAVES = 6
"""Octaves from the largest gusts to those of a second or two: drones ignore faster ones."""
OCTAVE_RATIO = 0.5
KOLMOGOROV = 2.0 / 3.0
"""Exponent of velocity variance over scale (Kolmogorov 1941)."""
POWERS = tuple(OCTAVE_RATIO ** (k * KOLMOGOROV) for k in range(OCTAVES))
WEIGHTS = tuple(sqrt(power / sum(POWERS)) for power in POWERS)
ACROSS_SHARE = 0.8
UP_SHARE = 0.5
"""Standard deviations across the wind and vertically over that along it, below 100 m."""
STREAM = 1_000
"""Random streams of the wind start here: those of the sky count layers from 0."""
SLOWEST_MPS = 1.0
"""Speed that carries gusts in calm air: the draught of thermals."""

Velocity = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Wind:
    """Wind velocity (east, north, up) in m/s, the direction the air moves to."""

    settings: WindSettings

    def mean_mps(self, height_m: float) -> Velocity:
        """Return the mean wind at a height above the ground."""
        east_mps, north_mps = velocity(self._speed_mps(height_m), self._heading_deg(height_m))
        return east_mps, north_mps, 0.0

    def at(self, east_m: float, north_m: float, height_m: float, time_s: float) -> Velocity:
        """Return the wind with its gusts at a place of the site's frame."""
        speed_mps = self._speed_mps(height_m)
        heading = radians(self._heading_deg(height_m))
        # Gusts travel with the wind at 10 m at all heights: a column of air gusts together.
        passing_mps = max(self._speed_mps(REFERENCE_M), SLOWEST_MPS)
        downwind_m = self._downwind_m(east_m, north_m)
        along, across, up = self._gust(time_s - downwind_m / passing_mps, passing_mps)
        along_mps = speed_mps + along
        return (
            along_mps * sin(heading) + across * cos(heading),
            along_mps * cos(heading) - across * sin(heading),
            up,
        )

    def _gust(self, passing_s: float, passing_mps: float) -> Velocity:
        """Return gusts along the mean wind, to its right, and upwards."""
        scale_s = self.settings.gust_scale_m / passing_mps
        deviation_mps = self.settings.gust_intensity * self.settings.speed_10m_mps
        parts = (
            deviation_mps * share * _noise(self.settings.seed, axis, passing_s, scale_s)
            for axis, share in enumerate((1.0, ACROSS_SHARE, UP_SHARE))
        )
        along, across, up = parts
        return along, across, up

    def _speed_mps(self, height_m: float) -> float:
        share = min(max(height_m, LOWEST_M), HIGHEST_M) / REFERENCE_M
        return self.settings.speed_10m_mps * float(share**self.settings.shear_exponent)

    def _heading_deg(self, height_m: float) -> float:
        height_m = min(max(height_m, 0.0), HIGHEST_M)
        return self.settings.heading_deg + self.settings.veer_deg_per_100m * height_m / 100.0

    def _downwind_m(self, east_m: float, north_m: float) -> float:
        heading = radians(self.settings.heading_deg)
        return east_m * sin(heading) + north_m * cos(heading)


def velocity(speed_mps: float, heading_deg: float) -> tuple[float, float]:
    """Return the east and north components."""
    heading = radians(heading_deg)
    return speed_mps * sin(heading), speed_mps * cos(heading)


def _noise(seed: int, axis: int, time_s: float, scale_s: float) -> float:
    """Return noise of mean 0 and standard deviation 1 on time scales from `scale_s` down."""
    value = 0.0
    position = time_s / (scale_s * PERIODS_PER_LIFETIME)
    for k, weight in enumerate(WEIGHTS):
        value += weight * _between_keys((seed, STREAM + axis, k), position)
        position /= OCTAVE_RATIO
    return value


def _between_keys(stream: tuple[int, ...], position: float) -> float:
    """Blend the two neighbouring keyframes so that the variance stays one."""
    key = floor(position)
    along = position - key
    rest = 1.0 - along
    norm = sqrt(rest * rest + along * along)
    return (rest * number(stream, key) + along * number(stream, key + 1)) / norm
