"""Known traffic: every vehicle that may be in the air, and the dismissal of hazard areas.

A vehicle is traffic until telemetry shows it on the ground: connected, lost, or unidentified. One
whose telemetry is lost is a hazard area, which grows; an operator who knows where it is dismisses
it, and newer telemetry brings it back.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from recon.fleet import pairing
from recon.fleet.identity import is_full, without
from recon.model.command import FlyMission, Phase
from recon.model.control import Commanded, Intent
from recon.model.event import HazardDismissed
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.safety.prediction import HazardArea, hazard_area_of, vehicle_motion
from recon.safety.watchdogs import plane_of
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.traffic import identity_grace

LOST_KEPT = 16
"""Vehicles that flew without a serial and were lost: an app that connects again and again must not
fill the memory. The rest are one hazard without a position, which blocks all motion."""
MANY_LOST = "many-lost"
"""The name by which that one is dismissed."""


def in_the_air(station: Station) -> Iterator[tuple[VehicleState, str | None]]:
    """Yield every vehicle, and every link without one, that flies or was last known to.

    With it the serial that is claimed for it: a link in conflict, or one that waits to be admitted,
    claims another vehicle's. A dismissed hazard area is excluded until new telemetry arrives.
    """
    dismissed = station.watchdog_state.dismissed
    for serial, vehicle in station.fleet.vehicles.items():
        if vehicle.is_flying.value is False:
            continue
        if not dismissed or not is_dismissed(station, vehicle):
            yield vehicle, serial
    for link in station.fleet.unbound_links():
        if link.own_state.is_flying.value is True:
            yield link.own_state, link.reported_serial
    for state in station.watchdog_state.lost.values():
        yield state, None


def about_to_fly(station: Station, now_ns: int) -> Iterator[tuple[VehicleState, Intent]]:
    """Yield each vehicle about to fly as telemetry does not show yet, and its intent.

    Its mission or takeoff is queued; or it is on the ground, was sent one a moment ago, and may be
    taking off.
    """
    for record in station.orders.tracked:
        vehicle = station.fleet.vehicles.get(record.command.serial or "")
        intent = _queued_flight(record) if record.phase is Phase.QUEUED else None
        if vehicle is not None and intent is not None:
            yield vehicle, intent
    prediction = station.settings.safety.prediction
    for serial, control in station.controls.items():
        intent = control.intent
        starts_ns = seconds_to_ns(prediction.starts_within_s(intent.mission))
        is_over = now_ns - intent.since_ns > starts_ns
        if intent.commanded is Commanded.NOTHING or is_over:
            continue
        vehicle = station.fleet.vehicles.get(serial)
        if vehicle is None or vehicle.is_flying.value is not False:
            continue
        order = station.orders.records.get(intent.command_id or 0)
        takes_off = order is not None and order.command.takeoff
        if takes_off or intent.commanded is Commanded.MISSION:
            yield vehicle, intent


def _queued_flight(record: OrderRecord) -> Intent | None:
    """Return what an order makes its vehicle fly; None for one that starts no flight."""
    command, body = record.command, record.command.body
    mission = body.mission if isinstance(body, FlyMission) else None
    if mission is None and not command.takeoff:
        return None
    commanded = Commanded.HOLD if mission is None else Commanded.MISSION
    return Intent(commanded, command.issued_at_ns, command.id, mission=mission)


def hazard(station: Station, vehicle: VehicleState, now_ns: int) -> HazardArea | None:
    """Return where a lost vehicle may be; None for one on the ground or dismissed."""
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
    """Return whether an operator has dismissed a vehicle, without telemetry since."""
    dismissed, serial = station.watchdog_state.dismissed, vehicle.serial or ""
    return serial in dismissed and dismissed[serial] == vehicle.core_received_at_ns


def is_dismissible(station: Station, name: str, now_ns: int) -> bool:
    """Return whether a name has a hazard area, or is a lost vehicle without any position."""
    if lost_key(station, name) is not None:
        return True
    vehicle = station.fleet.vehicles.get(name)
    if vehicle is None or vehicle.core_received_at_ns is None:
        return False
    has_no_position = vehicle.position.value is None and not vehicle.track
    may_fly = vehicle.is_flying.value is not False
    is_out = is_dismissed(station, vehicle)
    return hazard(station, vehicle, now_ns) is not None or (
        has_no_position and may_fly and not is_out
    )


def dismiss(station: Station, event: HazardDismissed, now_ns: int) -> Station:
    """Dismiss a hazard area; the station is unchanged if there is no such area."""
    if not is_dismissible(station, event.serial, now_ns):
        return station
    watch, key = station.watchdog_state, lost_key(station, event.serial)
    if key is not None:
        lost = {name: state for name, state in watch.lost.items() if name != key}
        return replace(station, watchdog_state=replace(watch, lost=lost))
    received_at_ns = station.fleet.vehicles[event.serial].core_received_at_ns
    dismissed = {**watch.dismissed, event.serial: received_at_ns}
    station = replace(station, watchdog_state=replace(watch, dismissed=dismissed))
    return _with_room(station) if is_full(station.fleet) else station


def _with_room(station: Station) -> Station:
    """Forget dismissed vehicles without a link: the fleet has no room for others."""
    gone = {
        serial
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.link_id is None and is_dismissed(station, vehicle)
    }
    dismissed = {key: at for key, at in station.watchdog_state.dismissed.items() if key not in gone}
    watch = replace(station.watchdog_state, dismissed=dismissed)
    station = station.with_fleet(without(station.fleet, gone))
    return replace(station, watchdog_state=watch)


def keep_lost(station: Station, link_id: int) -> Station:
    """Return the station with the vehicle on a link that ends kept as lost.

    Only one that flies, is no vehicle by its serial, and is not connected by another link. What an
    operator refused is kept once, when it is refused.
    """
    link = station.fleet.links.get(link_id)
    if link is None or link.claimed_serial is not None or not link.own_state.is_flying.value:
        return station
    if pairing.is_refused(station.fleet, link):
        return station
    if identity_grace.is_identified_elsewhere(station, link.own_state):
        return station
    state = link.own_state
    lost = with_lost(station.watchdog_state.lost, lost_name(link_id), state)
    return replace(station, watchdog_state=replace(station.watchdog_state, lost=lost))


def with_lost(
    lost: Mapping[str, VehicleState], name: str, state: VehicleState
) -> Mapping[str, VehicleState]:
    """Return the lost vehicles with one more; if too many, with one that stands for the rest.

    That one has no position, and the gate refuses all motion while it may be in the air.
    """
    if name != MANY_LOST and sum(key != MANY_LOST for key in lost) < LOST_KEPT:
        return {**lost, name: state}
    rest = VehicleState(
        serial=None,
        profile=VehicleProfile(serial="", name="one of many lost vehicles"),
        is_flying=state.is_flying,
        core_received_at_ns=state.core_received_at_ns,
    )
    return {**lost, MANY_LOST: rest}


def lost_name(link_id: int) -> str:
    """Return the name by which an unidentified vehicle's hazard area is dismissed."""
    return f"link-{link_id}"


def dismissed_by(station: Station, vehicle: VehicleState) -> str:
    """Return the name by which a vehicle's hazard area is dismissed."""
    lost = station.watchdog_state.lost.items()
    return vehicle.serial or next(
        (name for name, state in lost if state is vehicle), lost_name(vehicle.link_id or 0)
    )


def lost_key(station: Station, name: str) -> str | None:
    """Return the key of a lost vehicle, by that key or by its display name."""
    lost = station.watchdog_state.lost
    return next((key for key, s in lost.items() if name in (key, s.display_name)), None)
