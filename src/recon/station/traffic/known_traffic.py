"""What may be in the air: heard or not, identified or not; and hazard areas taken out of it."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from recon.fleet.identity import has_no_room, without
from recon.model.command import FlyMission, Phase
from recon.model.event import HazardDismissed
from recon.model.intent import Commanded, Intent
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.safety.prediction import HazardArea, hazard_area_of, vehicle_motion
from recon.safety.watchdogs import plane_of
from recon.station.state.station import Station
from recon.station.traffic import identity_grace

LOST_KEPT = 16
"""Vehicles that flew without a serial and were lost: an app that connects again and again must not
fill the air. The rest are one hazard that is nowhere known to be, and so everywhere."""
MANY_LOST = "many-lost"
"""What that one is dismissed by."""


def in_the_air(station: Station) -> Iterator[tuple[VehicleState, str | None]]:
    """Yield every vehicle, and every link without one, that flies or was last known to.

    Beside it the serial that is claimed for it: a link in conflict claims another vehicle's. A
    hazard area that somebody has dismissed is not among them until it is heard again.
    """
    for serial, vehicle in station.fleet.vehicles.items():
        if vehicle.is_flying.value is not False and not is_dismissed(station, vehicle):
            yield vehicle, serial
    for link in station.fleet.unbound_links():
        if link.own_state.is_flying.value is True:
            yield link.own_state, link.claimed_serial
    for state in station.watchdog_state.lost.values():
        yield state, None


def setting_out(station: Station, now_ns: int) -> Iterator[tuple[VehicleState, Intent]]:
    """Yield who is about to fly a mission that telemetry does not show yet, and that mission.

    One whose mission still waits to be sent; and one on the ground that was sent one a moment ago,
    for it may be taking off.
    """
    for record in station.orders.tracked:
        body, serial = record.command.body, record.command.serial
        vehicle = station.fleet.vehicles.get(serial or "")
        if vehicle is not None and isinstance(body, FlyMission) and record.phase is Phase.QUEUED:
            issued_at_ns, number = record.command.issued_at_ns, record.command.id
            yield vehicle, Intent(Commanded.MISSION, issued_at_ns, number, mission=body.mission)
    starts_ns = seconds_to_ns(station.settings.safety.prediction.start_delay_s)
    for serial, control in station.controls.items():
        intent = control.intent
        if intent.commanded is not Commanded.MISSION or now_ns - intent.since_ns > starts_ns:
            continue
        vehicle = station.fleet.vehicles.get(serial)
        if vehicle is not None and vehicle.is_flying.value is False:
            yield vehicle, intent


def hazard(station: Station, vehicle: VehicleState, now_ns: int) -> HazardArea | None:
    """Return where a vehicle may be that is not heard; None for one on the ground or dismissed."""
    if vehicle.is_flying.value is False or vehicle.core_received_at_ns is None:
        return None
    if is_dismissed(station, vehicle):
        return None
    prediction = station.settings.safety.prediction
    plane = plane_of(station.airspace, (vehicle,))
    seen = vehicle_motion(vehicle, station.airspace, plane, now_ns, prediction)
    intent = station.control(vehicle.serial).intent
    return None if seen is None else hazard_area_of(seen, intent, prediction)


def is_dismissed(station: Station, vehicle: VehicleState) -> bool:
    """Return whether somebody has taken a vehicle out of the air, and it was not heard since."""
    dismissed, serial = station.watchdog_state.dismissed, vehicle.serial or ""
    return serial in dismissed and dismissed[serial] == vehicle.core_received_at_ns


def is_hazard_unseen(station: Station, name: str, now_ns: int) -> bool:
    """Return whether a name has a hazard area, or is a vehicle without any position."""
    if lost_as(station, name) is not None:
        return True
    vehicle = station.fleet.vehicles.get(name)
    if vehicle is None or vehicle.core_received_at_ns is None:
        return False
    is_placeless = vehicle.position.value is None and not vehicle.track
    may_fly = vehicle.is_flying.value is not False
    is_out = is_dismissed(station, vehicle)
    return hazard(station, vehicle, now_ns) is not None or (is_placeless and may_fly and not is_out)


def dismiss(station: Station, event: HazardDismissed, now_ns: int) -> Station:
    """Return the station with a hazard area dismissed; unchanged when there is none."""
    if not is_hazard_unseen(station, event.serial, now_ns):
        return station
    watch, key = station.watchdog_state, lost_as(station, event.serial)
    if key is not None:
        lost = {name: state for name, state in watch.lost.items() if name != key}
        return replace(station, watchdog_state=replace(watch, lost=lost))
    heard_at_ns = station.fleet.vehicles[event.serial].core_received_at_ns
    dismissed = {**watch.dismissed, event.serial: heard_at_ns}
    station = replace(station, watchdog_state=replace(watch, dismissed=dismissed))
    return _with_room(station) if has_no_room(station.fleet) else station


def _with_room(station: Station) -> Station:
    """What a person has taken out of the air, and has no link, makes room for others."""
    gone = {
        serial
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.link_id is None and is_dismissed(station, vehicle)
    }
    dismissed = {key: at for key, at in station.watchdog_state.dismissed.items() if key not in gone}
    watch = replace(station.watchdog_state, dismissed=dismissed)
    return replace(station, fleet=without(station.fleet, gone), watchdog_state=watch)


def keep_lost(station: Station, link_id: int) -> Station:
    """Return the station with the vehicle on a link that ends kept as lost.

    Only one that flies, has never reported a serial, and is not connected by another link.
    """
    link = station.fleet.links.get(link_id)
    if link is None or link.claimed_serial is not None or not link.own_state.is_flying.value:
        return station
    if identity_grace.is_heard_by_serial(station, link.own_state):
        return station
    state = link.own_state
    lost = with_lost(station.watchdog_state.lost, lost_name(link_id), state)
    return replace(station, watchdog_state=replace(station.watchdog_state, lost=lost))


def with_lost(
    lost: Mapping[str, VehicleState], name: str, state: VehicleState
) -> Mapping[str, VehicleState]:
    """Return the lost with one more; when there are too many, with one that stands for the rest.

    It has no place, and the gate lets nothing set out while such a one may be in the air.
    """
    if name != MANY_LOST and sum(key != MANY_LOST for key in lost) < LOST_KEPT:
        return {**lost, name: state}
    somewhere = VehicleState(
        serial=None,
        profile=VehicleProfile(serial="", name="one of many lost vehicles"),
        is_flying=state.is_flying,
        core_received_at_ns=state.core_received_at_ns,
    )
    return {**lost, MANY_LOST: somewhere}


def lost_name(link_id: int) -> str:
    """Return what the hazard area of a vehicle without a serial is dismissed by."""
    return f"link-{link_id}"


def dismissed_by(station: Station, vehicle: VehicleState) -> str:
    """Return what a vehicle's hazard area is dismissed by, with a serial or without."""
    lost = station.watchdog_state.lost.items()
    return vehicle.serial or next(
        (name for name, state in lost if state is vehicle), lost_name(vehicle.link_id or 0)
    )


def lost_as(station: Station, name: str) -> str | None:
    """Return which of the lost is meant: by what it is dismissed by, or as its alarm names it."""
    lost = station.watchdog_state.lost
    return next((key for key, s in lost.items() if name in (key, s.display_name)), None)
