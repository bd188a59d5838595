"""The watchdogs: each looks at one picture and says what is wrong. Pure, one file each."""

from collections.abc import Callable, Iterable

from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.battery_home import battery_home
from recon.safety.watchdogs.fences import fences
from recon.safety.watchdogs.finding import Finding
from recon.safety.watchdogs.heights import heights
from recon.safety.watchdogs.jumps import jumps
from recon.safety.watchdogs.link import link
from recon.safety.watchdogs.picture import Before, Held, Picture, WatchedVehicle, hold_words
from recon.safety.watchdogs.separation import separation
from recon.safety.watchdogs.sticks import sticks
from recon.safety.watchdogs.take import plane_of, take_picture

Watchdog = Callable[[Picture], Iterable[Finding]]

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
    "Before",
    "Finding",
    "Held",
    "Picture",
    "Watchdog",
    "WatchdogSettings",
    "WatchedVehicle",
    "hold_words",
    "plane_of",
    "take_picture",
]
