"""Faults in the station's own code: critical alarms while they recur, and until acknowledged."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from recon.model.event import StationFaulted
from recon.model.units import seconds_to_ns
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Fault, Station

WHOSE = "Station"
TO_DO = "hold or land doubtful vehicles with their controllers, then restart the station"


@dataclass(frozen=True, slots=True)
class FaultSettings:
    """Limits for the alarms of faults."""

    lasts_s: float = 10.0
    """A fault that has not recurred for this long has ended."""

    kept: int = 32
    """Different faults shown at once."""


SETTINGS = FaultSettings()


def note(station: Station, event: StationFaulted, now_ns: int) -> Station:
    """Return the station with a fault recorded."""
    first = station.faults.get(event.where)
    since_ns = now_ns if first is None else first.since_ns
    recent = {fault.where: fault for fault in _present(station, now_ns)}
    recent.pop(event.where, None)
    kept = dict(list(recent.items())[-(SETTINGS.kept - 1) :])
    fault = Fault(event.where, event.what, since_ns, now_ns)
    return replace(station, faults={**kept, event.where: fault})


def conditions(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield an alarm for each recent fault."""
    for fault in _present(station, now_ns):
        text = f"{WHOSE}: fault in its own code, {fault.where}: {fault.what}; {TO_DO}"
        key = f"station_fault:{fault.where}"
        yield Condition(key, Severity.CRITICAL, "station_fault", WHOSE, text)


def _present(station: Station, now_ns: int) -> Iterator[Fault]:
    lasts_ns = seconds_to_ns(SETTINGS.lasts_s)
    return (fault for fault in station.faults.values() if now_ns - fault.at_ns <= lasts_ns)
