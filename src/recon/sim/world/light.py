"""The light of a clear sky: the direct beam and what the sky scatters.

The model of the European Solar Radiation Atlas (Rigollier, Bauer, Wald, Solar Energy 68, 2000) with
Kasten's thickness of clean air (1996): all that dims is one number, Linke's turbidity.
"""

from dataclasses import dataclass
from math import exp, radians, sin

import numpy as np

from recon.sim.land.noise import FloatImage
from recon.sim.world.settings import LightSettings
from recon.sim.world.sun import SunPosition

SOLAR_CONSTANT_W_M2 = 1361.0
SCALE_HEIGHT_M = 8434.5
LEAST_SCATTERED = 2e-3
"""The atlas's bound for a low sun."""


@dataclass(frozen=True, slots=True)
class ClearSkyLight:
    """Irradiance of level ground under a clear sky."""

    direct_w_m2: float
    diffuse_w_m2: float

    @property
    def global_w_m2(self) -> float:
        """All of it."""
        return self.direct_w_m2 + self.diffuse_w_m2

    @property
    def diffuse_share(self) -> float:
        """Part of the light that shade leaves; all of it when the sun is down."""
        return self.diffuse_w_m2 / self.global_w_m2 if self.direct_w_m2 > 0.0 else 1.0

    def index(self, transmittance: FloatImage, brightening: float = 1.0) -> FloatImage:
        """Return the clear-sky index: light on the ground over what a clear sky would give.

        `brightening` is what clouds around make of the diffuse light.
        """
        diffuse = self.diffuse_share
        index = brightening * diffuse + (1.0 - diffuse) * transmittance
        return index.astype(np.float32)


def clear_sky_light(sun: SunPosition, settings: LightSettings) -> ClearSkyLight:
    """Return the light on level ground; none from a sun below the horizon."""
    if sun.elevation_deg <= 0.0:
        return ClearSkyLight(0.0, 0.0)
    outside = SOLAR_CONSTANT_W_M2 / sun.distance_au**2
    height = sin(radians(sun.elevation_deg))
    mass = _air_mass(sun.elevation_deg, settings.altitude_m)
    depth = 0.8662 * settings.linke_turbidity * mass * _clean_thickness(mass)
    return ClearSkyLight(
        outside * height * exp(-depth), outside * _scattered(settings.linke_turbidity, height)
    )


def _air_mass(elevation_deg: float, altitude_m: float) -> float:
    """Return how much air the beam crosses, over that straight up from the sea (Kasten, Young)."""
    straight = sin(radians(elevation_deg)) + 0.50572 * (elevation_deg + 6.07995) ** -1.6364
    return float(exp(-altitude_m / SCALE_HEIGHT_M) / straight)


def _clean_thickness(mass: float) -> float:
    if mass > 20.0:
        return 1.0 / (10.4 + 0.718 * mass)
    thick = 6.6296 + 1.7513 * mass - 0.1202 * mass**2 + 0.0065 * mass**3 - 0.00013 * mass**4
    return 1.0 / thick


def _scattered(turbidity: float, height: float) -> float:
    """Return the diffuse light over that outside the air; `height` is the elevation's sine."""
    zenith = -1.5843e-2 + 3.0543e-2 * turbidity + 3.797e-4 * turbidity**2
    even = 2.6463e-1 - 6.1581e-2 * turbidity + 3.1408e-3 * turbidity**2
    even = max(even, LEAST_SCATTERED / zenith)
    linear = 2.0402 + 1.8945e-2 * turbidity - 1.1161e-2 * turbidity**2
    square = -1.3025 + 3.9231e-2 * turbidity + 8.5079e-3 * turbidity**2
    return zenith * (even + linear * height + square * height**2)
