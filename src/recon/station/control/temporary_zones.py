"""Temporary zones in force. The only writer of `Station.temporary_zones`, and of their part of
`Station.airspace`.

Theory of operation.

    drawn by a person --> in force --ended by a person, or its time is over--> gone

A zone in force is a keep-out zone of the airspace from the step that draws it on: the gate judges
by it every order, the next part of a mission, what waits to be sent, and each packet of a setpoint
stream; the watchdogs hold, within their period, what is about to enter it, and raise an alarm for
what is in it; surveys and fleet returns plan anew. Nothing else is stored, so that ending it is the
same in reverse. Nothing that was held resumes automatically. Only a person draws one; its end is an
alarm unless a person has ended it.
"""

from dataclasses import asdict
from types import MappingProxyType

from recon.model.command import Refusal
from recon.model.event import ZoneDrawn, ZoneEnded
from recon.model.replacing import replace
from recon.model.temporary_zone import TemporaryZone
from recon.model.units import seconds_to_ns
from recon.record.audit.audit import AuditEntry
from recon.safety.airspace import PreparedAirspace, PreparedZone
from recon.safety.temporary_zones import MOST_ZONES, drawn_fault, prepared_temporary_zone
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Station
from recon.station.state.steps import Stepped

RULE = "temporary_zone"
NO_SITE = "a temporary zone needs a site with an origin; start the station with --site FOLDER"


def draw_refusal(station: Station, event: ZoneDrawn) -> Refusal | None:
    """Return why a zone cannot be drawn, else None."""
    frame = station.airspace.airspace.frame
    if frame is None:
        return Refusal(RULE, NO_SITE)
    if len(station.temporary_zones.in_force) >= MOST_ZONES:
        return Refusal(RULE, f"{MOST_ZONES} temporary zones are in force; end one of them first")
    fault = drawn_fault(event.drawn, frame)
    return None if fault is None else Refusal(RULE, f"the zone was not drawn: {fault}")


def draw(station: Station, event: ZoneDrawn, now_ns: int) -> Station:
    """Return the station with one more zone in force, unless that is refused."""
    if draw_refusal(station, event) is not None:
        return station
    lasts_s, number = event.drawn.lasts_s, station.temporary_zones.next_id
    ends_at_ns = None if lasts_s is None else now_ns + seconds_to_ns(lasts_s)
    zone = TemporaryZone(number, event.drawn, event.by, now_ns, ends_at_ns)
    return _with_zone(station, zone)


def end_refusal(station: Station, event: ZoneEnded) -> Refusal | None:
    """Return why a zone cannot be ended, else None."""
    in_force = station.temporary_zones.in_force
    if event.zone_id in in_force:
        return None
    known = ", ".join(f"{zone.id} ({zone.name})" for zone in in_force.values()) or "none"
    return Refusal(
        RULE, f"no temporary zone {event.zone_id} is in force; those in force are: {known}"
    )


def end(station: Station, event: ZoneEnded, _now_ns: int) -> Station:
    """Return the station without a zone, unless that is refused. Nothing is sent."""
    zone = station.temporary_zones.in_force.get(event.zone_id)
    return station if zone is None else _without_zone(station, zone)


def end_due(station: Station, now_ns: int) -> Stepped:
    """Return the station without the zones whose time is over, with an alarm for each."""
    for zone in station.temporary_zones.in_force.values():
        if zone.ends_at_ns is not None and now_ns >= zone.ends_at_ns:
            station = _without_zone(station, zone)
            text = (
                f"temporary zone {zone.name} has ended, its time is over: flights may enter it; "
                "draw it again if it is still needed"
            )
            station = _noted(station, zone, "temporary_zone_ended", text, now_ns)
    return station, ()


def restore(
    station: Station, zones: tuple[TemporaryZone, ...], next_id: int, now_ns: int
) -> Station:
    """Return the station with the zones of the last run; an alarm for each that cannot be used."""
    frame = station.airspace.airspace.frame
    for zone in zones[:MOST_ZONES]:
        fault = NO_SITE if frame is None else drawn_fault(zone.drawn, frame)
        if fault is None and zone.id not in station.temporary_zones.in_force:
            station = _with_zone(station, zone)
        elif fault is not None:
            text = f"temporary zone {zone.name} of the last run is not in force: {fault}"
            station = _noted(station, zone, "temporary_zone_lost", text, now_ns)
    known = station.temporary_zones
    return replace(station, temporary_zones=replace(known, next_id=max(known.next_id, next_id)))


def moved_to(station: Station, airspace: PreparedAirspace) -> Station:
    """Return the station with another airspace of the site, and the same temporary zones in it.

    Surveys plan their rows anew, as when a zone is drawn.
    """
    return _changed(replace(station, airspace=airspace), station.airspace.temporary_zones)


def entry(verb: str, zone: TemporaryZone, by: str) -> AuditEntry:
    """Return the entry of a temporary zone: what was drawn, and by whom."""
    drawn = zone.drawn
    details = {
        "id": zone.id,
        "kind": drawn.kind.value,
        "shape": asdict(drawn.shape),
        "floor_m": drawn.floor_m,
        "ceiling_m": drawn.ceiling_m,
        "reason": drawn.reason,
        "lasts_s": drawn.lasts_s,
        "drawn_by": zone.by,
    }
    text = f"temporary zone {zone.name} {verb}: {drawn.reason}"
    return AuditEntry(f"temporary_zone.{verb}", text, by, details=details)


def _with_zone(station: Station, zone: TemporaryZone) -> Station:
    frame, zones = station.airspace.airspace.frame, station.temporary_zones
    assert frame is not None, "without a frame no zone is drawn or restored"
    prepared = prepared_temporary_zone(zone, frame)
    return _changed(
        replace(
            station,
            temporary_zones=replace(
                zones,
                in_force=MappingProxyType({**zones.in_force, zone.id: zone}),
                next_id=max(zones.next_id, zone.id + 1),
            ),
        ),
        (*station.airspace.temporary_zones, prepared),
    )


def _without_zone(station: Station, zone: TemporaryZone) -> Station:
    zones = station.temporary_zones
    left = MappingProxyType({key: each for key, each in zones.in_force.items() if key != zone.id})
    kept = (each for each in station.airspace.temporary_zones if each.zone.name != zone.name)
    return _changed(replace(station, temporary_zones=replace(zones, in_force=left)), tuple(kept))


def _changed(station: Station, prepared: tuple[PreparedZone, ...]) -> Station:
    zones = station.temporary_zones
    return replace(
        station,
        airspace=station.airspace.with_temporary_zones(prepared),
        temporary_zones=replace(zones, changes=zones.changes + 1),
    )


def _noted(station: Station, zone: TemporaryZone, rule: str, text: str, now_ns: int) -> Station:
    condition = Condition(f"{rule}:{zone.id}", Severity.WARNING, rule, "", text)
    return station.with_alarm(condition, now_ns)
