"""Takeoffs, landings and positions in the audit.

One entry per vehicle every five seconds in the air and every minute on the ground, and one
whenever a flight begins or ends or its link closes, home is set, or its telemetry is doubted.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from recon.model.event import Event, LinkClosed, PacketReceived
from recon.model.geo import LatLon
from recon.model.report import CoreReport
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.record.audit.audit import AuditEntry
from recon.safety.go_home import asked_height_m
from recon.station.state.station import Station

POSITION_KIND = "vehicle.position"
TOOK_OFF_KIND = "vehicle.took_off"
LANDED_KIND = "vehicle.landed"
FLYING_KIND = "vehicle.flying"
HOME_KIND = "vehicle.home_set"
GO_HOME_KIND = "vehicle.goes_home"
DOUBT_KIND = "vehicle.doubted"
DOUBT_ENDED_KIND = "vehicle.believed"

FLYING_EVERY_S = 5.0
GROUNDED_EVERY_S = 60.0
MAX_REMEMBERED = 512


@dataclass(frozen=True, slots=True)
class FlightsLogged:
    """Times at which each vehicle's position was last written, by serial."""

    written_at_ns: Mapping[str, int] = field(default_factory=dict)


def flight_entries(
    memory: FlightsLogged, before: Station, event: Event, after: Station, now_ns: int
) -> tuple[FlightsLogged, tuple[AuditEntry, ...]]:
    """Return the entry of a packet or a closed link, if one is due."""
    entries = tuple(_entries(memory, before, event, after, now_ns))
    if not entries:
        return memory, ()
    written = {**memory.written_at_ns, **{entry.serial or "": now_ns for entry in entries}}
    return FlightsLogged(dict(list(written.items())[-MAX_REMEMBERED:])), entries


def _entries(
    memory: FlightsLogged, before: Station, event: Event, after: Station, now_ns: int
) -> Iterator[AuditEntry]:
    match event:
        case PacketReceived(link_id, CoreReport()):
            vehicle = after.fleet.vehicle_of_link(link_id)
            if vehicle is not None and vehicle.serial is not None:
                old = before.fleet.vehicles.get(vehicle.serial)
                kind, text = _due(memory, old, vehicle, now_ns)
                if kind:
                    yield _entry(kind, text, after, vehicle)
                yield from _trust_entries(old, after, vehicle)
                yield from _go_home_entries(old, after, vehicle)
        case LinkClosed(link_id):
            vehicle = before.fleet.vehicle_of_link(link_id)
            if vehicle is not None and vehicle.serial is not None and vehicle.is_flying.value:
                yield _entry(POSITION_KIND, "last position before its link closed", after, vehicle)


def _due(
    memory: FlightsLogged, old: VehicleState | None, vehicle: VehicleState, now_ns: int
) -> tuple[str, str]:
    """Return the kind and text of the entry that is due; empty when none is."""
    serial = vehicle.serial or ""
    was_up = None if old is None else _has_flown(old)
    match was_up, _has_flown(vehicle):
        case False, True:
            return TOOK_OFF_KIND, "took off"
        case True, False:
            return LANDED_KIND, "landed"
    written_ns = memory.written_at_ns.get(serial)
    if written_ns is None and vehicle.is_flying.value:
        return FLYING_KIND, "in flight at first contact"
    every_s = FLYING_EVERY_S if vehicle.is_flying.value else GROUNDED_EVERY_S
    if written_ns is None or now_ns - written_ns >= seconds_to_ns(every_s):
        return POSITION_KIND, "position"
    return "", ""


def _has_flown(vehicle: VehicleState) -> bool | None:
    """Whether it has flown since it was last believed on the ground; None: neither is known."""
    if vehicle.is_flying.value is False:
        return False
    evidence = vehicle.trust.evidence
    if evidence.flown_at_ns is not None:
        return True
    return None if evidence.ground is None else False


def _trust_entries(
    old: VehicleState | None, station: Station, vehicle: VehicleState
) -> Iterator[AuditEntry]:
    """Yield an entry for a new home, and for each doubt that begins or is resolved."""
    home = vehicle.takeoff_point
    if home is not None and (old is None or old.takeoff_point != home):
        place = f"{home.latitude_deg:.6f}, {home.longitude_deg:.6f}"
        yield _entry(HOME_KIND, f"home set at takeoff: {place}", station, vehicle)
    if old is None or old.trust.doubts is vehicle.trust.doubts:
        return
    known = {doubt.kind: doubt.text for doubt in old.trust.doubts}
    for doubt in vehicle.trust.doubts:
        before = known.pop(doubt.kind, None)
        if before is None or _without_figures(before) != _without_figures(doubt.text):
            yield _entry(DOUBT_KIND, doubt.text, station, vehicle)
    for text in known.values():
        yield _entry(DOUBT_ENDED_KIND, f"no longer: {text}", station, vehicle)


def _go_home_entries(
    old: VehicleState | None, station: Station, vehicle: VehicleState
) -> Iterator[AuditEntry]:
    """Yield an entry when the aircraft begins to go home: what it is asked, and what is seen."""
    flight = vehicle.go_home
    if flight is None or (old is not None and old.go_home is not None):
        return
    asked_m = asked_height_m(vehicle)
    height = "at an unknown go-home height" if asked_m is None else f"at {asked_m:.0f} m asked"
    far = "" if flight.nearest_m is None else f", {flight.nearest_m:.0f} m away"
    yield _entry(GO_HOME_KIND, f"goes home {height}{far}", station, vehicle)


def _without_figures(text: str) -> str:
    """A doubt whose figures change is the same doubt."""
    return "".join(letter for letter in text if not letter.isdigit())


def _entry(kind: str, text: str, station: Station, vehicle: VehicleState) -> AuditEntry:
    name = vehicle.display_name
    velocity = vehicle.velocity_ned.value
    control = station.control(vehicle.serial)
    details: dict[str, Any] = {
        "is_flying": vehicle.is_flying.value,
        "reported_is_flying": vehicle.reported_is_flying.value,
        "position": _position(vehicle.position.value),
        "height_above_takeoff_m": vehicle.height_above_takeoff_m.value,
        "velocity_north_mps": None if velocity is None else velocity.north_mps,
        "velocity_east_mps": None if velocity is None else velocity.east_mps,
        "velocity_down_mps": None if velocity is None else velocity.down_mps,
        "battery_fraction": vehicle.battery_fraction.value,
        "takeoff_point": _position(vehicle.takeoff_point),
        "holder": control.authority.holder.value,
        "commanded": control.intent.commanded.value,
    }
    return AuditEntry(kind, f"{name}: {text}", "station", vehicle.serial, name, details)


def _position(point: LatLon | None) -> dict[str, float] | None:
    if point is None:
        return None
    return {"latitude_deg": point.latitude_deg, "longitude_deg": point.longitude_deg}
