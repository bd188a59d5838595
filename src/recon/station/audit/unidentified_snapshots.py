"""Where vehicles without a serial were last seen flying, in the words of the audit.

They are known by what their hazard areas are dismissed by. A line every five seconds while one
flies and has had the time to say its serial, one when its link ends in flight, and one when it has
landed or said who it is: so that the last line of each tells a new start whether it may still be in
the air.
"""

from collections.abc import Iterable, Mapping

import msgspec

from recon.model.event import Event, LinkClosed, PacketReceived
from recon.model.report import CoreReport, ExtendedReport
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.record.audit import AuditEntry
from recon.station.audit.vehicle_snapshots import FLYING_EVERY_S, sighting_of
from recon.station.state.station import Station
from recon.station.traffic import identity_grace
from recon.station.traffic.known_traffic import lost_name

UNIDENTIFIED_KIND = "vehicle.unidentified"
UNIDENTIFIED_GONE_KIND = "vehicle.unidentified_gone"

Told = Mapping[str, int]
"""When each was last written down, by name."""


def unidentified_entries(
    told: Told, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[Told, tuple[AuditEntry, ...]]:
    """Return what an event shows of vehicles without a serial that is to be written down."""
    match event:
        case PacketReceived(link_id, CoreReport() | ExtendedReport()):
            return _heard(told, link_id, after, now_ns)
        case LinkClosed(link_id):
            name = lost_name(link_id)
            new = {
                key: s
                for key, s in after.watchdog_state.lost.items()
                if key not in before.watchdog_state.lost
            }
            entries = [unidentified_entry(after, key, state) for key, state in new.items()]
            if name in told and name not in new:
                entries.append(_gone(name))
            return _without(told, name), tuple(entries)
    return told, ()


def unidentified_entry(station: Station, name: str, vehicle: VehicleState) -> AuditEntry:
    """Return an audit entry that carries a sighting of a vehicle without a serial."""
    sighting: dict[str, object] = msgspec.to_builtins(sighting_of(station, vehicle))
    text = f"{vehicle.display_name}: flies without a serial"
    return AuditEntry(UNIDENTIFIED_KIND, text, details={"name": name, **sighting})


def restored_entries(station: Station) -> Iterable[AuditEntry]:
    """Return what a restored station tells of those without a serial, for the next start."""
    return [unidentified_entry(station, name, s) for name, s in station.watchdog_state.lost.items()]


def _heard(
    told: Told, link_id: int, after: Station, now_ns: int
) -> tuple[Told, tuple[AuditEntry, ...]]:
    name, link = lost_name(link_id), after.fleet.links.get(link_id)
    if link is None or link.claimed_serial is not None or not link.own_state.is_flying.value:
        return (_without(told, name), (_gone(name),)) if name in told else (told, ())
    if link_id not in after.watchdog_state.unidentified_since_ns:
        return told, ()
    if identity_grace.may_yet_say_its_serial(after, link.own_state, now_ns):
        return told, ()
    if now_ns - told.get(name, -seconds_to_ns(FLYING_EVERY_S)) < seconds_to_ns(FLYING_EVERY_S):
        return told, ()
    return {**told, name: now_ns}, (unidentified_entry(after, name, link.own_state),)


def _gone(name: str) -> AuditEntry:
    text = f"{name}: is on the ground, or has said its serial"
    return AuditEntry(UNIDENTIFIED_GONE_KIND, text, details={"name": name})


def _without(told: Told, name: str) -> Told:
    return {key: at_ns for key, at_ns in told.items() if key != name} if name in told else told
