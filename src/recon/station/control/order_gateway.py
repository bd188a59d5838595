"""The only door for orders: each is judged by the gate, recorded, sent, and updated to its end.

Nothing else asks the gate's approval. `situation_builder` makes what the gate judges by,
`order_records` the records, `order_timeouts` and `mode_tracking` decide what telemetry and time
make of them. Setpoint streams run in `steering`; what they return is applied here.
"""

from collections.abc import Collection, Iterable

from recon.fleet.confirmation import Progress
from recon.link.outbox import Lane, lane_of
from recon.model.command import STEERED_BODIES, Command, Phase, Refusal
from recon.model.event import CommandAnswered, CommandDropped, CommandSent, OperatorOrder
from recon.model.replacing import replace
from recon.model.vehicle import VehicleState
from recon.safety import ApprovedCommand, approve, judge
from recon.station.control import (
    authority,
    intents,
    late_starts,
    missions,
    mode_tracking,
    operator_lease,
    order_timeouts,
    takeoff_stops,
)
from recon.station.control.order_records import (
    may_wait,
    put,
    queued_record,
    refused_record,
    replace_older_orders,
    sent_context,
    steered_record,
    target_of,
    waiting_record,
)
from recon.station.control.situation_builder import command_of, situation
from recon.station.control.withdrawal import withdraw
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Judge, Output, SendCommand, Stepped
from recon.station.steering import neutral_setpoint, setpoint_streams, stream_ends
from recon.station.steering.stream_ends import StreamUpdate

DRY_RUN_ID = 0
"""The id of an order that is only checked; a submitted order never has it."""


def submit(station: Station, order: OperatorOrder, now_ns: int) -> Stepped:
    """Judge an order; send it if the gate approves it, record the refusal if not."""
    command = command_of(station, order, now_ns)
    station = authority.after_stop(station, command, now_ns)
    if command.is_emergency and not command.takeoff:
        return _stop(station, command, now_ns)
    if isinstance(command.body, STEERED_BODIES):
        return _steer(station, order, command, now_ns)
    flight_plan = missions.plan(station, command)
    facts = situation(station, command, now_ns)
    first = missions.present_part(command, flight_plan)
    judged = missions.refusal_of_whole(command, flight_plan, facts) or approve(first, facts)
    if isinstance(judged, Refusal):
        refused = replace(refused_record(station, command, judged, now_ns), plan=flight_plan)
        return _end_stream_for(put(station, refused), command, now_ns)
    if lane_of(command) is not Lane.CAMERA:
        station = neutral_setpoint.cancel(station, command.serial)
        station = release_stream(station, command.serial, now_ns)
    station = operator_lease.after_order(station, command, now_ns)
    station = replace_older_orders(station, command, now_ns)
    queued = replace(queued_record(station, command, judged, now_ns), plan=flight_plan)
    return put(station, queued), (SendCommand(judged),)


def _stop(station: Station, command: Command, now_ns: int) -> Stepped:
    """Give a hold, landing or return; whatever the gate answers, what waits unsent ends first."""
    takeoff = takeoff_stops.takeoff_under_way(station, command, now_ns)
    withdrawn: tuple[Output, ...] = ()
    if command.serial is not None:
        why = f"{command.name.replace('_', ' ')}, order {command.id}"
        station, withdrawn = withdraw(station, command.serial, why, now_ns)
    judged = approve(command, situation(station, command, now_ns))
    sent: tuple[Output, ...] = ()
    if takeoff is not None:
        record = takeoff_stops.following_record(station, command, takeoff, now_ns)
    elif isinstance(judged, ApprovedCommand):
        record = queued_record(station, command, judged, now_ns)
        sent = (SendCommand(judged),)
    elif may_wait(command, judged):
        record = waiting_record(station, command, judged, now_ns)
    else:
        refused = refused_record(station, command, judged, now_ns)
        station, ended = _end_stream_for(put(station, refused), command, now_ns)
        return station, (*withdrawn, *ended)
    station = neutral_setpoint.cancel(station, command.serial)
    station = release_stream(station, command.serial, now_ns)
    station = replace_older_orders(station, command, now_ns)
    station = put(station, record)
    if takeoff is not None:
        station, sent = _update_order(station, record, now_ns)
    return station, (*withdrawn, *sent)


def dry_run(
    station: Station, orders: Iterable[OperatorOrder], now_ns: int
) -> tuple[OrderRecord, ...]:
    """Return the record each order would get now, after those before it. Nothing is sent."""
    records: list[OrderRecord] = []
    for order in orders:
        station, _ = submit(station, order, now_ns)
        records.append(station.orders.records[order.command_id])
    return tuple(records)


def record_refusal(
    station: Station, order: OperatorOrder, refusal: Refusal, now_ns: int
) -> Station:
    """Return the station with an order recorded that is refused before the gate is asked."""
    command = command_of(station, order, now_ns)
    return put(station, refused_record(station, command, refusal, now_ns))


def _steer(station: Station, order: OperatorOrder, command: Command, now_ns: int) -> Stepped:
    """Judge a steered order as a whole; start its setpoint stream."""
    refusal = judge(command, situation(station, command, now_ns))
    refusal = refusal or setpoint_streams.refusal_to_start(station, order, now_ns)
    if refusal is not None:
        return put(station, refused_record(station, command, refusal, now_ns)), ()
    station = neutral_setpoint.cancel(station, command.serial)
    station = release_stream(station, command.serial, now_ns)
    station = operator_lease.after_order(station, command, now_ns)
    station = replace_older_orders(station, command, now_ns)
    station = put(station, steered_record(station, command, now_ns))
    station, stream = setpoint_streams.start_stream(station, command, order.owner, now_ns)
    station = intents.with_intent(station, command.serial or "", intents.of_stream(stream))
    return update_streams(station, now_ns)


def update_streams(
    station: Station, now_ns: int, serials: Collection[str] | None = None
) -> Stepped:
    """Send the setpoints that are due, and end the streams that are over; None: of all vehicles."""
    judge, update = _judge_at(now_ns), StreamUpdate(station)
    for serial in setpoint_streams.due_serials(station, now_ns, serials):
        update = setpoint_streams.advance(update, serial, now_ns, judge)
        update = _with_corners_passed(_with_intents(update, now_ns), serial)
    return _apply(update, now_ns)


def end_streams(station: Station, serials: Collection[str], why: str, now_ns: int) -> Stepped:
    """End the streams of some vehicles as failures: neutral setpoint, then hold."""
    judge, update = _judge_at(now_ns), StreamUpdate(station)
    for serial in serials:
        update = setpoint_streams.abort(update, serial, why, now_ns, judge)
        update = _with_intents(update, now_ns)
    return _apply(update, now_ns)


def release_stream(station: Station, serial: str | None, now_ns: int) -> Station:
    """Return the station without a vehicle's stream: another order takes over."""
    update = stream_ends.release(StreamUpdate(station), serial or "")
    return _with_intents(update, now_ns).station


def _end_stream_for(station: Station, refused: Command, now_ns: int) -> Stepped:
    """End the stream of a vehicle whose stop was refused: it must not be steered on."""
    if not refused.is_emergency:
        return station, ()
    why = f"{refused.name.replace('_', ' ')} was ordered, and refused"
    return end_streams(station, (refused.serial or "",), why, now_ns)


def on_owner_disconnected(station: Station, owner: str, now_ns: int) -> Stepped:
    """End the streams that depended on a connection."""
    station = replace(station, owners=station.owners - {owner})
    serials = setpoint_streams.owned_by(station, owner)
    return end_streams(station, serials, "the connection that owns the order closed", now_ns)


def _judge_at(now_ns: int) -> Judge:
    return lambda station, command: approve(command, situation(station, command, now_ns))


def _with_intents(update: StreamUpdate, now_ns: int) -> StreamUpdate:
    """Set the intents of released vehicles: the gate judges the next setpoint by them."""
    if not update.released:
        return update
    station = update.station
    for serial, command_id, commanded in update.released:
        station = intents.after_stream(station, serial, command_id, commanded, now_ns)
    return replace(update, station=station, released=())


def _with_corners_passed(update: StreamUpdate, serial: str) -> StreamUpdate:
    """Count the waypoints of a steered path in its vehicle's intent, by which others keep clear."""
    stream = update.station.control(serial).stream
    if stream is None or stream.path is None:
        return update
    return replace(update, station=intents.with_passed(update.station, serial, stream.path.index))


def _apply(update: StreamUpdate, now_ns: int) -> Stepped:
    station, outputs = update.station, update.outputs
    for serial, why in update.pilot_takeovers:
        station, withdrawn = authority.give_to_pilot(station, serial, now_ns, why)
        outputs += withdrawn
    for order in update.holds:
        station, sent = submit(station, order, now_ns)
        outputs += sent
    return station, outputs


def on_link_event(
    station: Station, event: CommandSent | CommandAnswered | CommandDropped, now_ns: int
) -> Station:
    """Return the station after a link sent, dropped or got an answer to a command."""
    record = station.orders.records.get(event.command_id)
    if record is None:
        # Setpoints have no record of their own.
        if not isinstance(event, CommandSent):
            return station
        return setpoint_streams.on_sent(station, event, now_ns)
    match event:
        case CommandSent():
            station = neutral_setpoint.begin(station, record.command, now_ns)
            return _on_sent(station, record, event, now_ns)
        case CommandAnswered():
            return put(station, orders.on_answered(record, event, now_ns))
        case CommandDropped():
            return put(station, orders.on_dropped(record, event, now_ns))


def _on_sent(station: Station, record: OrderRecord, event: CommandSent, now_ns: int) -> Station:
    """Make the order its vehicle's intent from its first sending on."""
    context = sent_context(station, record, now_ns)
    is_first = record.sent is None and not record.phase.is_final
    station = put(station, orders.on_sent(record, event, context))
    target = target_of(station, record.command)
    if not is_first or target is None or target.serial is None:
        return station
    body = missions.present_part(record.command, record.plan).body
    return mode_tracking.on_order_sent(station, target.serial, record.command.id, body, context)


def update_orders(station: Station, now_ns: int, serials: tuple[str, ...] | None = None) -> Stepped:
    """Update open orders by telemetry and time; repeat emergency orders.

    `serials` are the vehicles whose packet arrived; None at a tick, for all. A packet shows nothing
    of other vehicles' orders, and right after an all stop every vehicle has one.
    """
    outputs: tuple[Output, ...] = ()
    for record in station.orders.tracked:
        if serials is not None and record.command.serial not in (None, *serials):
            continue
        if not isinstance(record.command.body, STEERED_BODIES):  # its stream reports its phases
            station, sent = _update_order(station, record, now_ns)
            outputs += sent
    tracked = (
        mode_tracking.without_recent_telemetry(station, now_ns) if serials is None else serials
    )
    for stop in late_starts.stops_again(station, tracked, now_ns):
        station, number = take_id(station)
        station, sent = submit(station, replace(stop, command_id=number), now_ns)
        outputs += sent
    station, sent = mode_tracking.track(station, tracked, now_ns, _judge_at(now_ns))
    outputs += sent
    station, neutrals = neutral_setpoint.due(station, now_ns)
    for ended, order in neutrals:
        station, sent = submit(station, order, now_ns)
        station = neutral_setpoint.after(station, ended, now_ns)
        outputs += sent
    return neutral_setpoint.drop_overdue(station, now_ns), outputs


def _update_order(station: Station, record: OrderRecord, now_ns: int) -> Stepped:
    target = target_of(station, record.command)
    if target is None:
        note = "its connection closed before telemetry showed its end"
        return put(station, orders.ended(record, Phase.FAILED, now_ns, note)), ()
    pilot = order_timeouts.pilot_takeover(station, record, target)
    if pilot is not None:
        return _on_pilot_takeover(station, record, target, pilot, now_ns)
    if record.alarm == orders.MISSION_BROKEN_OFF and target.is_flying.value is False:
        return put(station, replace(record, alarm=None)), ()
    outputs: tuple[Output, ...] = ()
    is_flown = record.phase is Phase.STARTED  # `mode_tracking` finds its end
    seen = (
        Progress.UNSEEN if is_flown else order_timeouts.progress_of(station, record, target, now_ns)
    )
    seen = takeoff_stops.shown_so_far(record, seen, now_ns)
    updated = orders.shown(orders.stick_over(record, now_ns), seen, now_ns)
    if updated.is_tracked:
        updated = order_timeouts.after_time(station, updated, target, seen, now_ns)
    if updated.next_repeat_ns is not None and now_ns >= updated.next_repeat_ns:
        updated, outputs = order_timeouts.repeat(station, updated, _judge_at(now_ns), now_ns)
    if updated is not record:
        station = put(station, updated)
        station = order_timeouts.with_intent_of(station, record, updated, seen, now_ns)
    return station, outputs


def _on_pilot_takeover(
    station: Station, record: OrderRecord, target: VehicleState, why: str, now_ns: int
) -> Stepped:
    note = f"the pilot has taken over: {why}"
    station = put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note))
    if target.serial is None:
        return station, ()
    return mode_tracking.on_pilot_takeover(station, target.serial, why, now_ns)
