"""A rehearsal at one's own site: the sun, the clouds and the wind over it, as a scenario has them.

The sun stands as on a midsummer morning: a rehearsal in winter, or in the evening, has light.
"""

from recon.geo import utc_at_elevation
from recon.model.geo import LatLon
from recon.model.units import wrap_degrees
from recon.sim.world import LayerSettings, Sky, SkySettings, SunSettings, WindSettings
from recon.sim.world.settings import LOW_SPEED_MPS

MIDSUMMER_UTC_S = {True: 1_750_464_000.0, False: 1_766_318_400.0}
"""2025-06-21 and 2025-12-21, by whether the place is north of the equator."""
SUN_DEG = 45.0
"""The sun's elevation at the start, in the middle of those that scenarios draw."""
TROPIC_DEG = 23.0
SMALL_CLOUDS_M, SHARP_EDGES = 2_500.0, 0.15
"""Many small clouds: shadows come and go over a field within minutes."""
HIGHER_WIND = 2.0
"""Speed of low clouds over that of the wind near the ground."""
CLOUD_VEER_DEG = 20.0
"""Clouds move to the right of the wind near the ground, which friction turns."""


def sun_over(place: LatLon) -> SunSettings:
    """Return the sun of a midsummer morning; near the poles it is as high as it gets there."""
    near_utc_s = MIDSUMMER_UTC_S[place.latitude_deg >= 0.0]
    highest_deg = 90.0 - abs(place.latitude_deg) + TROPIC_DEG
    try:
        start_utc_s = utc_at_elevation(place, near_utc_s, min(SUN_DEG, highest_deg), is_rising=True)
    except ValueError:
        start_utc_s = near_utc_s
    return SunSettings(place, start_utc_s)


def rehearsal_sky(place: LatLon, cover: float, wind: WindSettings | None, seed: int) -> Sky:
    """Return a sky of low clouds that move with the wind; without cover (0 to 1) it is clear."""
    speed_mps = 0.0 if wind is None else HIGHER_WIND * wind.speed_10m_mps
    heading_deg = 0.0 if wind is None else wind.heading_deg
    cloud = LayerSettings(
        cover=cover,
        speed_mps=min(max(speed_mps, LOW_SPEED_MPS[0]), LOW_SPEED_MPS[1]),
        heading_deg=wrap_degrees(heading_deg + CLOUD_VEER_DEG),
        outer_scale_m=SMALL_CLOUDS_M,
        softness=SHARP_EDGES,
    )
    return Sky(SkySettings(seed, sun_over(place), (cloud,) if cover > 0.0 else ()))
