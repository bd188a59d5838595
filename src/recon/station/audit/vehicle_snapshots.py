"""Where each vehicle was last seen and who led it: what a start after a crash is told by the audit.

One line for a vehicle in the air every five seconds, on the ground every minute, and one whenever a
flight begins or ends. Each holds all that a new start needs of the vehicle, so that the last one of
each is enough.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import msgspec

from recon.model.authority import AuthorityHolder
from recon.model.event import Event, LinkClosed, PacketReceived
from recon.model.geo import LatLon
from recon.model.report import CoreReport
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.record.audit import AuditEntry
from recon.station.state.station import Station
from recon.station.state.vehicle_snapshot import Place, VehicleSnapshot

SEEN_KIND = "vehicle.seen"
TOOK_OFF_KIND = "vehicle.took_off"
LANDED_KIND = "vehicle.landed"
FLYING_KIND = "vehicle.flying"
RESTORED_KIND = "vehicle.restored"
SIGHTING_KINDS = frozenset({SEEN_KIND, TOOK_OFF_KIND, LANDED_KIND, FLYING_KIND, RESTORED_KIND})

FLYING_EVERY_S = 5.0
GROUNDED_EVERY_S = 60.0
MOST_REMEMBERED = 512


@dataclass(frozen=True, slots=True)
class Sightings:
    """When each vehicle was last written down, by serial."""

    written_at_ns: Mapping[str, int] = field(default_factory=dict)


def sighting_of(station: Station, vehicle: VehicleState) -> VehicleSnapshot:
    """Return what is known of a vehicle, as the audit keeps it."""
    velocity = vehicle.velocity_ned.value
    serial = vehicle.serial or ""
    authority, intent = station.authorities.get(serial), station.intents.get(serial)
    return VehicleSnapshot(
        heard_ns=vehicle.core_received_at_ns or 0,
        is_flying=vehicle.is_flying.value,
        is_simulated=vehicle.is_simulated,
        holder=AuthorityHolder.OPERATOR if authority is None else authority.holder,
        holder_name="" if authority is None else authority.holder_name,
        place=_place(vehicle.position.value),
        height_above_takeoff_m=vehicle.height_above_takeoff_m.value,
        velocity_north_mps=None if velocity is None else velocity.north_mps,
        velocity_east_mps=None if velocity is None else velocity.east_mps,
        velocity_down_mps=None if velocity is None else velocity.down_mps,
        battery_fraction=vehicle.battery_fraction.value,
        altitude_offset_m=vehicle.altitude_offset_m.value,
        home=_place(vehicle.takeoff_point),
        altitude_offset_at_takeoff_m=vehicle.altitude_offset_at_takeoff_m,
        commanded="nothing" if intent is None else intent.commanded.value,
        last_command_id=max(station.orders.records, default=0),
        next_own_id=station.next_own_id,
    )


def sightings(
    memory: Sightings, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[Sightings, tuple[AuditEntry, ...]]:
    """Return what an event shows of the vehicles' whereabouts that is to be written down."""
    entries = tuple(_entries(memory, before, event, after, now_ns))
    if not entries:
        return memory, ()
    told = {entry.serial or "": now_ns for entry in entries}
    kept = list({**memory.written_at_ns, **told}.items())[-MOST_REMEMBERED:]
    return replace(memory, written_at_ns=dict(kept)), entries


def sighting_entry(kind: str, text: str, station: Station, vehicle: VehicleState) -> AuditEntry:
    """Return an audit entry that carries a sighting."""
    name = vehicle.display_name
    details = msgspec.to_builtins(sighting_of(station, vehicle))
    return AuditEntry(kind, f"{name}: {text}", "station", vehicle.serial, name, details)


def _entries(
    memory: Sightings, before: Station, event: Event, after: Station, now_ns: int
) -> Iterator[AuditEntry]:
    match event:
        case PacketReceived(link_id, CoreReport()):
            vehicle = after.fleet.vehicle_of_link(link_id)
            if vehicle is not None and vehicle.serial is not None:
                kind, text = _what_is_new(memory, before, vehicle, now_ns)
                if kind:
                    yield sighting_entry(kind, text, after, vehicle)
        case LinkClosed(link_id):
            vehicle = before.fleet.vehicle_of_link(link_id)
            if vehicle is not None and vehicle.serial is not None and vehicle.is_flying.value:
                yield sighting_entry(SEEN_KIND, "where its link ended", after, vehicle)


def _what_is_new(
    memory: Sightings, before: Station, vehicle: VehicleState, now_ns: int
) -> tuple[str, str]:
    serial = vehicle.serial or ""
    old = before.fleet.vehicles.get(serial)
    was = None if old is None else old.is_flying.value
    match was, vehicle.is_flying.value:
        case False, True:
            return TOOK_OFF_KIND, "took off"
        case True, False:
            return LANDED_KIND, "is on the ground"
    written_ns = memory.written_at_ns.get(serial)
    if written_ns is None and vehicle.is_flying.value:
        return FLYING_KIND, "was in the air when it was first heard"
    every_s = FLYING_EVERY_S if vehicle.is_flying.value else GROUNDED_EVERY_S
    if written_ns is None or now_ns - written_ns >= seconds_to_ns(every_s):
        return SEEN_KIND, "seen"
    return "", ""


def _place(place: LatLon | None) -> Place | None:
    return None if place is None else Place(place.latitude_deg, place.longitude_deg)
