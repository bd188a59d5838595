"""The one shape of an operation: what several vehicles do together, for minutes."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from recon.fleet.app_facts import TakenPhoto
from recon.model.event import Event
from recon.model.shade import ShadeMap
from recon.model.vehicle import VehicleState
from recon.record.audit.audit import AuditEntry
from recon.station.state.alarm_book import Condition
from recon.station.state.station import Station
from recon.station.state.steps import Handled, Stepped


def _no_entries(
    _before: Station, _event: Event, _after: Station, _now_ns: int
) -> Iterator[AuditEntry]:
    return iter(())


@dataclass(frozen=True, slots=True)
class Operation:
    """The functions by which the kernel, the alarms and the audit run an operation.

    All are pure. The operation's own state is in `Station`. Its jobs are in no field: a `JobKind`
    carries what takes its result. Its view is in `api_views`, for the API's schema names it.
    """

    name: str
    """Name in a fault's alarm, such as "advancing the survey"."""
    tick: Callable[[Station, int], Stepped]
    """Performs its step on every tick, 20 times a second."""
    conditions: Callable[[Station], Iterator[Condition]]
    """What an operator must see to."""
    commands: tuple[Handled, ...] = ()
    """Operator commands: a type of event and its handler, each."""
    audit: Callable[[Station, Event, Station, int], Iterator[AuditEntry]] = _no_entries
    """Entries for a step: state before, event, state after, station time in ns."""
    on_position: Callable[[Station, VehicleState, int], Station] | None = None
    """Takes core telemetry of a vehicle, up to 10 times a second for each."""
    on_photos: Callable[[Station, VehicleState, tuple[TakenPhoto, ...]], Station] | None = None
    """Takes the new photos that a vehicle's app reports."""
    on_shade: Callable[[Station, ShadeMap], Station] | None = None
    """Takes each new shade map."""
