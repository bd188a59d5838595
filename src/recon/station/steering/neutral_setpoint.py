"""The zero at the end of a stick: sent by the station, for an app's own timeout cannot be trusted.

A virtual stick packet asks the app to hold its velocity for `timeout_s` and then to stop. When that
time is over, the station sends zero velocity with the same yaw, at the height the vehicle was last
heard at: a climb ends with its time as a velocity does. While the height is not known, the stick's
own stays. Nothing is sent when a newer order came or the vehicle is no longer flown by sticks (the
pilot has it, then, and is not fought).
"""

from dataclasses import replace

from recon.model.command import Command, VirtualStick
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.command_ids import take_id
from recon.station.state.station import PendingNeutral, Station

ISSUER = "station: end of a stick"


def begin(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after a command was sent: a stick that moves will need its zero.

    One without velocity does not when the vehicle was at its height, as far as that is known.
    """
    body = command.body
    if not isinstance(body, VirtualStick) or command.serial is None or command.id < 0:
        return station
    if _stands(station, command.serial, body):
        return station
    pending = PendingNeutral(command, body, now_ns + seconds_to_ns(body.timeout_s))
    return replace(station, sticks={**station.sticks, command.serial: pending})


def forget(station: Station, newer: Command | OperatorOrder) -> Station:
    """Return the station after a newer order to move, or the zero itself: nothing is pending."""
    if newer.serial not in station.sticks:
        return station
    sticks = {serial: p for serial, p in station.sticks.items() if serial != newer.serial}
    return replace(station, sticks=sticks)


def due(station: Station, now_ns: int) -> tuple[Station, tuple[OperatorOrder, ...]]:
    """Return the zeros that must go now, as orders for the gate; `forget` each once placed."""
    orders: list[OperatorOrder] = []
    for serial, pending in station.sticks.items():
        if now_ns >= pending.due_at_ns and _is_flown_by_sticks(station, pending, now_ns):
            station, number = take_id(station)
            zero = _zero(pending.body, station.fleet.vehicles[serial])
            asked_as = pending.command.asked_as
            orders.append(OperatorOrder(number, zero, ISSUER, serial, asked_as=asked_as))
    return station, tuple(orders)


def _zero(body: VirtualStick, vehicle: VehicleState) -> VirtualStick:
    """The stick that stops it where it is; no stick takes the decimetres below zero of a pad."""
    height_m = vehicle.height_above_takeoff_m.value
    kept_m = body.height_above_takeoff_m if height_m is None else max(0.0, height_m)
    return replace(body, velocity_x_mps=0.0, velocity_y_mps=0.0, height_above_takeoff_m=kept_m)


def _stands(station: Station, serial: str, body: VirtualStick) -> bool:
    if body.velocity_x_mps != 0.0 or body.velocity_y_mps != 0.0:
        return False
    vehicle = station.fleet.vehicles.get(serial)
    height_m = None if vehicle is None else vehicle.height_above_takeoff_m.value
    same_m = station.settings.safety.fences.same_height_m
    return height_m is None or abs(body.height_above_takeoff_m - height_m) <= same_m


def give_up(station: Station, now_ns: int) -> Station:
    """Return the station without the zeros that nobody has needed for a while."""
    wait_ns = seconds_to_ns(station.settings.stick_zero_waits_s)
    sticks = {s: p for s, p in station.sticks.items() if now_ns < p.due_at_ns + wait_ns}
    return station if len(sticks) == len(station.sticks) else replace(station, sticks=sticks)


def _is_flown_by_sticks(station: Station, pending: PendingNeutral, now_ns: int) -> bool:
    """Whether it is heard, and the newest word on its mode is that sticks fly it (2 Hz)."""
    vehicle = station.fleet.vehicles.get(pending.command.serial or "")
    if vehicle is None or vehicle.flight_mode.value is not FlightMode.JOYSTICK:
        return False
    age_s = vehicle.is_flying.age_s(now_ns)
    return age_s is not None and age_s <= station.settings.safety.fresh_telemetry_s
