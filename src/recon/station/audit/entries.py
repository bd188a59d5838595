"""The audit entries of a step. Pure: the same steps give the same entries.

Theory of operation. After every step the auditor calls `audit` with the states before and after it.
Because states are immutable, a field that is the same object has not changed, and most steps cost a
few comparisons. Entries come in the order of cause and effect: commands, operations, links,
flights, authority, orders, alarms. What would flood the file is reduced by a memory kept between
steps (`Auditing`): a stick stream is its start and end, an alarm that begins and ends is written
every five seconds at most, links 120 times a minute, positions every five seconds.

The chain of hashes, numbers and UTC are added by `record/audit/audit_log.py`; this module knows no
clock and no file. Nothing reads the audit back into a station: a restart uses `station/recovery/`.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from recon.model.command import Refusal
from recon.model.event import (
    AlarmAcknowledged,
    AllStopped,
    AppAdmitted,
    AppListFailed,
    AppRefused,
    AuditFailed,
    AuthorityTaken,
    Event,
    HazardDismissed,
    ImagerMarked,
    LinkLimitReached,
    LoginAccepted,
    LoginRefused,
    PreflightOverridden,
    RecordFailed,
    SeparationHoldSwitched,
    SiteRedrawn,
    StopReleased,
    Tick,
    UsersChanged,
    ZoneDrawn,
    ZoneEnded,
)
from recon.record.audit.audit import AuditEntry
from recon.station.audit.alarm_entries import AlarmsLogged, acknowledged_entry, alarm_entries
from recon.station.audit.flight_entries import FlightsLogged, flight_entries
from recon.station.audit.link_entries import LinksLogged, link_entries, pairing_entry
from recon.station.audit.order_entries import OrdersLogged, ended_streams, order_entries
from recon.station.control import (
    handover,
    preflight,
    site_drawing,
    stop_latch,
    temporary_zones,
)
from recon.station.imaging import marking
from recon.station.operations import OPERATIONS
from recon.station.state.station import Station
from recon.station.state.vehicle_control import VehicleControl
from recon.station.traffic import known_traffic

Changed = Iterable[tuple[str, VehicleControl]]


@dataclass(frozen=True, slots=True)
class Auditing:
    """What the entries of the next step depend on, besides the states before and after it."""

    orders: OrdersLogged = field(default_factory=OrdersLogged)
    alarms: AlarmsLogged = field(default_factory=AlarmsLogged)
    links: LinksLogged = field(default_factory=LinksLogged)
    flights: FlightsLogged = field(default_factory=FlightsLogged)


def audit(
    memory: Auditing, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[Auditing, tuple[AuditEntry, ...]]:
    """Return the entries of one step, in the order of cause and effect."""
    entries = list(_commands(before, event, after, now_ns))
    for operation in OPERATIONS:
        entries += operation.audit(before, event, after, now_ns)
    links, new = link_entries(memory.links, before, event, after, now_ns)
    entries += new
    flights, new = flight_entries(memory.flights, before, event, after, now_ns)
    entries += new
    changed = after.controls_changed_since(before)
    entries += _authorities(before, after, changed)
    entries += _leases(before, after, changed)
    entries += _overrides(before, after, changed)
    entries += _temporary_zones(before, event, after)
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


def _commands(before: Station, event: Event, after: Station, now_ns: int) -> Iterator[AuditEntry]:
    """Operator commands that are not orders to one vehicle."""
    match event:
        case AlarmAcknowledged(alarm_id, by) if alarm_id in before.alarms.alarms:
            yield acknowledged_entry(before.alarms.alarms[alarm_id], by)
        case AuthorityTaken(serial=serial, by=by):
            refused = handover.refusal(before, event, now_ns)
            yield from _refused(after, "authority", refused, by, serial)
        case PreflightOverridden(serial=serial, by=by):
            yield from _refused(after, "preflight", preflight.refusal(before, event), by, serial)
        case AppAdmitted() | AppRefused():
            yield pairing_entry(before, event)
        case AllStopped(by):
            text = "all stop: nothing moves a vehicle until a person releases it"
            yield AuditEntry("all_stop.latched", text, by)
        case StopReleased():
            yield _released(before, event)
        case ZoneDrawn(by=by):
            yield from _zone_refused(temporary_zones.draw_refusal(before, event), by)
        case ZoneEnded(by=by):
            yield from _zone_refused(temporary_zones.end_refusal(before, event), by)
        case SiteRedrawn():
            yield site_drawing.entry(before, event, now_ns)
        case ImagerMarked():
            yield marking.entry(event)
        case HazardDismissed(serial, by):
            name = known_traffic.lost_key(before, serial) or serial
            yield _about(before, "hazard.dismissed", "hazard area dismissed", by, name)
        case SeparationHoldSwitched(is_on, by):
            word = "on" if is_on else "off"
            text = f"separation holds switched {word}"
            yield AuditEntry("separation_hold.switched", text, by, details={"is_on": is_on})
        case _:
            yield from _own_events(event)


def _own_events(event: Event) -> Iterator[AuditEntry]:
    """The station's own events: logins, and trouble with its files and links."""
    match event:
        case AppListFailed(problem):
            yield _trouble("app.list_trouble", problem, "the list of apps is written again")
        case AuditFailed(problem):
            text = "audit and recovery snapshot are written again"
            yield _trouble("audit.trouble", problem, text)
        case RecordFailed(problem):
            yield _trouble("record.trouble", problem, "everything is recorded again")
        case UsersChanged(change, problem):
            yield _trouble("users.changed", problem, change)
        case LoginAccepted(by, role):
            yield AuditEntry("login.accepted", f"logged in as {role}", by, details={"role": role})
        case LoginRefused(address, failures):
            text = f"wrong token from {address}, number {failures} within a minute"
            yield AuditEntry("login.refused", text, details={"address": address})
        case LinkLimitReached(limit, problem):
            text = problem or f"link server: limit of {limit} no longer reached"
            details = {"limit": limit, "is_reached": problem is not None}
            yield AuditEntry("link.limit", text, details=details)


def _trouble(kind: str, problem: str | None, ended: str) -> AuditEntry:
    """Return the entry of a trouble: what it is, or that it has ended."""
    return AuditEntry(kind, problem or ended, details={"is_troubled": problem is not None})


def _released(before: Station, event: StopReleased) -> AuditEntry:
    refusal = stop_latch.refusal(before, event)
    if refusal is not None:
        details: dict[str, Any] = {"rule": refusal.rule, "reason": refusal.reason}
        return AuditEntry(
            "all_stop.refused", f"refused: {refusal.reason}", event.by, None, "", details
        )
    serials = None if event.serials is None else list(event.serials)
    which = "every vehicle" if serials is None else ", ".join(serials)
    text = f"all stop released for {which}"
    return AuditEntry("all_stop.released", text, event.by, details={"serials": serials})


def _refused(
    station: Station, what: str, refusal: Refusal | None, by: str, serial: str
) -> Iterator[AuditEntry]:
    """A refused command; an accepted one is written with its effect."""
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
        text = f"authority: {held.holder.value}: {held.reason}"
        by = held.holder_name or held.holder.value
        yield _about(after, "authority.taken", text, by, serial, details)


def _leases(before: Station, after: Station, changed: Changed) -> Iterator[AuditEntry]:
    """Yield each change of the person who operates a vehicle; not each order of the same one."""
    for serial, control in changed:
        lease, was = control.lease, before.control(serial).lease
        person = None if lease is None else lease.person
        former = None if was is None else was.person
        if person == former:
            continue
        details = {"person": person, "from": former}
        if person is None:
            text = f"operator lease of {former} ended"
            yield _about(after, "lease.ended", text, "station", serial, details)
        else:
            text = (
                f"operated by {person}"
                if former is None
                else f"taken over by {person} from {former}"
            )
            kind = "lease.taken" if former is None else "lease.taken_over"
            yield _about(after, kind, text, person, serial, details)


def _overrides(before: Station, after: Station, changed: Changed) -> Iterator[AuditEntry]:
    for serial, control in changed:
        override, was = control.preflight_override, before.control(serial).preflight_override
        if override is was:
            continue
        if override is not None:
            text = f"preflight checklist overridden: {override.reason}"
            details = {"reason": override.reason}
            yield _about(after, "preflight.overridden", text, override.by, serial, details)
        else:
            text = "preflight override ended"
            yield _about(after, "preflight.override_ended", text, "station", serial)


def _temporary_zones(before: Station, event: Event, after: Station) -> Iterator[AuditEntry]:
    """Zones drawn and ended, by a person or by their time."""
    old, new = before.temporary_zones.in_force, after.temporary_zones.in_force
    if old is new:
        return
    yield from (
        temporary_zones.entry("drawn", zone, zone.by) for key, zone in new.items() if key not in old
    )
    by = event.by if isinstance(event, ZoneEnded) else "station"
    yield from (
        temporary_zones.entry("ended", zone, by) for key, zone in old.items() if key not in new
    )


def _zone_refused(refusal: Refusal | None, by: str) -> Iterator[AuditEntry]:
    if refusal is not None:
        details = {"rule": refusal.rule, "reason": refusal.reason}
        text = f"refused: {refusal.reason}"
        yield AuditEntry("temporary_zone.refused", text, by, details=details)


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
