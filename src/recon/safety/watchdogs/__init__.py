"""The watchdogs: each looks at one picture and says what is wrong. Pure, one file each."""

from collections.abc import Callable, Iterable

from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.battery_home import battery_home
from recon.safety.watchdogs.fences import fences
from recon.safety.watchdogs.separation import separation
from recon.safety.watchdogs.telemetry import heights, jumps, link, sticks
from recon.safety.watchdogs.traffic_picture import (
    CommandedHold,
    Finding,
    PreviousPosition,
    TrafficPicture,
    WatchedVehicle,
    build_traffic_picture,
    hold_outcome,
    plane_of,
)

Watchdog = Callable[[TrafficPicture], Iterable[Finding]]

WATCHDOGS: tuple[Watchdog, ...] = (
    separation,
    fences,
    battery_home,
    link,
    heights,
    jumps,
    sticks,
)

__all__ = [
    "WATCHDOGS",
    "CommandedHold",
    "Finding",
    "PreviousPosition",
    "TrafficPicture",
    "Watchdog",
    "WatchdogSettings",
    "WatchedVehicle",
    "build_traffic_picture",
    "hold_outcome",
    "plane_of",
]
