"""Steered orders (goto, nudge, hold position) flown by a 10 Hz stream of virtual sticks.

Theory of operation. A stream binds one vehicle to one order. At each beat (`advance`):

1. If its pilot or a failsafe flies the vehicle, the stream ends silently: nothing more is sent.
2. If the stream is closing, its neutral setpoint was sent 0.15 s ago: it ends with a hold.
3. If it cannot continue, it is aborted: the order fails with an alarm, a neutral setpoint is sent
   at once and the hold follows. Causes: the link changed, telemetry older than `resumes_s`, another
   holder of authority, no stick mode within `obeyed_s`, the gate refused a setpoint, the connection
   that owns the order closed, or a fault in the station. If the gate refuses the very first
   setpoint, nothing is sent: the vehicle continues as before the order, as after any refusal.
4. Else the next velocity is computed from telemetry, judged by the gate and sent. With telemetry
   older than `max_telemetry_age_s` a neutral setpoint is sent instead; the stream continues.

The order is *sent* with its first packet, *started* when telemetry shows stick mode, *done* on
arrival. From then on the stream holds the place, for `hold_at_most_s`. A newer order to move or a
stop releases the stream without a packet of its own. Nothing resumes a stream that has ended: no
reconnect, no restart. `stream_ends` has the ends, `order_gateway` applies them.
"""

from collections.abc import Collection

from recon.guidance.path_following import advanced, goal_on, path_from
from recon.guidance.steering import KinematicState, begin, halted, has_arrived, steer
from recon.model.command import STEERED_BODIES, Command, FollowPath, Phase, Refusal
from recon.model.event import CommandSent, OperatorOrder
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.setpoint_stream import SetpointStream, first_due_ns, following_due_ns
from recon.station.state.station import Station
from recon.station.state.steps import Judge, SendCommand
from recon.station.steering import stream_ends
from recon.station.steering.kinematic_state import (
    goal_of,
    kinematic_state,
    no_faster_than,
    refusal_without_telemetry,
)
from recon.station.steering.stream_ends import (
    StreamUpdate,
    change_phase,
    judge_setpoint,
    with_stream,
)


def refusal_to_start(station: Station, order: OperatorOrder, now_ns: int) -> Refusal | None:
    """Return why a steered order that the gate allows cannot be begun, else None."""
    if order.owner is not None and order.owner not in station.owners:
        return Refusal(
            "owner",
            "the connection that owns the order is not open: open the stream of states and name "
            "its owner in the order",
        )
    steered = [serial for serial in station.streaming if serial != order.serial]
    most = station.settings.streams.most_at_once
    if len(steered) >= most:
        return Refusal(
            "steered_at_once",
            f"{len(steered)} vehicles are steered, at most {most} can be: hold one of them first, "
            "or send a mission",
        )
    vehicle = station.fleet.vehicles[order.serial or ""]
    return refusal_without_telemetry(vehicle, now_ns, station.settings.streams)


def start_stream(
    station: Station, command: Command, owner: str | None, now_ns: int
) -> tuple[Station, SetpointStream]:
    """Start the stream of an order just judged; its first setpoint is due at once."""
    serial, settings = command.serial or "", station.settings
    vehicle = station.fleet.vehicles[serial]
    seen = kinematic_state(vehicle, now_ns)
    assert seen is not None, "asked before by `refusal_to_start`"
    body = command.body
    assert isinstance(body, STEERED_BODIES)
    fastest_mps = station.airspace.airspace.limits.max_speed_mps
    stream = SetpointStream(
        command=command,
        owner=owner,
        goal=goal_of(body, seen, settings.steering, settings.streams),
        steered=begin(no_faster_than(seen, fastest_mps), now_ns),
        link_id=vehicle.link_id,
        started_at_ns=now_ns,
        next_due_ns=now_ns,
        seen_at_ns=now_ns - seconds_to_ns(seen.age_s),
        mode_before=vehicle.flight_mode.value,
        path=path_from(body.mission, seen) if isinstance(body, FollowPath) else None,
    )
    return with_stream(station, serial, stream), stream


def next_due_ns(station: Station) -> int | None:
    """Return when the next setpoint of any stream is due."""
    if not station.streaming:
        return None  # asked for at every event, and mostly no vehicle is steered
    return min(stream.next_due_ns for _, stream in station.streams())


def due_serials(
    station: Station, now_ns: int, serials: Collection[str] | None = None
) -> tuple[str, ...]:
    """Return the vehicles whose next setpoint is due, of these vehicles; None: of all."""
    if not station.streaming:
        return ()
    return tuple(
        serial
        for serial, stream in station.streams()
        if now_ns >= stream.next_due_ns and (serials is None or serial in serials)
    )


def owned_by(station: Station, owner: str) -> tuple[str, ...]:
    """Return the vehicles whose stream depends on a connection."""
    return tuple(serial for serial, stream in station.streams() if stream.owner == owner)


def abort(update: StreamUpdate, serial: str, why: str, now_ns: int, judge: Judge) -> StreamUpdate:
    """End a vehicle's stream as a failure, if it has one that is not ending yet."""
    stream = update.station.control(serial).stream
    if stream is None or stream.closing is not None:
        return update
    return stream_ends.abort(update, serial, stream, why, now_ns, judge)


def on_sent(station: Station, event: CommandSent, now_ns: int) -> Station:
    """Count a setpoint that has left; with the first one its order counts as sent."""
    for serial, stream in station.streams():
        if stream.last_stick_id == event.command_id:
            sent = replace(stream, packets_sent=stream.packets_sent + 1)
            if stream.first_sent_at_ns is None:
                sent = replace(sent, first_sent_at_ns=now_ns)
            station = with_stream(station, serial, sent)
            if stream.first_sent_at_ns is None:
                return change_phase(station, sent, Phase.SENT, now_ns, "its first stick")
    return station


def advance(update: StreamUpdate, serial: str, now_ns: int, judge: Judge) -> StreamUpdate:
    """Send a vehicle's next setpoint, or end its stream."""
    station = update.station
    stream, vehicle = station.control(serial).stream, station.fleet.vehicles.get(serial)
    if stream is None or vehicle is None:
        return stream_ends.release(update, serial)
    lost = stream_ends.control_lost(station, stream, vehicle)
    if lost is not None:
        return stream_ends.end_silently(update, serial, stream, lost, now_ns)
    if stream.closing is not None:
        return stream_ends.order_hold(update, serial)
    seen = kinematic_state(vehicle, now_ns)
    if seen is not None:
        seen_at_ns = now_ns - seconds_to_ns(seen.age_s)
        stream = replace(stream, seen_at_ns=max(stream.seen_at_ns, seen_at_ns))
    failure = stream_ends.failure(station, stream, vehicle, now_ns)
    if failure is not None:
        return stream_ends.abort(update, serial, stream, failure, now_ns, judge)
    if seen is not None and seen.age_s > station.settings.streams.max_telemetry_age_s:
        seen = None
    stream = _along_its_path(station, stream, seen)
    station, stream = _with_progress(station, stream, vehicle, seen, now_ns)
    update = replace(update, station=station)
    if stream_ends.has_held_long_enough(station, stream, now_ns):
        return stream_ends.end_held_place(update, serial, stream, now_ns, judge)
    stream = _with_next_setpoint(station, serial, stream, seen, now_ns)
    return _send(update, serial, stream, now_ns, judge)


def _along_its_path(
    station: Station, stream: SetpointStream, seen: KinematicState | None
) -> SetpointStream:
    """Return the stream with the goal of now, if it follows a path."""
    if stream.path is None or seen is None:
        return stream
    steering = station.settings.steering
    path = advanced(stream.path, seen, steering) if stream.is_obeyed else stream.path
    return replace(stream, path=path, goal=goal_on(path, seen, steering))


def _with_next_setpoint(
    station: Station, serial: str, stream: SetpointStream, seen: KinematicState | None, now_ns: int
) -> SetpointStream:
    """Return the stream with its next setpoint, and the time of the one after. Unseen: neutral."""
    settings = station.settings
    if seen is None:
        height_m = station.fleet.vehicles[serial].height_above_takeoff_m.value
        steered = halted(stream.steered, height_m, now_ns)
    else:
        steered = steer(stream.steered, stream.goal, seen, now_ns, settings.steering)
    if stream.last_stick_id == 0:
        others = tuple(x.next_due_ns for s, x in station.streams() if s != serial)
        due_ns = first_due_ns(others, now_ns, settings.streams)
    else:
        due_ns = following_due_ns(stream.next_due_ns, now_ns, settings.streams)
    return replace(stream, steered=steered, next_due_ns=due_ns)


def _send(
    update: StreamUpdate, serial: str, stream: SetpointStream, now_ns: int, judge: Judge
) -> StreamUpdate:
    is_first = stream.last_stick_id == 0
    station, answer, stream = judge_setpoint(update.station, stream, now_ns, judge)
    if isinstance(answer, Refusal):
        reason = f"the gate refused its setpoint: {answer.reason}"
        update = replace(update, station=stream_ends.with_refusal(station, stream, answer))
        if is_first:
            return stream_ends.end_unsent(update, serial, stream, reason, now_ns)
        return stream_ends.abort(update, serial, stream, reason, now_ns, judge)
    station = with_stream(station, serial, stream)
    return replace(update, station=station, outputs=(*update.outputs, SendCommand(answer)))


def _with_progress(
    station: Station,
    stream: SetpointStream,
    vehicle: VehicleState,
    seen: KinematicState | None,
    now_ns: int,
) -> tuple[Station, SetpointStream]:
    """Update the order's phase by telemetry: stick mode starts it, arrival ends it."""
    if not stream.is_obeyed and _shows_sticks(stream, vehicle):
        stream = replace(stream, is_obeyed=True)
        note = "telemetry shows stick mode"
        station = change_phase(station, stream, Phase.STARTED, now_ns, note)
    is_at_goal = seen is not None and has_arrived(stream.goal, seen, station.settings.steering)
    has_come = is_at_goal and (stream.path is None or stream.path.is_on_last_leg)
    if stream.is_obeyed and stream.arrived_at_ns is None and has_come:
        stream = replace(stream, arrived_at_ns=now_ns)
        note = "telemetry shows it arrived; position held"
        station = change_phase(station, stream, Phase.DONE, now_ns, note)
    return station, stream


def _shows_sticks(stream: SetpointStream, vehicle: VehicleState) -> bool:
    """Whether telemetry newer than the first setpoint shows stick mode; an old one may linger."""
    mode, sent_at_ns = vehicle.flight_mode, stream.first_sent_at_ns
    if mode.value is not FlightMode.JOYSTICK or mode.received_at_ns is None or sent_at_ns is None:
        return False
    lingers_s = 1.0 if stream.mode_before is FlightMode.JOYSTICK else 0.0
    return mode.received_at_ns > sent_at_ns + seconds_to_ns(lingers_s)
