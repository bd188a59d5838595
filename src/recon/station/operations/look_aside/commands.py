"""Beginning a look aside: guidance gets the imaging drone, and the gate chooses the direction."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from recon.geo.sun import sun_position
from recon.guidance.look_aside import LOOK_ASIDE_SETTINGS, bearings_deg, place_aside
from recon.model.command import GoTo, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, Event, LookAsideOrdered, OperatorOrder
from recon.model.failsafe_matrix import Activity
from recon.model.geo import LatLon
from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleState
from recon.record.audit import AuditEntry
from recon.safety.rules.not_expired import given_refusal
from recon.station.control import handover, order_gateway
from recon.station.control.stop_latch import RULE as STOP_RULE
from recon.station.failsafe.activity import activity_of
from recon.station.state.look_aside_record import LookAside, LookAsideStage
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped
from recon.station.steering.kinematic_state import kinematic_state

RULE = "look_aside"
NO_IMAGER = "the site has no imaging drone"


@dataclass(frozen=True, slots=True)
class LookAsideBegun:
    """The station with a look aside begun, and its packets."""

    station: Station
    outputs: tuple[Output, ...]


def order_look_aside(station: Station, event: LookAsideOrdered, now_ns: int) -> Stepped:
    """Begin a look aside, unless it is refused; then nothing changes."""
    begun = begin(station, event, now_ns)
    return (station, ()) if isinstance(begun, Refusal) else (begun.station, begun.outputs)


def refusal(station: Station, event: LookAsideOrdered, now_ns: int) -> Refusal | None:
    """Return why the imaging drone cannot look aside now, else None."""
    begun = begin(station, event, now_ns)
    return begun if isinstance(begun, Refusal) else None


def begin(station: Station, event: LookAsideOrdered, now_ns: int) -> LookAsideBegun | Refusal:
    """Return the station with a look aside begun, in the first direction that the gate accepts."""
    serial = event.serial or meant(station)
    if serial is None:
        return Refusal(RULE, NO_IMAGER)
    if serial not in station.imaging.imagers:
        known = ", ".join(station.imaging.imagers)
        return Refusal(RULE, f"{serial} is no imaging drone of the site: expected {known}")
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return Refusal(RULE, f"the imaging drone {serial} is not connected")
    late = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, event.by, event.person)
    why = late or _hindrance(station, vehicle, now_ns) or handover.refusal(station, taken, now_ns)
    if why is not None:
        return why
    station, withdrawn = handover.take(station, taken, now_ns)
    tried = _tried(station, vehicle, event, now_ns)
    if isinstance(tried, Refusal):
        return tried
    return LookAsideBegun(tried.station, (*withdrawn, *tried.outputs))


def meant(station: Station) -> str | None:
    """Return the imaging drone to look aside when none is named: light is unknown below it.

    The site's first one if light is known below all of them; None without any.
    """
    unknown = station.look_asides.unknown_since_ns
    return next((s for s in station.imaging.imagers if s in unknown), None) or next(
        iter(station.imaging.imagers), None
    )


def way(station: Station, by: str, serial: str, place: LatLon, height_m: float) -> OperatorOrder:
    """Return the order to fly to a place at a height above takeoff; its number is the next one."""
    body = GoTo(place, height_m, LOOK_ASIDE_SETTINGS.speed_mps)
    return OperatorOrder(
        station.next_own_id,
        body,
        f"{by}: look aside",
        serial=serial,
        role=AuthorityHolder.GUIDANCE,
    )


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
    new, old = after.look_asides.newest, before.look_asides.newest
    if new is not None and (old is None or (old.stage, old.since_ns) != (new.stage, new.since_ns)):
        yield _stage_entry(new)


def _stage_entry(newest: LookAside) -> AuditEntry:
    stage, bearing_deg = newest.stage.value, newest.bearing_deg
    reason = f": {newest.reason}" if newest.reason else ""
    return AuditEntry(
        f"look_aside.{stage}",
        f"look aside to bearing {bearing_deg:.0f} deg: {stage}{reason}",
        newest.by,
        newest.serial,
        newest.name,
        details={"stage": stage, "bearing_deg": bearing_deg, "order": newest.command_id},
    )


def _hindrance(station: Station, vehicle: VehicleState, now_ns: int) -> Refusal | None:
    """Why the imaging drone has no place to leave and come back to."""
    serial, name = vehicle.serial or "", vehicle.display_name
    if station.is_stopped(serial):
        return Refusal(STOP_RULE, f"{name} is held by an all stop; release its stop first")
    newest = station.look_asides.newest
    if newest is not None and not newest.is_over:
        return Refusal(RULE, f"{name} looks aside already")
    if vehicle.is_flying.value is not True:
        return Refusal(RULE, f"{name} is not in the air")
    seen = kinematic_state(vehicle, now_ns)
    if seen is None:
        return Refusal(RULE, f"{name}: position, velocity, height or heading unknown")
    most_mps = LOOK_ASIDE_SETTINGS.resting_mps
    if seen.speed_mps > most_mps:
        return Refusal(
            RULE,
            f"{name} moves at {seen.speed_mps:.1f} m/s; hold it first: a look aside begins below "
            f"{most_mps:g} m/s",
            parameters={"speed_mps": seen.speed_mps, "max_mps": most_mps},
        )
    return None if _is_at_rest(station, vehicle) else Refusal(RULE, f"{name} flies; hold it first")


def _is_at_rest(station: Station, vehicle: VehicleState) -> bool:
    """Whether it holds its position: by itself, or by a steered order that has arrived."""
    activity = activity_of(station, vehicle)
    stream = station.control(vehicle.serial).stream
    has_arrived = stream is not None and stream.arrived_at_ns is not None
    return activity is Activity.HOLDING or (activity is Activity.STEERED and has_arrived)


def _tried(
    station: Station, vehicle: VehicleState, event: LookAsideOrdered, now_ns: int
) -> LookAsideBegun | Refusal:
    """Try each direction; if the gate refuses all, return why it refused the best one."""
    place, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    assert place is not None, "its kinematic state is known"
    assert height_m is not None, "its kinematic state is known"
    first: Refusal | None = None
    for bearing_deg in bearings_deg(_sun_azimuth_deg(station, place, now_ns)):
        aside = place_aside(place, bearing_deg, LOOK_ASIDE_SETTINGS.distance_m)
        order = way(station, event.by, vehicle.serial or "", aside, height_m)
        tried, outputs = order_gateway.submit(take_id(station)[0], order, now_ns)
        record = tried.orders.records[order.command_id]
        if record.phase is not Phase.REFUSED_BY_STATION:
            begun = LookAside(
                serial=vehicle.serial or "",
                name=vehicle.display_name,
                by=event.by,
                begun_at_ns=now_ns,
                place=place,
                height_above_takeoff_m=height_m,
                bearing_deg=bearing_deg,
                command_id=order.command_id,
                stage=LookAsideStage.ASIDE,
                since_ns=now_ns,
                survey_id=event.survey_id,
            )
            asides = replace(tried.look_asides, newest=begun, refused=None)
            return LookAsideBegun(replace(tried, look_asides=asides), outputs)
        first = first or record.refusal
    assert first is not None, "a refused order has its refusal"
    return replace(first, reason=f"{first.reason}; no other direction of 25 m is free")


def _sun_azimuth_deg(station: Station, place: LatLon, now_ns: int) -> float | None:
    """The sun's azimuth by the computer's clock; None before it was read."""
    clock = station.clock
    if clock is None or not place.is_valid():
        return None
    return sun_position(place, ns_to_seconds(now_ns + clock.ahead_ns)).azimuth_deg
