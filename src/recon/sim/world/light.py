"""Light on the ground: clear-sky irradiance, its colours, and the beam under clouds.

The model of the European Solar Radiation Atlas (Rigollier, Bauer, Wald, Solar Energy 68, 2000) with
Kasten's thickness of clean air (1996): all extinction is one number, Linke's turbidity.

Colours are relative to a bright summer day's full sun, in which a camera shows white as white; the
light of the sky, which shade leaves, is bluer than the beam.
"""

from dataclasses import dataclass, replace
from math import exp, radians, sin

import numpy as np
import numpy.typing as npt

from recon.geo.sun import SunPosition
from recon.model.arrays import FloatArray
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.relief import Relief
from recon.sim.world.settings import LightSettings
from recon.sim.world.sky import Sky

SOLAR_CONSTANT_W_M2 = 1361.0
SCALE_HEIGHT_M = 8434.5
LEAST_SCATTERED = 2e-3
"""The atlas's lower bound for a low sun."""


@dataclass(frozen=True, slots=True)
class ClearSkyLight:
    """Irradiance of level ground under a clear sky."""

    direct_w_m2: float
    diffuse_w_m2: float

    @property
    def global_w_m2(self) -> float:
        """Direct and diffuse together."""
        return self.direct_w_m2 + self.diffuse_w_m2

    @property
    def diffuse_share(self) -> float:
        """Diffuse over global irradiance; 1 when the sun is below the horizon."""
        return self.diffuse_w_m2 / self.global_w_m2 if self.direct_w_m2 > 0.0 else 1.0

    def index(self, transmittance: FloatImage, brightening: float = 1.0) -> FloatImage:
        """Return the clear-sky index: light on the ground over what a clear sky would give.

        `brightening` multiplies the diffuse light: broken clouds scatter more than clear sky.
        """
        diffuse = self.diffuse_share
        index = brightening * diffuse + (1.0 - diffuse) * transmittance
        return index.astype(np.float32)


def clear_sky_light(sun: SunPosition, settings: LightSettings) -> ClearSkyLight:
    """Return the irradiance of level ground; zero with the sun below the horizon."""
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
    """Return the relative optical air mass (Kasten and Young 1989), corrected for altitude."""
    straight = sin(radians(elevation_deg)) + 0.50572 * (elevation_deg + 6.07995) ** -1.6364
    return float(exp(-altitude_m / SCALE_HEIGHT_M) / straight)


def _clean_thickness(mass: float) -> float:
    if mass > 20.0:
        return 1.0 / (10.4 + 0.718 * mass)
    thick = 6.6296 + 1.7513 * mass - 0.1202 * mass**2 + 0.0065 * mass**3 - 0.00013 * mass**4
    return 1.0 / thick


def _scattered(turbidity: float, height: float) -> float:
    """Return diffuse over extraterrestrial irradiance; `height` is the sine of the elevation."""
    zenith = -1.5843e-2 + 3.0543e-2 * turbidity + 3.797e-4 * turbidity**2
    even = 2.6463e-1 - 6.1581e-2 * turbidity + 3.1408e-3 * turbidity**2
    even = max(even, LEAST_SCATTERED / zenith)
    linear = 2.0402 + 1.8945e-2 * turbidity - 1.1161e-2 * turbidity**2
    square = -1.3025 + 3.9231e-2 * turbidity + 8.5079e-3 * turbidity**2
    return zenith * (even + linear * height + square * height**2)


REFERENCE_W_M2 = 850.0
"""Irradiance at which the land shows the colours it is drawn with."""
SKY_COLOUR = (0.72, 0.95, 1.33)
"""Sky light over sun light in red, green, blue, of mean 1: 12 000 K against 5 500 K."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundLight:
    """Light on level ground in red, green, blue (3,)."""

    beam: FloatArray
    """Light of the unclouded sun."""
    sky: FloatArray
    """Light of sky and clouds."""
    toward_sun: FloatArray
    """Unit vector, east, north, up."""

    def at(self, transmittance: FloatImage) -> FloatImage:
        """Return light (..., 3) at this transmittance of the beam."""
        share = np.asarray(transmittance, dtype=np.float32)[..., np.newaxis]
        light: FloatImage = self.sky.astype(np.float32) + share * self.beam.astype(np.float32)
        return light


def ground_light(
    sun: SunPosition, settings: LightSettings, reference_w_m2: float = REFERENCE_W_M2
) -> GroundLight:
    """Return the light under broken clouds; its mean over colours is `ClearSkyLight.index`.

    The light that clouds add is white. With a shade colour in the settings, sun stays as bright and
    shade has that share of it.
    """
    clear = clear_sky_light(sun, settings)
    strength = clear.global_w_m2 / reference_w_m2
    # Beam and sky are complementary: white in full sun, whatever the diffuse share.
    blue_sky = clear.diffuse_share * np.array(SKY_COLOUR)
    beam = np.maximum(1.0 - blue_sky, 0.0) if clear.direct_w_m2 > 0.0 else np.zeros(3)
    from_clouds = (settings.cloud_brightening - 1.0) * clear.diffuse_share
    if settings.shade is not None and clear.direct_w_m2 > 0.0:
        ratios, whole = np.array(settings.shade.ratios), strength * (1.0 + from_clouds)
        return GroundLight(whole * (1.0 - ratios), whole * ratios, sun.toward_enu)
    return GroundLight(strength * beam, strength * (blue_sky + from_clouds), sun.toward_enu)


LEAST_SUN_HEIGHT = 0.08
"""Sine of the lowest sun elevation used for slopes: 5 degrees."""
GREEN = 1


def light_under(sky: Sky, time_s: float, settings: LightSettings | None = None) -> GroundLight:
    """Return the light at a time; without cloud layers the sky is not brightened."""
    settings = settings or LightSettings()
    if not sky.settings.layers:
        settings = replace(settings, cloud_brightening=1.0)
    return ground_light(sky.sun_at(time_s), settings)


def metered_light(
    sky: Sky,
    east_m: npt.ArrayLike,
    north_m: npt.ArrayLike,
    time_s: float,
    settings: LightSettings | None = None,
) -> float:
    """Return the mean light at points, in green, relative to the reference."""
    light = light_under(sky, time_s, settings)
    share = float(np.mean(sky.transmittance(east_m, north_m, time_s), dtype=np.float64))
    return float(light.sky[GREEN] + share * light.beam[GREEN])


def beam_share(
    sky: Sky,
    light: GroundLight,
    relief: Relief | None,
    east_m: FloatImage,
    north_m: FloatImage,
    time_s: float,
) -> FloatImage:
    """Return the beam on the (sloping) ground over that on level ground under clear sky."""
    share = sky.transmittance(east_m, north_m, time_s)
    if relief is None:
        return share
    rise_east, rise_north = relief.slope(east_m, north_m)
    sun_east, sun_north, sun_up = (float(part) for part in light.toward_sun)
    sun_up = max(sun_up, LEAST_SUN_HEIGHT)
    # Cosine of the angle between sun and surface normal, over that on level ground.
    facing = sun_up - rise_east * sun_east - rise_north * sun_north
    facing /= sun_up * np.sqrt(1.0 + rise_east**2 + rise_north**2)
    tilted: FloatImage = (share * np.maximum(facing, 0.0)).astype(np.float32)
    return tilted
