"""Compares each vehicle's battery with what the route home takes from where it is now."""

from collections.abc import Iterator

from recon.model.severity import Severity
from recon.safety.energy import fraction_to_get_home
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture, WatchedVehicle

RULE = "battery_home"


def battery_home(picture: TrafficPicture) -> Iterator[Finding]:
    """Find vehicles in the air whose battery is about to be too low to come home."""
    for watched in picture.flying:
        has = watched.state.battery_fraction.value
        if has is None:
            continue
        needs = fraction_to_get_home(watched.state, picture.airspace, picture.energy)
        if needs is not None:
            yield from _compared(watched, has, needs, picture)


def _compared(
    watched: WatchedVehicle, has: float, needs: float, picture: TrafficPicture
) -> Iterator[Finding]:
    """Yield a critical finding below the landing minimum, a warning to return below the reserve."""
    least, reserve = picture.energy.landing_fraction, _reserve(picture)
    figures = f"battery {has:.0%}, route home {needs:.0%}"
    if has < needs + least and not (watched.is_coming_down and has >= needs):
        text = f"{figures}: it may not reach home; land it or recall it now"
        yield watched.finding(RULE, Severity.CRITICAL, text, after_s=1.0)
    elif has < needs + reserve and not watched.is_coming_down:
        text = f"{figures}: less than the reserve of {reserve:.0%} would be left; recall it"
        yield watched.finding(RULE, Severity.WARNING, text, after_s=1.0)


def _reserve(picture: TrafficPicture) -> float:
    return picture.airspace.airspace.limits.battery_reserve_fraction
