"""What every step of the station returns, and how steps are looked up and ask the gate."""

from collections.abc import Callable
from typing import Any, TypeVar

from recon.model.command import Command, Refusal
from recon.safety import ApprovedCommand
from recon.station.state.outputs import Output
from recon.station.state.station import Station

EventT = TypeVar("EventT")

Stepped = tuple[Station, tuple[Output, ...]]
"""The station after a step, and what the drivers are to do."""

Judge = Callable[[Station, Command], ApprovedCommand | Refusal]
"""The gate's verdict on one command in a station's state."""

Handler = Callable[[Station, Any, int], Stepped]
"""A step for events of one type: station, event, station time in ns."""

Handled = tuple[type[Any], Handler]
"""A type of event and its handler: a row of the step's table."""


def on(kind: type[EventT], handle: Callable[[Station, EventT, int], Stepped]) -> Handled:
    """Return a row of the step's table, with the handler checked against the event's type."""
    return kind, handle


def changing(kind: type[EventT], change: Callable[[Station, EventT, int], Station]) -> Handled:
    """Return a row of the step's table for a handler that has no outputs."""
    return kind, lambda station, event, now_ns: (change(station, event, now_ns), ())
