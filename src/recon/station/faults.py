"""A fault in the station's own code is told as a critical alarm, until a person has seen it."""

import traceback
from dataclasses import replace
from pathlib import Path

from recon.model.event import StationFaulted
from recon.station import alarms
from recon.station.alarms import Condition, Severity
from recon.station.state import Station

WHOSE = "Station"
TO_DO = "hold or land with the controllers what you are not sure of, and start the station again"


def note(station: Station, event: StationFaulted, now_ns: int) -> Station:
    """Return the station with the alarm of a fault."""
    text = f"{WHOSE}: a fault in its own code, {event.where}: {event.what}; {TO_DO}"
    condition = Condition(
        f"station_fault:{event.where}", Severity.CRITICAL, "station_fault", WHOSE, text
    )
    book = alarms.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book)


def described(fault: BaseException) -> str:
    """Return a fault in one line: what, and the file and line that a repair begins with."""
    frames = traceback.extract_tb(fault.__traceback__)
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(fault).__name__}: {fault}{place}"
