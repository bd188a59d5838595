"""Watchdogs: safety monitors that look at one traffic picture ten times a second. Pure.

Theory of operation. `build_traffic_picture` gathers every vehicle that is or may be in the air and
predicts the next `horizon_s`. Each watchdog yields `Finding`s: an alarm text with a stable key, and
perhaps the serial of a vehicle to hold. A finding's life:

    absent -> found -> lasted `confirm_s` -> hold requested -> effect within `effect_s`
       ^                                        |                 | no effect, or hold failed
       +---- `lingers_s` after the last time ---+                 v
                                                   the other vehicle of the pair is held

A hold is an ordinary order that the gate judges. It is requested only if it helps, only when the
remaining time is little more than stopping takes (`hold_margin_s`), and for one vehicle at most
every `hold_again_s`. A pilot's vehicle is never held, nor one on the ground; fences hold no
vehicle that lands or returns. The station's runner keeps the times between two pictures.
"""

from collections.abc import Callable, Iterable

from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.battery_home import battery_home
from recon.safety.watchdogs.fences import fences
from recon.safety.watchdogs.go_home import go_home
from recon.safety.watchdogs.route_home_zones import route_home_zones
from recon.safety.watchdogs.separation import separation
from recon.safety.watchdogs.telemetry import heights, link, sticks
from recon.safety.watchdogs.traffic_picture import (
    CommandedHold,
    Finding,
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
    go_home,
    route_home_zones,
    link,
    heights,
    sticks,
)
