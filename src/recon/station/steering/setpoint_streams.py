"""Steered orders carried out: a stream of sticks at 10 Hz, each approved by the gate anew.

A lease binds one vehicle to one order. It ends at once, and for good, when a newer order to move,
a stop, the pilot or a failsafe comes: then nothing more is sent for it. When the station itself
must give up (`stream_ends`), zero is sent at once and hold a beat later, both through the gate.
Nothing resumes a lease that has ended: no reconnect, no restart.
"""

from collections.abc import Collection

from recon.guidance.steering import KinematicState, begin, halted, has_arrived, steer
from recon.model.command import STEERED_BODIES, Command, Phase, Refusal
from recon.model.event import CommandSent, OperatorOrder
from recon.model.intent import Commanded, Intent
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.outputs import SendCommand
from recon.station.state.setpoint_lease import SetpointLease, first_due_ns, following_due_ns
from recon.station.state.station import Station
from recon.station.state.stepped import Judge
from recon.station.steering import stream_ends
from recon.station.steering.kinematic_state import goal_of, no_faster_than, sight, unseen
from recon.station.steering.stream_ends import Driven, change_phase, judged, put


def unsteerable(station: Station, order: OperatorOrder, now_ns: int) -> Refusal | None:
    """Return why a steered order that the gate allows cannot be begun, else None."""
    if order.owner is not None and order.owner not in station.owners:
        return Refusal(
            "owner",
            "the connection that was to hold the order is not open (any more): open the stream of "
            "states, and name its owner in the order",
        )
    steered = [serial for serial in station.streams if serial != order.serial]
    most = station.settings.streams.most_at_once
    if len(steered) >= most:
        return Refusal(
            "steered_at_once",
            f"{len(steered)} vehicles are steered already, {most} at once are possible: hold one "
            "of them first, or send a mission",
        )
    vehicle = station.fleet.vehicles[order.serial or ""]
    return unseen(vehicle, now_ns, station.settings.streams)


def lease_out(station: Station, command: Command, owner: str | None, now_ns: int) -> Station:
    """Return the station with a vehicle leased to an order just judged; a stick is due at once."""
    serial, settings = command.serial or "", station.settings
    vehicle = station.fleet.vehicles[serial]
    seen = sight(vehicle, now_ns)
    assert seen is not None, "asked before by `unsteerable`"
    assert isinstance(command.body, STEERED_BODIES)
    goal = goal_of(command.body, seen, settings.steering, settings.streams)
    fastest_mps = station.airspace.airspace.limits.max_speed_mps
    lease = SetpointLease(
        command=command,
        owner=owner,
        goal=goal,
        steered=begin(no_faster_than(seen, fastest_mps), now_ns),
        link_id=vehicle.link_id,
        started_at_ns=now_ns,
        next_due_ns=now_ns,
        seen_at_ns=now_ns - seconds_to_ns(seen.age_s),
        mode_before=vehicle.flight_mode.value,
    )
    intent = Intent(
        Commanded.STICK,
        now_ns,
        command.id,
        target=goal.target,
        target_height_above_takeoff_m=goal.height_above_takeoff_m,
        speed_mps=goal.speed_mps,
    )
    station = replace(station, intents={**station.intents, serial: intent})
    return put(station, serial, lease)


def release(station: Station, serial: str | None, now_ns: int) -> Station:
    """Return the station without a vehicle's lease: what comes instead has taken over."""
    return stream_ends.release(station, serial, now_ns)


def next_due_ns(station: Station) -> int | None:
    """Return when the next stick of any lease is due."""
    return min((lease.next_due_ns for lease in station.streams.values()), default=None)


def drive(
    station: Station, now_ns: int, ask: Judge, serials: Collection[str] | None = None
) -> Driven:
    """Carry on every lease that is due, or of these vehicles: its next stick, or its end."""
    driven = Driven(station)
    for serial, lease in station.streams.items():
        if now_ns >= lease.next_due_ns and (serials is None or serial in serials):
            driven = _drive(driven, serial, lease, now_ns, ask)
    return driven


def end_held_by(station: Station, owner: str, now_ns: int, ask: Judge) -> Driven:
    """End the leases of a connection that has gone."""
    driven = Driven(replace(station, owners=station.owners - {owner}))
    for serial, lease in station.streams.items():
        if lease.owner == owner and lease.closing is None:
            reason = "the connection that held the order has gone"
            driven = stream_ends.give_up(driven, serial, lease, reason, now_ns, ask)
    return driven


def end(station: Station, serial: str | None, why: str, now_ns: int, ask: Judge) -> Driven:
    """End a vehicle's lease, if it has one, as a failure."""
    lease = station.streams.get(serial or "")
    if lease is None or lease.closing is not None:
        return Driven(station)
    return stream_ends.give_up(Driven(station), serial or "", lease, why, now_ns, ask)


def on_sent(station: Station, event: CommandSent, now_ns: int) -> Station:
    """Count a stick that has left; with the first one its order counts as sent."""
    for serial, lease in station.streams.items():
        if lease.last_stick_id == event.command_id:
            sent = replace(lease, packets_sent=lease.packets_sent + 1)
            if lease.first_sent_at_ns is None:
                sent = replace(sent, first_sent_at_ns=now_ns)
            station = put(station, serial, sent)
            if lease.first_sent_at_ns is None:
                return change_phase(station, sent, Phase.SENT, now_ns, "its first stick")
    return station


def _drive(driven: Driven, serial: str, lease: SetpointLease, now_ns: int, ask: Judge) -> Driven:
    station = driven.station
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None:
        return replace(driven, station=stream_ends.release(station, serial, now_ns))
    taken = stream_ends.taken(station, lease, vehicle)
    if taken is not None:
        return stream_ends.let_go(driven, serial, lease, taken, now_ns)
    if lease.closing is not None:
        return stream_ends.hold(driven, serial, now_ns)
    seen = sight(vehicle, now_ns)
    if seen is not None:
        seen_at_ns = now_ns - seconds_to_ns(seen.age_s)
        lease = replace(lease, seen_at_ns=max(lease.seen_at_ns, seen_at_ns))
    failure = stream_ends.failure(station, lease, vehicle, now_ns)
    if failure is not None:
        return stream_ends.give_up(driven, serial, lease, failure, now_ns, ask)
    if seen is not None and seen.age_s > station.settings.streams.sight_s:
        seen = None
    station, lease = _followed(station, lease, vehicle, seen, now_ns)
    driven = replace(driven, station=station)
    if stream_ends.has_held_long_enough(station, lease, now_ns):
        return stream_ends.leave_alone(driven, serial, lease, now_ns, ask)
    return _send(driven, serial, _demanded(station, serial, lease, seen, now_ns), now_ns, ask)


def _demanded(
    station: Station, serial: str, lease: SetpointLease, seen: KinematicState | None, now_ns: int
) -> SetpointLease:
    """Return the lease with its next demand, and the time of the one after. Unseen: zero."""
    settings = station.settings
    if seen is None:
        height_m = station.fleet.vehicles[serial].height_above_takeoff_m.value
        steered = halted(lease.steered, height_m, now_ns)
    else:
        steered = steer(lease.steered, lease.goal, seen, now_ns, settings.steering)
    if lease.last_stick_id == 0:
        others = tuple(x.next_due_ns for s, x in station.streams.items() if s != serial)
        due_ns = first_due_ns(others, now_ns, settings.streams)
    else:
        due_ns = following_due_ns(lease.next_due_ns, now_ns, settings.streams)
    return replace(lease, steered=steered, next_due_ns=due_ns)


def _send(driven: Driven, serial: str, lease: SetpointLease, now_ns: int, ask: Judge) -> Driven:
    station, answer, lease = judged(driven.station, lease, now_ns, ask)
    if isinstance(answer, Refusal):
        reason = f"the gate refused its stick: {answer.rule}: {answer.reason}"
        driven = replace(driven, station=station)
        return stream_ends.give_up(driven, serial, lease, reason, now_ns, ask)
    station = put(station, serial, lease)
    return replace(driven, station=station, outputs=(*driven.outputs, SendCommand(answer)))


def _followed(
    station: Station,
    lease: SetpointLease,
    vehicle: VehicleState,
    seen: KinematicState | None,
    now_ns: int,
) -> tuple[Station, SetpointLease]:
    """Take what telemetry shows into the order's life: sticks fly the vehicle, it is there."""
    if not lease.is_obeyed and _shows_sticks(lease, vehicle):
        lease = replace(lease, is_obeyed=True)
        note = "by telemetry: it flies by sticks"
        station = change_phase(station, lease, Phase.STARTED, now_ns, note)
    has_come = seen is not None and has_arrived(lease.goal, seen, station.settings.steering)
    if lease.is_obeyed and lease.arrived_at_ns is None and has_come:
        lease = replace(lease, arrived_at_ns=now_ns)
        note = "by telemetry: it is there, and is held there"
        station = change_phase(station, lease, Phase.DONE, now_ns, note)
    return station, lease


def _shows_sticks(lease: SetpointLease, vehicle: VehicleState) -> bool:
    """Whether telemetry newer than the first stick says so; a mode it was in before may linger."""
    mode, sent_at_ns = vehicle.flight_mode, lease.first_sent_at_ns
    if mode.value is not FlightMode.JOYSTICK or mode.received_at_ns is None or sent_at_ns is None:
        return False
    lingers_s = 1.0 if lease.mode_before is FlightMode.JOYSTICK else 0.0
    return mode.received_at_ns > sent_at_ns + seconds_to_ns(lingers_s)
