"""The neutral setpoint that ends a single stick. Writes `VehicleControl.neutral`.

A virtual stick packet asks the app to hold a velocity for `timeout_s` and then to stop, but apps do
not do so reliably. When that time is over the station sends zero velocity with the same yaw, at the
last reported height: so a climb ends too. Without a known height the stick's own is kept. Nothing
is sent after a newer order, or when the vehicle is no longer in stick mode: its pilot flies it.
"""

from collections.abc import Iterator
from dataclasses import replace

from recon.model.command import Command, VirtualStick
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.station import Station, take_id
from recon.station.state.vehicle_control import PendingNeutral

ISSUER = "station: end of a stick"


def begin(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after a command was sent: a stick that moves needs a neutral setpoint.

    Not one without velocity, if the vehicle is at its height or has none reported.
    """
    body = command.body
    if not isinstance(body, VirtualStick) or command.serial is None or command.id < 0:
        return station
    if _stands(station, command.serial, body):
        return station
    neutral = PendingNeutral(command, body, now_ns + seconds_to_ns(body.timeout_s))
    return station.with_control(command.serial, neutral=neutral)


def cancel(station: Station, serial: str | None) -> Station:
    """Return the station without a vehicle's pending neutral setpoint."""
    if serial is None or serial not in station.neutral_pending:
        return station
    return station.with_control(serial, neutral=None)


def pending(station: Station) -> Iterator[tuple[str, PendingNeutral]]:
    """Yield every pending neutral setpoint with its vehicle's serial."""
    for serial in station.neutral_pending:
        neutral = station.control(serial).neutral
        assert neutral is not None, "`neutral_pending` names the vehicles with one"
        yield serial, neutral


def due(station: Station, now_ns: int) -> tuple[Station, tuple[OperatorOrder, ...]]:
    """Return the neutral setpoints due now, as orders; `cancel` each once submitted."""
    orders: list[OperatorOrder] = []
    for serial, neutral in pending(station):
        if now_ns >= neutral.due_at_ns and _is_flown_by_sticks(station, neutral, now_ns):
            station, number = take_id(station)
            zero = _zero(neutral.body, station.fleet.vehicles[serial])
            lease = station.control(serial).lease
            # It stops what was steered, also when another person has taken over since.
            person = "" if lease is None else lease.person
            role = neutral.command.role
            orders.append(OperatorOrder(number, zero, ISSUER, serial, role=role, person=person))
    return station, tuple(orders)


def _zero(body: VirtualStick, vehicle: VehicleState) -> VirtualStick:
    """The stick that stops it where it is; barometers show decimetres below zero on the pad."""
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


def drop_overdue(station: Station, now_ns: int) -> Station:
    """Return the station without the neutral setpoints that were not needed in time."""
    if not station.neutral_pending:
        return station
    wait_ns = seconds_to_ns(station.settings.neutral_setpoint_waits_s)
    for serial, neutral in pending(station):
        if now_ns >= neutral.due_at_ns + wait_ns:
            station = cancel(station, serial)
    return station


def _is_flown_by_sticks(station: Station, neutral: PendingNeutral, now_ns: int) -> bool:
    """Whether its telemetry is fresh and its last reported mode (2 Hz) is virtual sticks."""
    vehicle = station.fleet.vehicles.get(neutral.command.serial or "")
    if vehicle is None or vehicle.flight_mode.value is not FlightMode.JOYSTICK:
        return False
    age_s = vehicle.is_flying.age_s(now_ns)
    return age_s is not None and age_s <= station.settings.safety.fresh_telemetry_s
