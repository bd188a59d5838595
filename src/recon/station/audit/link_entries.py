"""Links in the audit: opened, closed, identified by serial, in conflict.

Any program that reaches the port can connect a thousand times a second: beyond 120 entries a minute
the rest is written as a count.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from recon.fleet import pairing
from recon.fleet.state import LinkRecord
from recon.model.event import (
    AppAdmitted,
    AppRefused,
    Event,
    LinkClosed,
    LinkOpened,
    PacketReceived,
    Tick,
)
from recon.model.report import ImageReport
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.record.audit.audit import AuditEntry
from recon.station.state.station import Station

WINDOW_S = 60.0
MAX_IN_A_WINDOW = 120


@dataclass(frozen=True, slots=True)
class LinksLogged:
    """How many changes of this minute were written, and how many only counted."""

    window_began_ns: int = 0
    written: int = 0
    counted: int = 0


def link_entries(
    memory: LinksLogged, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[LinksLogged, tuple[AuditEntry, ...]]:
    """Return the entries of an event that changes links."""
    entries: list[AuditEntry] = []
    if now_ns - memory.window_began_ns >= seconds_to_ns(WINDOW_S):
        if memory.counted:
            entries.append(_many(memory.counted))
        memory = LinksLogged(now_ns)
    for entry in _changes(before, event, after):
        if memory.written < MAX_IN_A_WINDOW:
            memory = LinksLogged(memory.window_began_ns, memory.written + 1, memory.counted)
            entries.append(entry)
        else:
            memory = LinksLogged(memory.window_began_ns, memory.written, memory.counted + 1)
    return memory, tuple(entries)


def _changes(before: Station, event: Event, after: Station) -> Iterator[AuditEntry]:
    match event:
        case LinkOpened(link_id, remote_address):
            details = {"link_id": link_id, "address": remote_address}
            text = f"app connected: link {link_id} from {remote_address}"
            yield AuditEntry("link.opened", text, details=details)
        case LinkClosed(link_id, reason):
            yield _closed(before, link_id, reason)
        case PacketReceived(link_id) if link_id in after.fleet.links:
            link = after.fleet.links[link_id]
            was = before.fleet.links.get(link_id)
            if link.is_waiting and (was is None or was.waiting_serial != link.waiting_serial):
                yield _waits(after, link)
    for serial in _serials_concerned(event, after):
        vehicle = after.fleet.vehicles.get(serial)
        if vehicle is not None:
            yield from _identity(before.fleet.vehicles.get(serial), vehicle)


def _serials_concerned(event: Event, after: Station) -> Iterable[str]:
    """A packet concerns the vehicle its link claims; time and a closed link can concern any."""
    match event:
        case PacketReceived(_, ImageReport()):
            return ()
        case PacketReceived(link_id):
            link = after.fleet.links.get(link_id)
            return () if link is None or link.claimed_serial is None else (link.claimed_serial,)
        case LinkClosed() | Tick():
            return after.fleet.vehicles
        case AppAdmitted(serial=serial):
            return (serial,)
    return ()


def _closed(before: Station, link_id: int, reason: str) -> AuditEntry:
    vehicle = before.fleet.vehicle_of_link(link_id)
    serial = None if vehicle is None else vehicle.serial
    name = "" if vehicle is None or serial is None else vehicle.display_name
    text = f"app disconnected: link {link_id}{f' of {name}' if name else ''}: {reason}"
    details = {"link_id": link_id, "reason": reason}
    return AuditEntry("link.closed", text, "station", serial, name, details)


def _identity(old: VehicleState | None, vehicle: VehicleState) -> Iterator[AuditEntry]:
    name = vehicle.display_name
    if vehicle.link_id is not None and (old is None or old.link_id != vehicle.link_id):
        simulated = " (simulated)" if vehicle.is_simulated else ""
        text = f"{name}{simulated} is on link {vehicle.link_id}"
        details = {"link_id": vehicle.link_id, "is_simulated": vehicle.is_simulated}
        yield AuditEntry("link.identified", text, "station", vehicle.serial, name, details)
    was_in_conflict = old is not None and old.in_conflict
    if vehicle.in_conflict is not was_in_conflict:
        kind = "link.conflict" if vehicle.in_conflict else "link.conflict_ended"
        words = (
            "two links claim its serial"
            if vehicle.in_conflict
            else "one link claims its serial again"
        )
        rivals = {"link_id": vehicle.link_id, "rival_link_ids": list(vehicle.rival_link_ids)}
        yield AuditEntry(kind, f"{name}: {words}", "station", vehicle.serial, name, rivals)


def _waits(station: Station, link: LinkRecord) -> AuditEntry:
    why = pairing.objection(station.fleet, link)
    text = f"app on link {link.id} from {link.remote_address} waits to be admitted: {why}"
    details = {"link_id": link.id, "address": link.remote_address, "reason": why}
    return AuditEntry("app.waits", text, "station", link.waiting_serial, "", details)


def pairing_entry(before: Station, event: AppAdmitted | AppRefused) -> AuditEntry:
    """Return the entry of what a person decided about a waiting app, or why that was refused."""
    fleet = before.fleet
    link = fleet.links.get(event.link_id)
    address = None if link is None else link.remote_address
    details: dict[str, object] = {"link_id": event.link_id, "address": address}
    if isinstance(event, AppRefused):
        serial = None if link is None else link.waiting_serial
        refusal, done = pairing.refusal_to_refuse(fleet, event), "app.refused"
        text = f"app on link {event.link_id} from {address} refused"
    else:
        serial = event.serial
        refusal, done = pairing.refusal_to_admit(fleet, event), "app.admitted"
        details |= {"is_for_good": event.is_for_good, "any_address": event.any_address}
        place = "any address" if event.any_address else address
        lasting = "for good" if event.is_for_good else "for this run"
        text = f"app with serial {serial} admitted {lasting} from {place}"
    if refusal is None:
        return AuditEntry(done, text, event.by, serial, "", details)
    details |= {"rule": refusal.rule, "reason": refusal.reason}
    return AuditEntry(
        "app.not_changed", f"not done: {refusal.reason}", event.by, serial, "", details
    )


def _many(count: int) -> AuditEntry:
    text = f"{count} more changes of connections in the last minute, not listed"
    return AuditEntry("link.many", text, details={"count": count})
