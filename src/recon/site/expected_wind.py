"""The wind that is expected to move the shadows, of the weather that a site has fetched."""

from math import atan2, degrees, hypot

from recon.forecast.wind_aloft import wind_at_clouds
from recon.geo.geoid import geoid_height_m
from recon.model.weather import WindAloft
from recon.site.fetched_report import age_text
from recon.site.site import Site


def expected_wind(site: Site, now_utc_s: float) -> WindAloft | None:
    """Return the wind at the clouds' height now; None without weather for it."""
    hour = None if site.weather is None else site.weather.at(now_utc_s)
    if hour is None or site.frame is None:
        return None
    origin = site.frame.origin
    sea_level_m = geoid_height_m(origin.latitude_deg, origin.longitude_deg)
    return wind_at_clouds(hour, origin.ellipsoid_height_m - sea_level_m)


def wind_report(site: Site, now_utc_s: float) -> tuple[str, ...]:
    """Return a line on the motion that the sun forecast expects until maps show it, if any."""
    wind = expected_wind(site, now_utc_s)
    if wind is None or site.weather is None:
        return ()
    towards_deg = degrees(atan2(wind.east_mps, wind.north_mps)) % 360.0
    return (
        f"until maps show the shadows' motion, {hypot(wind.east_mps, wind.north_mps):.1f} m/s "
        f"towards {towards_deg:.0f} degrees is expected: the wind at {wind.pressure_hpa} hPa by "
        f"the weather, {age_text(site.weather.fetched_utc_s, now_utc_s)}",
    )
