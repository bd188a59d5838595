"""How a stream of sticks ends: let go in silence, or zero and then hold."""

from dataclasses import dataclass

from recon.fleet.flight_table import Instruction, Place, Verdict, read
from recon.guidance.steering import halted
from recon.model.authority import AuthorityHolder, ControlAuthority
from recon.model.command import Command, Hover, Phase, Refusal, StickFrame, VirtualStick
from recon.model.event import OperatorOrder
from recon.model.intent import Commanded, Intent
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety import ApprovedCommand
from recon.station.state import alarm_book, orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.command_ids import take_id
from recon.station.state.outputs import Output, SendCommand
from recon.station.state.setpoint_lease import SetpointLease
from recon.station.state.station import Station
from recon.station.state.stepped import Judge

ISSUER = "station: end of a stream of sticks"
RULE = "steering_ended"

_DEFAULT_AUTHORITY = ControlAuthority()


@dataclass(frozen=True, slots=True)
class Driven:
    """The station after a beat, what is to be sent, and the holds that are to be ordered.

    `pilots` are the vehicles found in their pilots' hands, and how that was seen.
    """

    station: Station
    outputs: tuple[Output, ...] = ()
    holds: tuple[OperatorOrder, ...] = ()
    pilots: tuple[tuple[str, str], ...] = ()


def put(station: Station, serial: str, lease: SetpointLease) -> Station:
    """Return the station with a lease in its newest form."""
    return replace(station, streams={**station.streams, serial: lease})


def release(
    station: Station, serial: str | None, now_ns: int, told: Commanded = Commanded.NOTHING
) -> Station:
    """Return the station without a vehicle's lease, which is told something else now.

    Its order keeps the count of its sticks.
    """
    lease = station.streams.get(serial or "")
    if lease is None or serial is None:
        return station
    station = replace(station, streams={s: x for s, x in station.streams.items() if s != serial})
    if station.intents.get(serial, Intent()).command_id == lease.command.id:
        intents = {**station.intents, serial: Intent(told, now_ns)}
        station = replace(station, intents=intents)
    record = station.orders.records.get(lease.command.id)
    if record is None:
        return station
    counted = replace(record, times_sent=lease.packets_sent)
    book = orders.put(station.orders, counted, station.settings.orders_kept)
    return replace(station, orders=book)


def change_phase(
    station: Station, lease: SetpointLease, phase: Phase, now_ns: int, note: str
) -> Station:
    """Return the station with the order's record gone on, as long as it is kept."""
    record = station.orders.records.get(lease.command.id)
    if record is None:
        return station
    changed = orders.changed(record, phase, now_ns, note)
    kept = station.settings.orders_kept
    return replace(station, orders=orders.put(station.orders, changed, kept))


def judged(
    station: Station, lease: SetpointLease, now_ns: int, ask: Judge
) -> tuple[Station, ApprovedCommand | Refusal, SetpointLease]:
    """Ask the gate about the stick of the lease's present demand."""
    settings, steered = station.settings.streams, lease.steered
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
        issued_by=lease.command.issued_by,
        issued_at_ns=now_ns,
        # What waits longer has been replaced by the next one, or its lease is over.
        expires_at_ns=now_ns + seconds_to_ns(1.5 * settings.period_s),
        serial=lease.command.serial,
        asked_as=lease.command.asked_as,
    )
    return station, ask(station, command), replace(lease, last_stick_id=number)


def taken(
    station: Station, lease: SetpointLease, vehicle: VehicleState
) -> tuple[Phase, str] | None:
    """Return what took a vehicle out of the station's hands, and what that makes of its order."""
    mode = vehicle.flight_mode
    if mode.received_at_ns is not None and mode.received_at_ns > lease.started_at_ns:
        reading = read(
            Instruction.STICK if lease.is_obeyed else Instruction.STICK_SENT,
            mode.value,
            vehicle.gnss_signal_level.value,
            Place.GROUND_ELSEWHERE if vehicle.is_flying.value is False else Place.ELSEWHERE,
            None if lease.is_obeyed else lease.mode_before,
        )
        if reading.verdict is Verdict.PILOT:
            return Phase.SUPERSEDED, f"the pilot has taken the sticks: {reading.why}"
        if reading.verdict is Verdict.FAILSAFE:
            return Phase.FAILED, reading.why
    authority = _authority(station, lease)
    if authority.holder is AuthorityHolder.PILOT and mode.value is not FlightMode.JOYSTICK:
        return Phase.SUPERSEDED, f"the pilot leads it ({authority.reason})"
    return None


def failure(
    station: Station, lease: SetpointLease, vehicle: VehicleState, now_ns: int
) -> str | None:
    """Return why the station must give a lease up, else None."""
    settings = station.settings.streams
    if vehicle.link_id != lease.link_id:
        return "its connection was lost, and a steered order never goes on after that"
    if now_ns - lease.seen_at_ns > seconds_to_ns(settings.resumes_s):
        return f"its telemetry was incomplete or missing for {settings.resumes_s:g} s"
    authority = _authority(station, lease)
    if authority.holder is not lease.command.asked_as:
        return f"{authority.holder.value} leads the vehicle now ({authority.reason})"
    waited_ns = now_ns - lease.started_at_ns
    if not lease.is_obeyed and waited_ns > seconds_to_ns(settings.obeyed_s):
        return f"the aircraft has not gone over to sticks within {settings.obeyed_s:g} s"
    return None


def has_held_long_enough(station: Station, lease: SetpointLease, now_ns: int) -> bool:
    """Return whether a place was held for as long as the station holds one by sticks."""
    hold_ns = seconds_to_ns(station.settings.streams.hold_at_most_s)
    return lease.arrived_at_ns is not None and now_ns - lease.arrived_at_ns > hold_ns


def let_go(
    driven: Driven, serial: str, lease: SetpointLease, taken: tuple[Phase, str], now_ns: int
) -> Driven:
    """End a lease without a word to the vehicle: somebody else flies it, and is not fought."""
    phase, why = taken
    station = release(driven.station, serial, now_ns)
    if phase is Phase.SUPERSEDED:
        driven = replace(driven, pilots=(*driven.pilots, (serial, why)))
    if lease.closing is None:
        ended = phase if lease.arrived_at_ns is None else Phase.DONE
        station = change_phase(station, lease, ended, now_ns, why)
        if phase is Phase.FAILED:
            station = _alarm(station, lease, f"{why}; nothing more is sent", now_ns)
    return replace(driven, station=station)


def give_up(
    driven: Driven, serial: str, lease: SetpointLease, why: str, now_ns: int, ask: Judge
) -> Driven:
    """End a lease that the station cannot carry on: the order fails, with an alarm."""
    phase = Phase.FAILED if lease.arrived_at_ns is None else Phase.DONE
    station = change_phase(driven.station, lease, phase, now_ns, why)
    station = _alarm(station, lease, f"{why}; it is stopped and holds", now_ns)
    return _close(replace(driven, station=station), serial, lease, why, now_ns, ask)


def leave_alone(
    driven: Driven, serial: str, lease: SetpointLease, now_ns: int, ask: Judge
) -> Driven:
    """Leave a vehicle that was held for long to its own position hold; nothing has failed."""
    held_s = driven.station.settings.streams.hold_at_most_s
    why = f"held for {held_s:g} s; from now on by the aircraft itself"
    station = change_phase(driven.station, lease, Phase.DONE, now_ns, why)
    return _close(replace(driven, station=station), serial, lease, why, now_ns, ask)


def hold(driven: Driven, serial: str, now_ns: int) -> Driven:
    """Order the hold that follows the zero; a vehicle on the ground needs none."""
    station = release(driven.station, serial, now_ns, Commanded.HOLD)
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None or vehicle.is_flying.value is False:
        return replace(driven, station=station)
    station, number = take_id(station)
    order = OperatorOrder(number, Hover(), ISSUER, serial=serial)
    return replace(driven, station=station, holds=(*driven.holds, order))


def _close(
    driven: Driven, serial: str, lease: SetpointLease, why: str, now_ns: int, ask: Judge
) -> Driven:
    """Send zero now and hold a little later; hold at once if the gate refuses even the zero."""
    vehicle = driven.station.fleet.vehicles.get(serial)
    height_m = None if vehicle is None else vehicle.height_above_takeoff_m.value
    lease = replace(lease, steered=halted(lease.steered, height_m, now_ns))
    station, answer, lease = judged(driven.station, lease, now_ns, ask)
    driven = replace(driven, station=station)
    if isinstance(answer, Refusal):
        return hold(driven, serial, now_ns)
    due_ns = now_ns + seconds_to_ns(station.settings.streams.zero_to_hold_s)
    closing = replace(lease, closing=why, next_due_ns=due_ns)
    station = put(station, serial, closing)
    return replace(driven, station=station, outputs=(*driven.outputs, SendCommand(answer)))


def _authority(station: Station, lease: SetpointLease) -> ControlAuthority:
    return station.authorities.get(lease.command.serial or "", _DEFAULT_AUTHORITY)


def _alarm(station: Station, lease: SetpointLease, why: str, now_ns: int) -> Station:
    """Note the end for a person to see; it stays until acknowledged."""
    record = station.orders.records.get(lease.command.id)
    serial = lease.command.serial
    name = serial or "" if record is None else record.vehicle_name
    condition = Condition(
        key=f"{RULE}:{lease.command.id}",
        severity=Severity.ERROR if lease.arrived_at_ns is None else Severity.WARNING,
        rule=RULE,
        vehicle_name=name,
        text=f"{name}: {lease.command.name.replace('_', ' ')}: {why}",
        serial=serial,
    )
    book = alarm_book.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book)
