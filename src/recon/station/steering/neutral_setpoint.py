"""The neutral setpoint that ends a single stick, and the hold after it.

Writes `VehicleControl.neutral`. A virtual stick packet asks the app to hold a velocity for
`timeout_s` and then to stop, but apps do not do so reliably.

    stick sent --its time is over--> zero velocity with the same yaw, at the last reported height:
    so a climb ends too (without a known height, the stick's own)
    neutral setpoint sent --`stick_to_hold_s`--> a hold: in stick mode zero velocity still drifts,
    in wind by 0.8 m/s, until a fence ends it; in position mode the aircraft keeps its place

A stick that only stops needs no neutral setpoint, but the hold. Nothing is sent after a newer
order, or when the vehicle is no longer in stick mode: its pilot flies it.
"""

from collections.abc import Iterator
from dataclasses import replace

from recon.model.command import Command, Hover, VirtualStick, issued_by_station
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.station import Station, take_id
from recon.station.state.vehicle_control import PendingNeutral

ISSUER = issued_by_station("end of a stick")


def begin(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after a command was sent: a stick needs an end.

    Without velocity, with the vehicle at its height or none reported, a hold is enough.
    """
    body = command.body
    if not isinstance(body, VirtualStick) or command.serial is None or command.id < 0:
        return station
    neutral = PendingNeutral(command, body, now_ns + seconds_to_ns(body.timeout_s))
    if _stands(station, command.serial, body):
        neutral = _then_hold(station, neutral, neutral.due_at_ns)
    return station.with_control(command.serial, neutral=neutral)


def after(station: Station, ended: PendingNeutral, now_ns: int) -> Station:
    """Return the station after the neutral setpoint or the hold of a stick was submitted."""
    serial = ended.command.serial or ""
    if ended.is_hold:
        return cancel(station, serial)
    return station.with_control(serial, neutral=_then_hold(station, ended, now_ns))


def _then_hold(station: Station, neutral: PendingNeutral, from_ns: int) -> PendingNeutral:
    due_at_ns = from_ns + seconds_to_ns(station.settings.stick_to_hold_s)
    return replace(neutral, due_at_ns=due_at_ns, is_hold=True)


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


def due(
    station: Station, now_ns: int
) -> tuple[Station, tuple[tuple[PendingNeutral, OperatorOrder], ...]]:
    """Return what is due now, with its order; `after` each once submitted."""
    orders: list[tuple[PendingNeutral, OperatorOrder]] = []
    for serial, neutral in pending(station):
        if now_ns >= neutral.due_at_ns and _is_flown_by_sticks(station, neutral, now_ns):
            station, number = take_id(station)
            vehicle = station.fleet.vehicles[serial]
            body = Hover() if neutral.is_hold else _zero(neutral.body, vehicle)
            lease = station.control(serial).lease
            # It stops what was steered, also when another person has taken over since.
            person = "" if lease is None else lease.person
            role = neutral.command.role
            order = OperatorOrder(number, body, ISSUER, serial, role=role, person=person)
            orders.append((neutral, order))
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
