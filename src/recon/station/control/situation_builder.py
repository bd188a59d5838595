"""What the gate judges: an order as a command, and the situation it is judged in."""

from recon.model.command import Command, mission_of_body
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.safety import ClaimingLink, Situation, Traffic
from recon.safety.situation import NO_FACTS
from recon.station.control import preflight
from recon.station.state.station import Station
from recon.station.state.vehicle_control import VehicleControl
from recon.station.traffic.known_traffic import about_to_fly, in_the_air


def command_of(station: Station, order: OperatorOrder, now_ns: int) -> Command:
    """Return an order as the command the gate judges."""
    return Command(
        id=order.command_id,
        body=order.body,
        issued_by=order.issued_by,
        issued_at_ns=now_ns,
        expires_at_ns=now_ns + seconds_to_ns(station.settings.order_expiry_s),
        serial=order.serial,
        link_id=order.link_id,
        takeoff=order.takeoff,
        role=order.role,
        given_at_ns=order.given_at_ns,
        person=order.person,
    )


def situation(
    station: Station, command: Command, now_ns: int, *, with_traffic: bool = False
) -> Situation:
    """Return the snapshot the gate judges a command by.

    Other traffic matters only to commands that set a vehicle in motion, unless it is asked for: a
    stop must not wait for it.
    """
    target = station.target(command.serial, command.link_id)
    serial = "" if target is None or target.serial is None else target.serial
    control = station.control(serial)
    needs_checklist = mission_of_body(command.body) is not None or command.takeoff
    return Situation(
        now_ns=now_ns,
        vehicle=target,
        claiming_links=_claiming_links(station, command),
        waiting_link_ids=station.fleet.link_ids_waiting(command.serial or ""),
        settings=station.settings.safety,
        airspace=station.airspace,
        authority=control.authority,
        lease=control.lease,
        stop_latch=station.stop_latch,
        intent=control.intent,
        stick_height_above_takeoff_m=_stick_height_m(control),
        traffic=_traffic(station, command, serial, now_ns) if command.moves or with_traffic else (),
        preflight_override=control.preflight_override,
        facts=preflight.facts(station, target) if needs_checklist else NO_FACTS,
    )


def _stick_height_m(control: VehicleControl) -> float | None:
    """The height above takeoff that a vehicle's newest setpoint asked for."""
    if control.stream is not None:
        return control.stream.steered.height_above_takeoff_m
    if control.neutral is not None:
        return control.neutral.body.height_above_takeoff_m
    return control.intent.target_height_above_takeoff_m


def _traffic(station: Station, command: Command, serial: str, now_ns: int) -> tuple[Traffic, ...]:
    """Return every other vehicle in flight by its last telemetry, or about to take off."""
    about_to = tuple(
        Traffic(state, intent)
        for state, intent in about_to_fly(station, now_ns)
        if state.serial != serial
    )
    return about_to + tuple(
        Traffic(state, station.control(state.serial).intent)
        for state, claimed in in_the_air(station)
        if state.serial is None or state.serial != serial
        if claimed is None or claimed != command.serial
        if state.serial is not None or state.link_id is None or state.link_id != command.link_id
    )


def _claiming_links(station: Station, command: Command) -> tuple[ClaimingLink, ...]:
    fleet = station.fleet
    if command.serial is not None:
        link_ids = fleet.link_ids_claiming(command.serial)
        if command.is_emergency and not command.takeoff and command.serial in fleet.vehicles:
            # It may be the aircraft: a stop reaches a false one without harm.
            link_ids += fleet.link_ids_waiting(command.serial)
    else:
        target = station.target(None, command.link_id)
        link_ids = () if target is None or target.link_id is None else (target.link_id,)
    states = ((link_id, fleet.vehicle_of_link(link_id)) for link_id in link_ids)
    return tuple(
        ClaimingLink(link_id, state.is_flying, state.reported_is_flying)
        for link_id, state in states
        if state is not None
    )
