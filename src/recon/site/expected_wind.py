"""The wind that is expected to move the shadows, of the weather that a site has fetched."""

from math import atan2, degrees, hypot

import numpy as np

from recon.forecast.wind_aloft import wind_at_clouds
from recon.geo.geoid import geoid_height_m
from recon.model.airspace import Region
from recon.model.weather import WindAloft
from recon.site.fetched_report import age_text
from recon.site.site import Site

LEAST_SPEED_MPS = 1.0
"""Slower shade crosses no site during a flight."""


def expected_wind(site: Site, now_utc_s: float) -> WindAloft | None:
    """Return the wind at the clouds' height now; None without weather for it."""
    hour = None if site.weather is None else site.weather.at(now_utc_s)
    if hour is None or site.frame is None:
        return None
    origin = site.frame.origin
    sea_level_m = geoid_height_m(origin.latitude_deg, origin.longitude_deg)
    return wind_at_clouds(hour, origin.ellipsoid_height_m - sea_level_m)


def wind_report(site: Site, now_utc_s: float) -> tuple[str, ...]:
    """Return what motion the sun forecast expects until maps show it, and for how long shade is
    foreseen then; nothing without weather."""
    wind = expected_wind(site, now_utc_s)
    if wind is None or site.weather is None:
        return ()
    towards_deg = degrees(atan2(wind.east_mps, wind.north_mps)) % 360.0
    return (
        f"until maps show the shadows' motion, {hypot(wind.east_mps, wind.north_mps):.1f} m/s "
        f"towards {towards_deg:.0f} degrees is expected: the wind at {wind.pressure_hpa} hPa by "
        f"the weather, {age_text(site.weather.fetched_utc_s, now_utc_s)}",
        *_foreseen(site.layers.boundary, wind),
    )


def _foreseen(boundary: Region | None, wind: WindAloft) -> tuple[str, ...]:
    """State for how long shade is foreseen over the site: until it has crossed what is seen."""
    speed_mps = hypot(wind.east_mps, wind.north_mps)
    if boundary is None or speed_mps < LEAST_SPEED_MPS:
        return ()
    along_m = boundary.outline_m @ (wind.east_mps, wind.north_mps) / speed_mps
    across_s = float(np.ptp(along_m)) / speed_mps
    return (
        f"shade crosses the site in {across_s:.0f} s then: where the imaging drone sees no farther "
        f"upwind than its boundary, what comes is foreseen for {across_s:.0f} s at most, beyond "
        "that only how much sun there is",
    )
