"""One look of a watchdog at vehicles in metres; `traffic` has the vehicles."""

from collections.abc import Mapping

from tests.safety.traffic import AIR, NOW, S, aircraft

from recon.model.control import AuthorityHolder, Commanded, Intent
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.settings import SafetySettings
from recon.safety.watchdogs import (
    WATCHDOGS,
    CommandedHold,
    Finding,
    TrafficPicture,
    Watchdog,
    WatchedVehicle,
    build_traffic_picture,
)

SETTINGS = SafetySettings()
LONG_AGO: Mapping[str, int] = {}


def picture(
    *vehicles: WatchedVehicle | VehicleState,
    airspace: PreparedAirspace = AIR,
    since_ns: Mapping[str, int] = LONG_AGO,
    is_hold_on: bool = True,
) -> TrafficPicture:
    watched = [v if isinstance(v, WatchedVehicle) else WatchedVehicle(v) for v in vehicles]
    return build_traffic_picture(watched, airspace, SETTINGS, NOW, since_ns, is_hold_on=is_hold_on)


def looks(
    watchdog: Watchdog,
    *vehicles: WatchedVehicle | VehicleState,
    airspace: PreparedAirspace = AIR,
    lasted_s: float = 5.0,
    is_hold_on: bool = True,
) -> list[Finding]:
    """A watchdog's findings that have lasted for a while."""
    once = list(watchdog(picture(*vehicles, airspace=airspace, is_hold_on=is_hold_on)))
    since = {finding.key: NOW - round(lasted_s * S) for finding in once}
    again = picture(*vehicles, airspace=airspace, since_ns=since, is_hold_on=is_hold_on)
    return list(watchdog(again))


def in_context(state: VehicleState, **changes: object) -> WatchedVehicle:
    """A vehicle and what the station knows beside its state."""
    return WatchedVehicle(state, **changes)  # type: ignore[arg-type]


def held(seconds_ago: float, speed_mps: float = 0.0) -> CommandedHold:
    return CommandedHold(NOW - round(seconds_ago * S), speed_mps)


__all__ = [
    "NOW",
    "WATCHDOGS",
    "AuthorityHolder",
    "Commanded",
    "FlightMode",
    "Intent",
    "S",
    "aircraft",
    "held",
    "in_context",
    "looks",
    "picture",
]
