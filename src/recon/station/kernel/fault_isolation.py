"""Fault isolation: a fault in the station's own code costs one event, or one part of a tick.

The step is pure, so the state before a fault is whole, and the driver continues from it. Of a tick
whose step raised, every part is tried separately. A part that sees to several vehicles is tried for
each vehicle separately, and the watchdogs one by one: only what raises is lost. A fault never stops
a station that aircraft depend on, and is always an alarm.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial

from recon.model.command import Hover, issued_by_station
from recon.model.errors import describe_fault
from recon.model.event import Event, OperatorOrder, SetpointsDue, StationFaulted, Tick
from recon.safety.watchdogs import WATCHDOGS, Finding, TrafficPicture, Watchdog
from recon.station.alarms import event_alarms
from recon.station.alarms.conditions import raise_alarms
from recon.station.alarms.event_alarms import FAULT_TO_DO, STATION_NAME, note_fault
from recon.station.control import order_gateway
from recon.station.kernel.watchdog_holds import run_watchdogs
from recon.station.state import alarm_book
from recon.station.state.alarm_book import Severity
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped

Part = Callable[[Station, int], Stepped]

ISSUER = issued_by_station("a fault in its own code")


@dataclass(frozen=True, slots=True)
class TickPart:
    """One part of a tick: what it does, in words for a fault's alarm, and its step.

    `isolated` does the same vehicle by vehicle, for a tick in which something raised.
    """

    name: str
    run: Part
    isolated: Part | None = None


def after_fault(
    parts: Iterable[TickPart], station: Station, event: Event, fault: Exception, now_ns: int
) -> Stepped:
    """Return the station and the outputs of an event whose step raised.

    The event is lost, except a tick and the beat of the setpoint streams: of these only the parts
    and the vehicles that raise are lost.
    """
    if isinstance(event, SetpointsDue):
        return drive_streams_isolated(station, now_ns)
    if not isinstance(event, Tick):
        where = f"handling {type(event).__name__}"
        return note_fault(station, StationFaulted(where, describe_fault(fault)), now_ns), ()
    outputs: tuple[Output, ...] = ()
    for part in parts:
        station, more = attempt(part.name, part.isolated or part.run, station, now_ns)
        outputs += more
    return station, outputs


def drive_streams_isolated(station: Station, now_ns: int) -> Stepped:
    """Drive each setpoint stream separately.

    One that raises is ended: its vehicle must not fly on by the last setpoint, and the fault may
    come again at every beat.
    """
    outputs: tuple[Output, ...] = ()
    for serial in station.streaming:
        where = f"steering {serial}"
        try:
            station, more = order_gateway.update_streams(station, now_ns, (serial,))
        except Exception as fault:
            station = note_fault(station, StationFaulted(where, describe_fault(fault)), now_ns)
            station, more = attempt(where, partial(_end_stream, serial), station, now_ns)
            setpoint_stream = station.control(serial).stream
            if setpoint_stream is not None and setpoint_stream.closing is None:
                station, more = attempt(where, partial(_hold, serial), station, now_ns)
        outputs += more
    return station, outputs


def follow_orders_isolated(station: Station, now_ns: int) -> Stepped:
    """Follow the orders of each vehicle separately."""
    outputs: tuple[Output, ...] = ()
    serials = {record.command.serial for record in station.orders.tracked}
    for serial in sorted(serial for serial in serials if serial is not None):
        part = partial(_follow_orders_of, serial)
        station, more = attempt(f"following the orders of {serial}", part, station, now_ns)
        outputs += more
    return station, outputs


def run_watchdogs_isolated(station: Station, now_ns: int) -> Stepped:
    """Run each watchdog separately."""
    return run_watchdogs(station, now_ns, ISOLATED_WATCHDOGS)


def raise_alarms_isolated(station: Station, now_ns: int) -> Stepped:
    """Raise alarms; if that fails, keep the present ones and add the faults'."""
    try:
        return raise_alarms(station, now_ns)
    except Exception as fault:
        station = note_fault(
            station, StationFaulted("raising alarms", describe_fault(fault)), now_ns
        )
    book = station.alarms
    standing = [alarm.condition for alarm in book.alarms.values() if alarm.is_active]
    present = {c.key: c for c in (*standing, *event_alarms.fault_conditions(station, now_ns))}
    book = alarm_book.update(book, present.values(), now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book), ()


def isolated(watchdog: Watchdog) -> Watchdog:
    """Return a watchdog that reports a fault of its own as a finding."""

    def find(picture: TrafficPicture) -> Iterable[Finding]:
        try:
            return tuple(watchdog(picture))
        except Exception as fault:
            name = getattr(watchdog, "__name__", "?")
            what = f"the watchdog {name} has failed: {describe_fault(fault)}"
            text = f"{STATION_NAME}: {what}; {FAULT_TO_DO}"
            key = f"watchdog_failed:{name}"
            return (Finding(key, "station_fault", Severity.CRITICAL, STATION_NAME, text),)

    return find


ISOLATED_WATCHDOGS = tuple(isolated(watchdog) for watchdog in WATCHDOGS)


def attempt(name: str, part: Part, station: Station, now_ns: int) -> Stepped:
    """Run one part; if it raises, return the station before it with the fault recorded."""
    try:
        return part(station, now_ns)
    except Exception as fault:
        return note_fault(station, StationFaulted(name, describe_fault(fault)), now_ns), ()


def _end_stream(serial: str, station: Station, now_ns: int) -> Stepped:
    why = "a fault in the station's own code"
    return order_gateway.end_streams(station, (serial,), why, now_ns)


def _hold(serial: str, station: Station, now_ns: int) -> Stepped:
    """Hold a vehicle whose stream could not even be ended by a neutral setpoint."""
    station, number = take_id(order_gateway.release_stream(station, serial, now_ns))
    order = OperatorOrder(number, Hover(), ISSUER, serial=serial)
    return order_gateway.submit(station, order, now_ns)


def _follow_orders_of(serial: str, station: Station, now_ns: int) -> Stepped:
    return order_gateway.update_orders(station, now_ns, (serial,))
