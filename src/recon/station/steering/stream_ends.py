"""How a setpoint stream ends: without a further packet, or with a neutral setpoint and a hold.

The only writer of `VehicleControl.stream`.
"""

from dataclasses import dataclass
from typing import NamedTuple

from recon.fleet.flight_table import Instruction, Place, Verdict, read
from recon.guidance.steering import halted
from recon.model.command import (
    Command,
    Hover,
    Phase,
    Refusal,
    StickFrame,
    VirtualStick,
    issued_by_station,
)
from recon.model.control import AuthorityHolder, Commanded
from recon.model.event import OperatorOrder
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import ApprovedCommand
from recon.station.state import orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.setpoint_stream import SetpointStream
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Judge, Output, SendCommand

ISSUER = issued_by_station("end of a stream of sticks")
RULE = "steering_ended"


class ReleasedStream(NamedTuple):
    """A stream that has ended, its order, and what its vehicle is commanded to do now."""

    serial: str
    command_id: int
    commanded: Commanded


@dataclass(frozen=True)
class StreamUpdate:
    """The station after streams were updated, and what `control` must do next.

    `outputs` are packets to send, `holds` orders to place. `pilot_takeovers` are serials with the
    reason why their pilot is known to fly them.
    """

    station: Station
    outputs: tuple[Output, ...] = ()
    holds: tuple[OperatorOrder, ...] = ()
    pilot_takeovers: tuple[tuple[str, str], ...] = ()
    released: tuple[ReleasedStream, ...] = ()


def with_stream(station: Station, serial: str, stream: SetpointStream) -> Station:
    """Return the station with a vehicle's stream replaced."""
    return station.with_control(serial, stream=stream)


def release(
    update: StreamUpdate, serial: str, commanded: Commanded = Commanded.NOTHING
) -> StreamUpdate:
    """Remove a vehicle's stream, if it has one. Its order keeps the count of its setpoints."""
    station = update.station
    stream = station.control(serial).stream
    if stream is None:
        return update
    station = station.with_control(serial, stream=None)
    record = station.orders.records.get(stream.command.id)
    if record is not None:
        counted = replace(record, times_sent=stream.packets_sent)
        book = orders.put(station.orders, counted, station.settings.orders_kept)
        station = replace(station, orders=book)
    ended = ReleasedStream(serial, stream.command.id, commanded)
    return replace(update, station=station, released=(*update.released, ended))


def change_phase(
    station: Station, stream: SetpointStream, phase: Phase, now_ns: int, note: str
) -> Station:
    """Return the station with the stream's order in another phase, as long as it is kept."""
    record = station.orders.records.get(stream.command.id)
    if record is None:
        return station
    changed = orders.changed(record, phase, now_ns, note)
    kept = station.settings.orders_kept
    return replace(station, orders=orders.put(station.orders, changed, kept))


def with_refusal(station: Station, stream: SetpointStream, refusal: Refusal) -> Station:
    """Return the station with the refusal of a setpoint in the stream's order."""
    record = station.orders.records.get(stream.command.id)
    if record is None:
        return station
    refused, kept = replace(record, refusal=refusal), station.settings.orders_kept
    return replace(station, orders=orders.put(station.orders, refused, kept))


def judge_setpoint(
    station: Station, stream: SetpointStream, now_ns: int, judge: Judge, person: str | None = None
) -> tuple[Station, ApprovedCommand | Refusal, SetpointStream]:
    """Ask the gate about the stream's present setpoint, as a virtual stick command.

    `person` None: the one whose order it is.
    """
    settings, steered = station.settings.streams, stream.steered
    station, number = take_id(station)
    command = Command(
        id=number,
        body=VirtualStick(
            StickFrame.GROUND,
            steered.yaw_deg,
            steered.velocity_north_mps,
            steered.velocity_east_mps,
            # Barometers show some decimetres below zero on the pad; no stick takes them.
            max(0.0, steered.height_above_takeoff_m),
            settings.stick_timeout_s,
        ),
        issued_by=stream.command.issued_by,
        issued_at_ns=now_ns,
        # After this the next setpoint has replaced it, or the stream has ended.
        expires_at_ns=now_ns + seconds_to_ns(1.5 * settings.period_s),
        serial=stream.command.serial,
        role=stream.command.role,
        person=stream.command.person if person is None else person,
    )
    return station, judge(station, command), replace(stream, last_stick_id=number)


def control_lost(
    station: Station, stream: SetpointStream, vehicle: VehicleState
) -> tuple[Phase, str] | None:
    """Return the order's final phase and the reason if a pilot or a failsafe flies the vehicle."""
    mode = vehicle.flight_mode
    if mode.received_at_ns is not None and mode.received_at_ns > stream.started_at_ns:
        reading = read(
            Instruction.STICK if stream.is_obeyed else Instruction.STICK_SENT,
            mode.value,
            vehicle.gnss_signal_level.value,
            Place.GROUND_ELSEWHERE if vehicle.is_flying.value is False else Place.ELSEWHERE,
            None if stream.is_obeyed else stream.mode_before,
        )
        if reading.verdict is Verdict.PILOT:
            return Phase.SUPERSEDED, f"the pilot has taken over: {reading.why}"
        if reading.verdict is Verdict.FAILSAFE:
            return Phase.FAILED, reading.why
    authority = station.control(stream.command.serial).authority
    if authority.holder is AuthorityHolder.PILOT and mode.value is not FlightMode.JOYSTICK:
        return Phase.SUPERSEDED, f"the pilot has control ({authority.reason})"
    return None


def failure(
    station: Station, stream: SetpointStream, vehicle: VehicleState, now_ns: int
) -> str | None:
    """Return why the station cannot continue a stream, else None."""
    settings = station.settings.streams
    if vehicle.link_id != stream.link_id:
        return "connection lost: a steered order does not resume"
    if now_ns - stream.seen_at_ns > seconds_to_ns(settings.resumes_s):
        return f"telemetry incomplete or missing for {settings.resumes_s:g} s"
    jumped_ns = vehicle.trust.jump_accepted_at_ns
    if jumped_ns is not None and jumped_ns > stream.started_at_ns:
        return "its position jumped: it may not be where it is shown"
    authority = station.control(stream.command.serial).authority
    if authority.holder is not stream.command.role:
        return f"authority passed to {authority.holder.value} ({authority.reason})"
    waited_ns = now_ns - stream.started_at_ns
    if not stream.is_obeyed and waited_ns > seconds_to_ns(settings.obeyed_s):
        return f"the aircraft did not enter stick mode within {settings.obeyed_s:g} s"
    return None


def has_held_long_enough(station: Station, stream: SetpointStream, now_ns: int) -> bool:
    """Return whether a place was held for as long as the station holds one by sticks."""
    hold_ns = seconds_to_ns(station.settings.streams.hold_at_most_s)
    return stream.arrived_at_ns is not None and now_ns - stream.arrived_at_ns > hold_ns


def end_silently(
    update: StreamUpdate, serial: str, stream: SetpointStream, end: tuple[Phase, str], now_ns: int
) -> StreamUpdate:
    """End a stream and send nothing: the pilot or the aircraft's failsafe flies the vehicle."""
    phase, why = end
    update = release(update, serial)
    if phase is Phase.SUPERSEDED:
        takeovers = (*update.pilot_takeovers, (serial, why))
        update = replace(update, pilot_takeovers=takeovers)
    if stream.closing is not None:
        return update
    ended = phase if stream.arrived_at_ns is None else Phase.DONE
    station = change_phase(update.station, stream, ended, now_ns, why)
    if phase is Phase.FAILED:
        station = _alarm(station, stream, f"{why}; nothing more is sent", now_ns)
    return replace(update, station=station)


def abort(
    update: StreamUpdate, serial: str, stream: SetpointStream, why: str, now_ns: int, judge: Judge
) -> StreamUpdate:
    """End a stream that cannot continue: its order fails, with an alarm; the vehicle holds."""
    phase = Phase.FAILED if stream.arrived_at_ns is None else Phase.DONE
    station = change_phase(update.station, stream, phase, now_ns, why)
    station = _alarm(station, stream, f"{why}; stopped and holding", now_ns)
    return _close(replace(update, station=station), serial, stream, why, now_ns, judge)


def end_unsent(
    update: StreamUpdate, serial: str, stream: SetpointStream, why: str, now_ns: int
) -> StreamUpdate:
    """End a stream of which nothing was sent: its order fails, with an alarm, and the vehicle
    continues as before. A hold would end a return on its way, or leave it inside a zone."""
    station = change_phase(update.station, stream, Phase.FAILED, now_ns, why)
    station = _alarm(station, stream, f"{why}; nothing was sent, it continues as before", now_ns)
    return release(replace(update, station=station), serial)


def end_held_place(
    update: StreamUpdate, serial: str, stream: SetpointStream, now_ns: int, judge: Judge
) -> StreamUpdate:
    """End a stream that has held its place long enough: the aircraft's own hold replaces it."""
    held_s = update.station.settings.streams.hold_at_most_s
    why = f"position held for {held_s:g} s; the aircraft now holds it itself"
    station = change_phase(update.station, stream, Phase.DONE, now_ns, why)
    return _close(replace(update, station=station), serial, stream, why, now_ns, judge)


def order_hold(update: StreamUpdate, serial: str) -> StreamUpdate:
    """Order the hold that follows the neutral setpoint; a vehicle on the ground needs none."""
    update = release(update, serial, Commanded.HOLD)
    vehicle = update.station.fleet.vehicles.get(serial)
    if vehicle is None or vehicle.is_flying.value is False:
        return update
    station, number = take_id(update.station)
    order = OperatorOrder(number, Hover(), ISSUER, serial=serial)
    return replace(update, station=station, holds=(*update.holds, order))


def _close(
    update: StreamUpdate, serial: str, stream: SetpointStream, why: str, now_ns: int, judge: Judge
) -> StreamUpdate:
    """Send a neutral setpoint now and hold a little later; hold at once if the gate refuses it."""
    vehicle = update.station.fleet.vehicles.get(serial)
    height_m = None if vehicle is None else vehicle.height_above_takeoff_m.value
    stream = replace(stream, steered=halted(stream.steered, height_m, now_ns))
    lease = update.station.control(serial).lease
    # It stops what was steered, also when another person has taken over.
    person = None if lease is None else lease.person
    station, answer, stream = judge_setpoint(update.station, stream, now_ns, judge, person)
    update = replace(update, station=station)
    if isinstance(answer, Refusal):
        return order_hold(update, serial)
    due_ns = now_ns + seconds_to_ns(station.settings.streams.neutral_to_hold_s)
    closing = replace(stream, closing=why, next_due_ns=due_ns)
    station = with_stream(station, serial, closing)
    return replace(update, station=station, outputs=(*update.outputs, SendCommand(answer)))


def _alarm(station: Station, stream: SetpointStream, why: str, now_ns: int) -> Station:
    """Raise an alarm about the end of a stream; it stays until acknowledged."""
    record = station.orders.records.get(stream.command.id)
    serial = stream.command.serial
    name = serial or "" if record is None else record.vehicle_name
    condition = Condition(
        key=f"{RULE}:{stream.command.id}",
        severity=Severity.ERROR if stream.arrived_at_ns is None else Severity.WARNING,
        rule=RULE,
        vehicle_name=name,
        text=f"{name}: {stream.command.name.replace('_', ' ')}: {why}",
        serial=serial,
    )
    return station.with_alarm(condition, now_ns)
