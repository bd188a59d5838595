"""What a step changed that belongs into the audit. Pure: the same steps give the same entries."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from recon.model.command import Refusal
from recon.model.event import (
    AlarmAcknowledged,
    AuditTroubled,
    AuthorityTaken,
    Event,
    HazardDismissed,
    PreflightOverridden,
    SeparationHoldSwitched,
    Tick,
)
from recon.record.audit import AuditEntry
from recon.station.audit.alarm_entries import AlarmsLogged, alarm_entries, seen_entry
from recon.station.audit.flight_entries import FlightsLogged, flight_entries
from recon.station.audit.link_entries import LinksLogged, link_entries
from recon.station.audit.order_entries import OrdersLogged, ended_streams, order_entries
from recon.station.control import authority, preflight
from recon.station.operations import OPERATIONS
from recon.station.state.station import Station
from recon.station.state.vehicle_control import VehicleControl
from recon.station.traffic import known_traffic

Changed = Iterable[tuple[str, VehicleControl]]


@dataclass(frozen=True, slots=True)
class Auditing:
    """What the entries of the next step depend on, beside the states before and after it."""

    orders: OrdersLogged = field(default_factory=OrdersLogged)
    alarms: AlarmsLogged = field(default_factory=AlarmsLogged)
    links: LinksLogged = field(default_factory=LinksLogged)
    flights: FlightsLogged = field(default_factory=FlightsLogged)


def audit(
    memory: Auditing, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[Auditing, tuple[AuditEntry, ...]]:
    """Return the entries of one step, in the order of cause and effect."""
    entries = list(_words(before, event, after))
    for operation in OPERATIONS:
        entries += operation.audit(before, event, after, now_ns)
    links, new = link_entries(memory.links, before, event, after, now_ns)
    entries += new
    flights, new = flight_entries(memory.flights, before, event, after, now_ns)
    entries += new
    changed = after.controls_changed_since(before)
    entries += _authorities(before, after, changed)
    entries += _overrides(before, after, changed)
    orders = memory.orders
    if after.orders is not before.orders:
        orders, new = order_entries(orders, before.orders, after.orders, now_ns)
        entries += new
    if isinstance(event, Tick):
        orders, new = ended_streams(orders, now_ns)
        entries += new
    alarms = memory.alarms
    if after.alarms is not before.alarms:
        alarms, new = alarm_entries(alarms, after.alarms, now_ns)
        entries += new
    return Auditing(orders, alarms, links, flights), tuple(entries)


def _words(before: Station, event: Event, after: Station) -> Iterator[AuditEntry]:
    """What somebody said that is no order to one vehicle."""
    match event:
        case AlarmAcknowledged(alarm_id, by) if alarm_id in before.alarms.alarms:
            yield seen_entry(before.alarms.alarms[alarm_id], by)
        case AuthorityTaken(serial=serial, by=by):
            yield from _refused(after, "authority", authority.refusal(before, event), by, serial)
        case PreflightOverridden(serial=serial, by=by):
            yield from _refused(after, "preflight", preflight.refusal(before, event), by, serial)
        case HazardDismissed(serial, by):
            name = known_traffic.lost_as(before, serial) or serial
            yield _about(before, "hazard.dismissed", "is no longer counted as in the air", by, name)
        case SeparationHoldSwitched(is_on, by):
            word = "on" if is_on else "off"
            text = f"the separation watchdog's holds were switched {word}"
            yield AuditEntry("separation_hold.switched", text, by, details={"is_on": is_on})
        case AuditTroubled(problem):
            text = problem or "the audit can be written again"
            yield AuditEntry("audit.trouble", text, details={"is_troubled": problem is not None})


def _refused(
    station: Station, what: str, refusal: Refusal | None, by: str, serial: str
) -> Iterator[AuditEntry]:
    """A word that changed nothing; what it would have changed is new where it did."""
    if refusal is not None:
        details = {"rule": refusal.rule, "reason": refusal.reason}
        yield _about(station, f"{what}.refused", f"refused: {refusal.reason}", by, serial, details)


def _authorities(before: Station, after: Station, changed: Changed) -> Iterator[AuditEntry]:
    for serial, control in changed:
        held, was = control.authority, before.control(serial).authority
        if held is was or (held.holder, held.holder_name) == (was.holder, was.holder_name):
            continue
        details = {
            "holder": held.holder.value,
            "holder_name": held.holder_name,
            "from": was.holder.value,
            "reason": held.reason,
        }
        text = f"is led by the {held.holder.value} now: {held.reason}"
        by = held.holder_name or held.holder.value
        yield _about(after, "authority.taken", text, by, serial, details)


def _overrides(before: Station, after: Station, changed: Changed) -> Iterator[AuditEntry]:
    for serial, control in changed:
        override, was = control.preflight_override, before.control(serial).preflight_override
        if override is was:
            continue
        if override is not None:
            text = f"may fly without its preflight checklist: {override.reason}"
            details = {"reason": override.reason}
            yield _about(after, "preflight.overridden", text, override.by, serial, details)
        else:
            text = "needs its preflight checklist again"
            yield _about(after, "preflight.override_ended", text, "station", serial)


def _about(
    station: Station,
    kind: str,
    text: str,
    by: str,
    serial: str,
    details: Mapping[str, Any] | None = None,
) -> AuditEntry:
    vehicle = station.fleet.vehicles.get(serial)
    profile = station.fleet.profiles.get(serial)
    known = vehicle or profile
    name = serial if known is None else known.display_name
    return AuditEntry(kind, f"{name}: {text}", by, serial, name, details or {})
