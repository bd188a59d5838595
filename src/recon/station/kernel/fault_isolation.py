"""What a fault in the station's own code costs: one event, or one vehicle's part of a tick.

The step is pure, so the state before a fault is whole: the driver goes on from it. A fault never
ends a station that aircraft depend on, and never goes unseen.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from recon.model.command import Hover
from recon.model.errors import described
from recon.model.event import Event, OperatorOrder, StationFaulted, SticksDue, Tick
from recon.safety.watchdogs import WATCHDOGS, Finding, Picture, Watchdog
from recon.station.alarms.station_faults import TO_DO, WHOSE, conditions, note
from recon.station.control import order_gateway
from recon.station.kernel.step import TICK_PARTS, raise_alarms
from recon.station.state import alarm_book
from recon.station.state.alarm_book import Severity
from recon.station.state.command_ids import take_id
from recon.station.state.outputs import Output
from recon.station.state.station import Station
from recon.station.state.stepped import Stepped
from recon.station.steering import setpoint_streams
from recon.station.traffic import watchdog_runner

Part = Callable[[Station, int], Stepped]

ISSUER = "station: a fault in its own code"


def after_fault(station: Station, event: Event, fault: Exception, now_ns: int) -> Stepped:
    """Return the station and the outputs of an event whose step raised.

    The event is lost. But time must go on for everybody else: of a tick only the parts that raise
    are lost, and of those that see to vehicles one by one only the vehicles they raise at.
    """
    if isinstance(event, SticksDue):
        return drive_apart(station, now_ns)
    if not isinstance(event, Tick):
        where = f"taking in {type(event).__name__}"
        return note(station, StationFaulted(where, described(fault)), now_ns), ()
    outputs: tuple[Output, ...] = ()
    for name, part in TICK_PARTS.items():
        station, more = _attempt(name, _APART.get(part, part), station, now_ns)
        outputs += more
    return station, outputs


def drive_apart(station: Station, now_ns: int) -> Stepped:
    """Drive each stream by itself. One that fails is ended: its vehicle must not fly on by the last
    stick, and what has failed at this moment may fail at every moment."""
    outputs: tuple[Output, ...] = ()
    for serial in tuple(station.streams):
        where = f"steering {serial}"
        try:
            station, more = order_gateway.drive_streams(station, now_ns, (serial,))
        except Exception as fault:
            station = note(station, StationFaulted(where, described(fault)), now_ns)
            station, more = _attempt(where, partial(_end_stream, serial), station, now_ns)
            if serial in station.streams and station.streams[serial].closing is None:
                station, more = _attempt(where, partial(_hold, serial), station, now_ns)
        outputs += more
    return station, outputs


def watch_apart(station: Station, now_ns: int) -> Stepped:
    """Watch the orders of each vehicle by itself."""
    outputs: tuple[Output, ...] = ()
    serials = {record.command.serial for record in station.orders.tracked}
    for serial in sorted(serial for serial in serials if serial is not None):
        part = partial(_watch_one, serial)
        station, more = _attempt(f"watching the orders of {serial}", part, station, now_ns)
        outputs += more
    return station, outputs


def contained(watchdog: Watchdog) -> Watchdog:
    """Return a watchdog whose own fault is a finding."""

    def look(picture: Picture) -> Iterable[Finding]:
        try:
            return tuple(watchdog(picture))
        except Exception as fault:
            return (_blind(watchdog, fault),)

    return look


def _attempt(name: str, part: Part, station: Station, now_ns: int) -> Stepped:
    try:
        return part(station, now_ns)
    except Exception as fault:
        return note(station, StationFaulted(name, described(fault)), now_ns), ()


def _end_stream(serial: str, station: Station, now_ns: int) -> Stepped:
    return order_gateway.end_stream(station, serial, "a fault in the station's own code", now_ns)


def _hold(serial: str, station: Station, now_ns: int) -> Stepped:
    """When not even the zero can be worked out, a hold still can."""
    station, number = take_id(setpoint_streams.release(station, serial, now_ns))
    order = OperatorOrder(number, Hover(), ISSUER, serial=serial)
    return order_gateway.place(station, order, now_ns)


def _watch_one(serial: str, station: Station, now_ns: int) -> Stepped:
    return order_gateway.watch(station, now_ns, (serial,))


def _blind(watchdog: Watchdog, fault: Exception) -> Finding:
    name = getattr(watchdog, "__name__", "?")
    text = f"{WHOSE}: the watchdog {name} sees nothing: {described(fault)}; {TO_DO}"
    return Finding(f"blind:{name}", "station_fault", Severity.CRITICAL, WHOSE, text)


CONTAINED = tuple(contained(watchdog) for watchdog in WATCHDOGS)


def _look_apart(station: Station, now_ns: int) -> Stepped:
    return watchdog_runner.look(station, now_ns, CONTAINED)


def raise_alarms_apart(station: Station, now_ns: int) -> Stepped:
    """Raise alarms; when they cannot be worked out, those that stand, and the faults'."""
    try:
        return raise_alarms(station, now_ns)
    except Exception as fault:
        station = note(station, StationFaulted("raising alarms", described(fault)), now_ns)
    book = station.alarms
    standing = [alarm.condition for alarm in book.alarms.values() if alarm.is_active]
    present = {c.key: c for c in (*standing, *conditions(station, now_ns))}
    book = alarm_book.update(book, present.values(), now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book), ()


_APART: dict[Part, Part] = {
    order_gateway.drive_streams: drive_apart,
    order_gateway.watch: watch_apart,
    watchdog_runner.look: _look_apart,
    raise_alarms: raise_alarms_apart,
}
"""The parts that are done vehicle by vehicle, or watchdog by watchdog, once they have failed."""
