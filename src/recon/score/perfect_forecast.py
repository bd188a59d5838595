"""The perfect forecast: the true sky to come, where a method would state what it expects.

The reference for guidance: how much better a survey would be with forecasts without error. The
sky's seconds are those of the station's clock, which starts with the run. So the forecast is true
at the capture time that the station states, whatever the latency of the frame was.
"""

from dataclasses import replace

import numpy as np

from recon.model.shade import SUNLIT_TRANSMITTANCE, SURE, SunForecast
from recon.model.units import NS_PER_S
from recon.score.scenario import PERFECT
from recon.sim.world import Sky

VELOCITY_OVER_S = 1.0
"""Clouds change their velocity over minutes."""


def perfect_forecast(sky: Sky, base: SunForecast, surest: float) -> SunForecast:
    """Return the true sky at the issue time and leads of `base`, on its grid.

    A cell is in sun with the probability `surest`, or in shade with it: in view or not, up to the
    longest lead. The prior is that of `base`; the velocity is that of the lowest layer's shadows,
    None without clouds.
    """
    at_s = base.issued_at_ns / NS_PER_S
    sunlit, shaded = (np.uint8(round(share * SURE)) for share in (surest, 1.0 - surest))
    levels = np.empty(base.sun_probability.shape, dtype=np.uint8)
    for level, lead_s in zip(levels, base.lead_s.tolist(), strict=True):
        is_sunlit = sky.on_grid(base.grid, at_s + lead_s) >= SUNLIT_TRANSMITTANCE
        level[:] = np.where(is_sunlit, sunlit, shaded)
    return replace(
        base,
        sun_probability=levels,
        horizon_s=np.full_like(base.horizon_s, base.lead_s[-1]),
        method=PERFECT,
        velocity_mps=_velocity_mps(sky, at_s),
    )


def _velocity_mps(sky: Sky, at_s: float) -> tuple[float, float] | None:
    """Return the velocity of the lowest layer's shadows, east and north."""
    origins_m = sky.origins_m(at_s, at_s + VELOCITY_OVER_S).tolist()
    if not origins_m:
        return None
    east_m, north_m = origins_m[0]
    return -east_m / VELOCITY_OVER_S, -north_m / VELOCITY_OVER_S
