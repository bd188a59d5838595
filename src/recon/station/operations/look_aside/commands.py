"""Beginning a look aside: guidance gets the imaging drone, and the gate chooses the direction."""

from collections.abc import Iterator
from dataclasses import replace

from recon.geo.sun import sun_position
from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, bearings_deg, place_aside
from recon.model.command import GoTo, Refusal
from recon.model.event import Event, LookAsideOrdered
from recon.model.geo import LatLon
from recon.model.units import ns_to_seconds
from recon.record.audit.audit import AuditEntry
from recon.safety.rules.not_expired import given_refusal
from recon.station.imaging.at_work import imagers_at_work
from recon.station.operations.imager_motion.claim import Claimed, claimed
from recon.station.operations.imager_motion.execution import is_refused, put, tried
from recon.station.operations.imager_motion.notices import stage_entries
from recon.station.state.imager_motion import LookAside, MotionStage
from recon.station.state.station import Station
from recon.station.state.steps import Stepped


def order_look_aside(station: Station, event: LookAsideOrdered, now_ns: int) -> Stepped:
    """Begin a look aside, unless it is refused; then nothing changes."""
    begun = begin(station, event, now_ns)
    return (station, ()) if isinstance(begun, Refusal) else begun


def refusal(station: Station, event: LookAsideOrdered, now_ns: int) -> Refusal | None:
    """Return why the imaging drone cannot look aside now, else None."""
    begun = begin(station, event, now_ns)
    return begun if isinstance(begun, Refusal) else None


def begin(station: Station, event: LookAsideOrdered, now_ns: int) -> Stepped | Refusal:
    """Return the station with a look aside begun, in the first direction that the gate accepts."""
    late = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
    if late is not None:
        return late
    serial = event.serial or meant(station)
    drone = claimed(station, LookAside.rule, serial, event.by, event.person, now_ns)
    return drone if isinstance(drone, Refusal) else _begun(drone, event, now_ns)


def meant(station: Station) -> str | None:
    """Return the imaging drone to look aside when none is named: light is unknown below it.

    The first one that shows the field if light is known below all of them; None without any.
    """
    unknown, imagers = station.look_asides.unknown_since_ns, station.imaging.imagers
    present = (*imagers_at_work(station), *imagers)
    return next((s for s in present if s in unknown), None) or next(iter(present), None)


def audit_entries(
    before: Station, event: Event, after: Station, now_ns: int
) -> Iterator[AuditEntry]:
    """Yield an entry for the command, and for each change of stage."""
    if isinstance(event, LookAsideOrdered):
        why = refusal(before, event, now_ns)
        if why is not None:
            details = {"rule": why.rule, "reason": why.reason}
            text = f"look aside refused: {why.reason}"
            serial = event.serial or meant(before)
            yield AuditEntry("look_aside.refused", text, event.by, serial, details=details)
    new = after.look_asides.newest
    if new is not None:
        text = f"look aside to bearing {new.bearing_deg:.0f} deg"
        bearing = {"bearing_deg": new.bearing_deg}
        yield from stage_entries(before.look_asides.newest, new, text, bearing)


def _begun(drone: Claimed, event: LookAsideOrdered, now_ns: int) -> Stepped | Refusal:
    """Try each direction; if the gate refuses all, return why it refused the best one."""
    place, height_m = drone.place, drone.height_above_takeoff_m
    serial, first = drone.vehicle.serial or "", None
    for bearing_deg in bearings_deg(_sun_azimuth_deg(drone.station, place, now_ns)):
        aside = place_aside(place, bearing_deg, LOOK_ASIDE_SETTINGS.distance_m)
        body = GoTo(aside, height_m, LOOK_ASIDE_SETTINGS.speed_mps)
        station, outputs, record = tried(drone.station, LookAside, event.by, serial, body, now_ns)
        if is_refused(record):
            first = first or record.refusal
            continue
        motion = LookAside(
            serial=serial,
            name=drone.vehicle.display_name,
            by=event.by,
            begun_at_ns=now_ns,
            place=place,
            height_above_takeoff_m=height_m,
            bearing_deg=bearing_deg,
            command_id=record.command.id,
            stage=MotionStage.ASIDE,
            since_ns=now_ns,
            survey_id=event.survey_id,
        )
        asides = station.look_asides.not_refused()
        station = put(replace(station, look_asides=asides), motion)
        return station, (*drone.outputs, *outputs)
    assert first is not None, "a refused order has its refusal"
    return replace(
        first, reason=f"{first.reason}; every other direction of 25 m was refused as well"
    )


def _sun_azimuth_deg(station: Station, place: LatLon, now_ns: int) -> float | None:
    """The sun's azimuth by the computer's clock; None before it was read."""
    clock = station.clock
    if clock is None or not place.is_valid():
        return None
    return sun_position(place, ns_to_seconds(now_ns + clock.ahead_ns)).azimuth_deg
