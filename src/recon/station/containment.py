"""What a fault in the station's own code costs: one event, or one part of a tick, and no more.

The step is pure, so the state before a fault is whole: the driver goes on from it. A fault never
ends a station that aircraft depend on, and never goes unseen.
"""

from collections.abc import Iterable
from functools import partial

from recon.model.event import Event, StationFaulted, Tick
from recon.safety.watchdogs import WATCHDOGS, Finding, Picture, Watchdog
from recon.station import watch
from recon.station.alarms import Severity
from recon.station.commanding import Stepped
from recon.station.faults import TO_DO, WHOSE, described, note
from recon.station.outputs import Output
from recon.station.state import Station
from recon.station.step import TICK_PARTS


def after_fault(station: Station, event: Event, fault: Exception, now_ns: int) -> Stepped:
    """Return the station and the outputs of an event whose step raised.

    The event is lost; of a tick only the parts that raise, and of the watchdogs only those.
    """
    if not isinstance(event, Tick):
        where = f"taking in {type(event).__name__}"
        return note(station, StationFaulted(where, described(fault)), now_ns), ()
    outputs: tuple[Output, ...] = ()
    for name, part in TICK_PARTS.items():
        part = partial(watch.look, watchdogs=CONTAINED) if part is watch.look else part
        try:
            station, more = part(station, now_ns)
        except Exception as problem:
            station = note(station, StationFaulted(name, described(problem)), now_ns)
        else:
            outputs += more
    return station, outputs


def contained(watchdog: Watchdog) -> Watchdog:
    """Return a watchdog whose own fault is a finding."""

    def look(picture: Picture) -> Iterable[Finding]:
        try:
            return tuple(watchdog(picture))
        except Exception as fault:
            return _blind(watchdog, fault)

    return look


def _blind(watchdog: Watchdog, fault: Exception) -> Iterable[Finding]:
    name = getattr(watchdog, "__name__", "?")
    text = f"{WHOSE}: the watchdog {name} sees nothing: {described(fault)}; {TO_DO}"
    return (Finding(f"blind:{name}", "station_fault", Severity.CRITICAL, WHOSE, text),)


CONTAINED = tuple(contained(watchdog) for watchdog in WATCHDOGS)
