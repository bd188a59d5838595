"""Missions in parts: each part goes through the gate, and the next one only over a whole chain.

A mission longer than an app takes is flown in parts that hover at their ends. The next part is sent
when the one before is finished, if since the order the vehicle has stayed on the same link, without
a gap of telemetry and under the same holder of authority. Else it holds, the order fails, and an
alarm gives the reason. Nothing else is ever sent without an order.
"""

from dataclasses import replace

from recon.model.command import Command, FlyMission, FollowPath, Phase, Refusal
from recon.model.mission import Mission
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.safety import Situation, judge_parts
from recon.station.state import orders
from recon.station.state.orders import FlightPlan, OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Judge, SendCommand, Stepped
from recon.vehicles.mission_repair import repair
from recon.vehicles.packets import describe_altitudes


def body_for(vehicle: VehicleState, mission: Mission) -> FlyMission | FollowPath:
    """Return the order that flies a mission: steered, where the aircraft takes none."""
    return FlyMission(mission) if vehicle.flies_missions else FollowPath(mission)


def plan(station: Station, command: Command) -> FlightPlan | None:
    """Return how a mission will be flown, repaired to what DJI accepts; None for other orders."""
    if not isinstance(command.body, FlyMission):
        return None
    vehicle = station.target(command.serial, command.link_id)
    known = None if vehicle is None else vehicle.profile
    repaired = repair(command.body.mission, known or VehicleProfile(command.serial or ""))
    return FlightPlan(
        parts=repaired.parts,
        repairs=repaired.repairs,
        link_id=None if vehicle is None else vehicle.link_id,
        authority=station.control(command.serial).authority,
        telemetry_at_ns=None if vehicle is None else vehicle.core_received_at_ns,
    )


def present_part(command: Command, flight_plan: FlightPlan | None) -> Command:
    """Return the order as it is sent now: of a mission, its present part."""
    if flight_plan is None:
        return command
    return replace(command, body=FlyMission(flight_plan.part))


def refusal_of_whole(
    command: Command, flight_plan: FlightPlan | None, situation: Situation
) -> Refusal | None:
    """Return why a mission of several parts may not be flown as a whole, else None."""
    if flight_plan is None or len(flight_plan.parts) == 1:
        return None
    return judge_parts(command, flight_plan.parts, situation)


def check_chain(
    station: Station, record: OrderRecord, vehicle: VehicleState, now_ns: int
) -> Station:
    """Return the station with a mission's chain checked; once broken it stays broken."""
    chain = record.plan
    if chain is None or chain.is_last or chain.broken is not None:
        return station
    broken = _break(station, chain, vehicle, now_ns)
    checked = replace(chain, telemetry_at_ns=vehicle.core_received_at_ns, broken=broken)
    if checked == chain:
        return station
    record = replace(record, plan=checked)
    if broken is not None:
        note = f"no part will follow the present one: {broken}"
        record = orders.noted(record, now_ns, note)
    return _put(station, record)


def part_flown(station: Station, record: OrderRecord, now_ns: int, ask: Judge) -> Stepped:
    """Return the station after a vehicle flew a mission's present part to its end."""
    flown = record.plan
    if flown is None or flown.is_last:
        note = "telemetry shows it flown to its end; hovering"
        return _put(station, orders.ended(record, Phase.DONE, now_ns, note)), ()
    if flown.broken is not None:
        return _broken_off(station, record, flown.broken, now_ns), ()
    return _send_next(station, record, flown, now_ns, ask)


def _send_next(
    station: Station, record: OrderRecord, flown: FlightPlan, now_ns: int, ask: Judge
) -> Stepped:
    following = replace(flown, index=flown.index + 1)
    expires_at_ns = now_ns + seconds_to_ns(station.settings.order_expiry_s)
    order = replace(
        record.command,
        issued_at_ns=now_ns,
        expires_at_ns=expires_at_ns,
        takeoff=False,
        given_at_ns=None,
    )
    judged = ask(station, present_part(order, following))
    if isinstance(judged, Refusal):
        refused = replace(record, refusal=judged)
        return _broken_off(station, refused, judged.reason, now_ns), ()
    queued = orders.changed(record, Phase.QUEUED, now_ns, following.label)
    queued = replace(
        queued,
        command=replace(record.command, expires_at_ns=expires_at_ns),
        plan=following,
        sent=None,
        altitudes=describe_altitudes(FlyMission(following.part), judged.altitude_offset_m),
        waiting_link_ids=judged.link_ids,
    )
    return _put(station, queued), (SendCommand(judged),)


def _broken_off(station: Station, record: OrderRecord, why: str, now_ns: int) -> Station:
    flown = record.plan
    assert flown is not None
    note = (
        f"part {flown.index + 2} of {len(flown.parts)} is not flown: {why}; it holds at the end of "
        f"part {flown.index + 1}"
    )
    alarm = orders.MISSION_BROKEN_OFF
    return _put(station, orders.ended(record, Phase.FAILED, now_ns, note, alarm=alarm))


def _break(station: Station, chain: FlightPlan, vehicle: VehicleState, now_ns: int) -> str | None:
    """Return what broke the chain since the order, else None."""
    if vehicle.link_id != chain.link_id:
        return "its connection ended or was renewed since the order"
    latest_ns, before_ns = vehicle.core_received_at_ns, chain.telemetry_at_ns
    gap_s = station.settings.parts_gap_s
    if latest_ns is None or before_ns is None:
        return "no telemetry when the order was given"
    silent_s = ns_to_seconds(max(now_ns - latest_ns, latest_ns - before_ns))
    if silent_s > gap_s:
        return f"no telemetry for more than {gap_s:g} s since the order"
    jumped_ns = vehicle.trust.jump_accepted_at_ns
    if jumped_ns is not None and before_ns <= jumped_ns:
        return "its position jumped since the order"
    authority = station.control(vehicle.serial).authority
    if authority != chain.authority:
        return f"authority changed since the order ({authority.reason})"
    return None


def _put(station: Station, record: OrderRecord) -> Station:
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)
