"""Orders carried out: judged by the gate, superseded, repeated, confirmed, timed out."""

from collections.abc import Collection

from recon.fleet.confirmation import Progress, SentContext, progress, reading_of_sent
from recon.fleet.flight_table import Verdict
from recon.link.outbox import Lane, lane_of
from recon.model.authority import Lead
from recon.model.command import (
    CAMERA_BODIES,
    STEERED_BODIES,
    Command,
    FlyMission,
    Hover,
    Phase,
    Refusal,
    VirtualStick,
)
from recon.model.event import CommandAnswered, CommandDropped, CommandSent, OperatorOrder
from recon.model.intent import Intent
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety import ApprovedCommand, Claimant, Situation, Traffic, approve, judge
from recon.safety.facts import NO_FACTS
from recon.station import (
    authority,
    flight_watch,
    going_home,
    intents,
    missions,
    orders,
    preflight,
    stick_zero,
    streams,
)
from recon.station.air import in_the_air, setting_out
from recon.station.orders import OrderRecord, PhaseChange
from recon.station.outputs import Output, SendCommand
from recon.station.settings import StationSettings
from recon.station.state import Station
from recon.station.stream_ends import Ask, Driven
from recon.vehicles.packets import describe_altitudes

_NOBODY_YET = Lead()
_TOLD_NOTHING = Intent()

Stepped = tuple[Station, tuple[Output, ...]]


def place(station: Station, order: OperatorOrder, now_ns: int) -> Stepped:
    """Judge an order; send it when the gate approves, record the refusal when not."""
    command = command_of(station, order, now_ns)
    station = authority.after_stop(station, command, now_ns)
    if isinstance(command.body, STEERED_BODIES):
        return _steer(station, order, command, now_ns)
    flight_plan = missions.plan(station, command)
    seen = situation(station, command, now_ns)
    first = missions.present_part(command, flight_plan)
    judged = missions.refusal_of_whole(command, flight_plan, seen) or approve(first, seen)
    if isinstance(judged, Refusal):
        if _may_wait(command, judged):
            station = streams.release(station, command.serial, now_ns)
            station = _supersede_older(station, command, now_ns)
            return _put(station, _waiting(station, command, judged, now_ns)), ()
        refused = replace(_refused(station, command, judged, now_ns), plan=flight_plan)
        station = _put(station, refused)
        return _end_stream_for(station, command, now_ns)
    if lane_of(command) is not Lane.CAMERA:
        station = stick_zero.forget(station, command)
        station = streams.release(station, command.serial, now_ns)
    station = _supersede_older(station, command, now_ns)
    queued = replace(_queued(station, command, judged, now_ns), plan=flight_plan)
    return _put(station, queued), (SendCommand(judged),)


def _steer(station: Station, order: OperatorOrder, command: Command, now_ns: int) -> Stepped:
    """Judge a steered order as a whole; lease its vehicle to it and send its first stick."""
    refusal = judge(command, situation(station, command, now_ns))
    refusal = refusal or streams.unsteerable(station, order, now_ns)
    if refusal is not None:
        return _put(station, _refused(station, command, refusal, now_ns)), ()
    station = stick_zero.forget(station, command)
    station = streams.release(station, command.serial, now_ns)
    station = _supersede_older(station, command, now_ns)
    queued = PhaseChange(Phase.QUEUED, now_ns, "")
    station = _put(station, OrderRecord(command, _name(station, command), (queued,)))
    station = streams.lease_out(station, command, order.holder, now_ns)
    return drive_streams(station, now_ns)


def drive_streams(station: Station, now_ns: int, serials: Collection[str] | None = None) -> Stepped:
    """Send the sticks that are due, and end the streams that are over; None: of all vehicles."""
    return _after(streams.drive(station, now_ns, _ask(now_ns), serials), now_ns)


def end_stream(station: Station, serial: str, why: str, now_ns: int) -> Stepped:
    """End a vehicle's stream as a failure: zero, then hold."""
    return _after(streams.end(station, serial, why, now_ns, _ask(now_ns)), now_ns)


def _end_stream_for(station: Station, refused: Command, now_ns: int) -> Stepped:
    """Who asks for a stop does not want to be steered on, even where the stop itself is refused."""
    if not refused.is_emergency:
        return station, ()
    why = f"{refused.name.replace('_', ' ')} was ordered, and refused"
    return end_stream(station, refused.serial or "", why, now_ns)


def holder_gone(station: Station, holder: str, now_ns: int) -> Stepped:
    """End the streams that a connection held: zero, then hold."""
    return _after(streams.end_held_by(station, holder, now_ns, _ask(now_ns)), now_ns)


def _ask(now_ns: int) -> Ask:
    return lambda station, command: approve(command, situation(station, command, now_ns))


def _after(driven: Driven, now_ns: int) -> Stepped:
    station, outputs = driven.station, driven.outputs
    for serial, why in driven.pilots:
        station, withdrawn = authority.pilot_has_it(station, serial, now_ns, why)
        outputs += withdrawn
    for order in driven.holds:
        station, sent = place(station, order, now_ns)
        outputs += sent
    return station, outputs


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
        asked_as=order.asked_as,
    )


def refuse(station: Station, order: OperatorOrder, refusal: Refusal, now_ns: int) -> Station:
    """Return the station with an order on record that is refused before the gate is asked."""
    command = command_of(station, order, now_ns)
    return _put(station, _refused(station, command, refusal, now_ns))


def situation(station: Station, command: Command, now_ns: int) -> Situation:
    """Return the snapshot the gate judges a command by.

    The others in the air matter to what sets a vehicle in motion alone: a stop waits for no look
    at all of them.
    """
    target = station.target(command.serial, command.link_id)
    serial = "" if target is None or target.serial is None else target.serial
    needs_checklist = isinstance(command.body, FlyMission) or command.takeoff
    return Situation(
        now_ns=now_ns,
        vehicle=target,
        claimants=_claimants(station, command),
        settings=station.settings.safety,
        airspace=station.airspace,
        lead=station.leads.get(serial, _NOBODY_YET),
        intent=station.intents.get(serial, _TOLD_NOTHING),
        stick_height_above_takeoff_m=_stick_height_m(station, serial),
        traffic=_traffic(station, command, serial, now_ns) if command.moves else (),
        preflight_override=station.preflight_overrides.get(serial),
        facts=preflight.facts(station, target) if needs_checklist else NO_FACTS,
    )


def _stick_height_m(station: Station, serial: str) -> float | None:
    """The height above takeoff that a vehicle's newest stick asked for."""
    lease = station.streams.get(serial)
    if lease is not None:
        return lease.steered.height_above_takeoff_m
    pending = station.sticks.get(serial)
    if pending is not None:
        return pending.body.height_above_takeoff_m
    return station.intents.get(serial, _TOLD_NOTHING).target_height_above_takeoff_m


def _traffic(station: Station, command: Command, serial: str, now_ns: int) -> tuple[Traffic, ...]:
    """Every other vehicle that flies or was last known to, heard or not, or is about to fly."""
    about_to = tuple(
        Traffic(state, intent)
        for state, intent in setting_out(station, now_ns)
        if state.serial != serial
    )
    return about_to + tuple(
        Traffic(state, station.intents.get(state.serial or "", _TOLD_NOTHING))
        for state, claimed in in_the_air(station)
        if state.serial is None or state.serial != serial
        if claimed is None or claimed != command.serial
        if state.serial is not None or state.link_id is None or state.link_id != command.link_id
    )


def follow(
    station: Station, event: CommandSent | CommandAnswered | CommandDropped, now_ns: int
) -> Station:
    """Take what a link says of a command into its life."""
    record = station.orders.records.get(event.command_id)
    if record is None:
        return (
            streams.on_sent(station, event, now_ns) if isinstance(event, CommandSent) else station
        )
    match event:
        case CommandSent():
            station = stick_zero.begin(station, record.command, now_ns)
            return _sent(station, record, event, now_ns)
        case CommandAnswered():
            return _put(station, orders.on_answered(record, event, now_ns))
        case CommandDropped():
            return _put(station, orders.on_dropped(record, event, now_ns))


def _sent(station: Station, record: OrderRecord, event: CommandSent, now_ns: int) -> Station:
    """An order has left: from its first sending on it is what the vehicle does."""
    context = _context(station, record, now_ns)
    is_first = record.sent is None and not record.phase.is_final
    station = _put(station, orders.on_sent(record, event, context))
    target = _target(station, record.command)
    if not is_first or target is None or target.serial is None:
        return station
    body = missions.present_part(record.command, record.plan).body
    return intents.on_sent(station, target.serial, record.command.id, body, context)


def watch(station: Station, now_ns: int, serials: tuple[str, ...] | None = None) -> Stepped:
    """Let time and telemetry change the orders still alive; repeat emergency orders.

    `serials` are the vehicles that have spoken; None: time went on for all. What one says shows
    nothing of the others' orders, and right after an all stop every vehicle has one.
    """
    outputs: tuple[Output, ...] = ()
    for record in station.orders.watched:
        if serials is not None and record.command.serial not in (None, *serials):
            continue
        if not isinstance(record.command.body, STEERED_BODIES):  # a stream tells its order's life
            station, sent = _watch_order(station, record, now_ns)
            outputs += sent
    seen = flight_watch.silent(station, now_ns) if serials is None else serials
    station, sent = flight_watch.follow(station, seen, now_ns, _ask(now_ns))
    outputs += sent
    station, zeros = stick_zero.due(station, now_ns)
    for order in zeros:
        station, sent = place(station, order, now_ns)
        station = stick_zero.forget(station, order)
        outputs += sent
    return stick_zero.give_up(station, now_ns), outputs


def _watch_order(station: Station, record: OrderRecord, now_ns: int) -> Stepped:
    """Let time and telemetry change one order."""
    target = _target(station, record.command)
    if target is None:
        note = "its connection closed before telemetry showed its end"
        return _put(station, orders.ended(record, Phase.FAILED, now_ns, note)), ()
    pilot = _pilot_of(station, record, target)
    if pilot is not None:
        return _pilot_has_it(station, record, target, pilot, now_ns)
    if record.alarm == orders.MISSION_BROKEN_OFF and target.is_flying.value is False:
        return _put(station, replace(record, alarm=None)), ()
    outputs: tuple[Output, ...] = ()
    is_flown = record.phase is Phase.STARTED  # its end is the flight table's matter
    seen = Progress.UNSEEN if is_flown else _progress(station, record, target, now_ns)
    updated = orders.shown(orders.stick_over(record, now_ns), seen, now_ns)
    if updated.is_watched:
        updated = _time_out(updated, target, seen, station.settings, now_ns)
    if updated.next_repeat_ns is not None and now_ns >= updated.next_repeat_ns:
        updated, outputs = _repeat(station, updated, now_ns)
    if updated is not record:
        station = _follow_life(_put(station, updated), record, updated, seen, now_ns)
    return station, outputs


def _pilot_of(station: Station, record: OrderRecord, target: VehicleState) -> str | None:
    """Return why an order that telemetry has not shown meets a pilot, else None."""
    if record.sent is None or isinstance(record.command.body, CAMERA_BODIES) or _is_shown(record):
        return None
    body = missions.present_part(record.command, record.plan).body
    states = (target, *_flying_rivals(station, record, target))
    readings = [reading_of_sent(body, record.sent, state) for state in states]
    is_pilot = all(r.verdict is Verdict.PILOT and r.is_at_once for r in readings)
    return readings[0].why if is_pilot else None


def _pilot_has_it(
    station: Station, record: OrderRecord, target: VehicleState, why: str, now_ns: int
) -> Stepped:
    note = f"the pilot has taken over: {why}"
    station = _put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note))
    if target.serial is None:
        return station, ()
    return flight_watch.pilot_has_it(station, target.serial, why, now_ns)


def _follow_life(
    station: Station, before: OrderRecord, record: OrderRecord, seen: Progress, now_ns: int
) -> Station:
    """Keep what the vehicle does true to what telemetry has just shown of an order."""
    target = _target(station, record.command)
    if target is None or target.serial is None:
        return station
    body = missions.present_part(record.command, record.plan).body
    if isinstance(body, VirtualStick) and record.phase is Phase.DONE:
        return intents.holds_here(station, target.serial, now_ns)
    is_news = record.phase is not before.phase or record.alarm is not before.alarm
    if seen >= Progress.CONFIRMED and is_news and not isinstance(body, CAMERA_BODIES):
        return intents.begun(station, target.serial, record.command.id, body, now_ns)
    return station


def _claimants(station: Station, command: Command) -> tuple[Claimant, ...]:
    fleet = station.fleet
    if command.serial is not None:
        link_ids = fleet.link_ids_claiming(command.serial)
    else:
        target = station.target(None, command.link_id)
        link_ids = () if target is None or target.link_id is None else (target.link_id,)
    states = ((link_id, fleet.vehicle_of_link(link_id)) for link_id in link_ids)
    return tuple(Claimant(link_id, s.is_flying) for link_id, s in states if s is not None)


def _refused(station: Station, command: Command, refusal: Refusal, now_ns: int) -> OrderRecord:
    note = f"{refusal.rule}: {refusal.reason}"
    change = PhaseChange(Phase.REFUSED_BY_STATION, now_ns, note)
    return OrderRecord(command, _name(station, command), (change,))


def _may_wait(command: Command, refusal: Refusal) -> bool:
    """Whether a stop is refused only because the vehicle, last known to fly, is not heard now."""
    return isinstance(command.body, Hover) and not command.takeoff and refusal.is_unheard


def _waiting(station: Station, command: Command, refusal: Refusal, now_ns: int) -> OrderRecord:
    expires_at_ns = now_ns + seconds_to_ns(station.settings.stop_waits_s)
    note = f"waits until it is heard again: {refusal.reason}"
    return OrderRecord(
        command=replace(command, expires_at_ns=expires_at_ns),
        vehicle_name=_name(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        next_repeat_ns=now_ns,
        repeats_left=station.settings.emergency_repeats,
        waits_to_be_heard=True,
    )


def _queued(
    station: Station, command: Command, approved: ApprovedCommand, now_ns: int
) -> OrderRecord:
    settings = station.settings
    repeat_ns = now_ns + seconds_to_ns(settings.emergency_repeat_s)
    note = going_home.said_of(command.body, _target(station, command))
    return OrderRecord(
        command=command,
        vehicle_name=_name(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        altitudes=describe_altitudes(command.body, approved.altitude_offset_m),
        next_repeat_ns=repeat_ns if command.is_emergency else None,
        repeats_left=settings.emergency_repeats if command.is_emergency else 0,
        waiting_link_ids=approved.link_ids,
    )


def _name(station: Station, command: Command) -> str:
    target = station.target(command.serial, command.link_id)
    if target is not None:
        return target.display_name
    profile = station.fleet.profiles.get(command.serial or "")
    return profile.display_name if profile is not None else command.serial or "nobody"


def _supersede_older(station: Station, command: Command, now_ns: int) -> Station:
    """A newer order to move ends the life of older ones to the same target, repeats included.

    Camera orders end older camera orders only: looking must never end the repeats of a stop. Of
    older ones that have ended already it ends the alarm.
    """
    target = _target(station, command)
    is_camera = lane_of(command) is Lane.CAMERA
    for record in station.orders.watched:
        older = record.command
        if (lane_of(older) is Lane.CAMERA) is is_camera and _target(station, older) is target:
            note = f"by order {command.id}"
            station = _put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note))
    return station


def _target(station: Station, command: Command) -> VehicleState | None:
    return station.target(command.serial, command.link_id)


def _context(station: Station, record: OrderRecord, now_ns: int) -> SentContext:
    """What is known as a command leaves; an old mode is no knowledge of the mode now."""
    target = _target(station, record.command)
    if target is None:
        return SentContext(now_ns, None, None)
    age_s = target.flight_mode.age_s(now_ns)
    is_fresh = age_s is not None and age_s <= station.settings.safety.fresh_telemetry_s
    mode = target.flight_mode.value if is_fresh else None
    return SentContext(now_ns, mode, target.is_flying.value)


def _progress(station: Station, record: OrderRecord, target: VehicleState, now_ns: int) -> Progress:
    """Return how much of an order telemetry shows, on every link it is for."""
    if record.sent is None:
        return Progress.UNSEEN
    body, sent = missions.present_part(record.command, record.plan).body, record.sent
    states = (target, *_flying_rivals(station, record, target))
    return min(progress(body, sent, state, now_ns) for state in states)


def _is_shown(record: OrderRecord) -> bool:
    return record.phase in (Phase.CONFIRMED, Phase.STARTED)


def _flying_rivals(
    station: Station, record: OrderRecord, target: VehicleState
) -> tuple[VehicleState, ...]:
    """What other links say that claim the serial and fly: an emergency order is for them too."""
    if not record.command.is_emergency:
        return ()
    links = (station.fleet.links[link_id] for link_id in target.rival_link_ids)
    return tuple(link.own_state for link in links if link.own_state.is_flying.value is True)


def _time_out(
    record: OrderRecord,
    target: VehicleState,
    seen: Progress,
    settings: StationSettings,
    now_ns: int,
) -> OrderRecord:
    """What telemetry does not show in time has ended; that it is shown late ends the alarm."""
    heard_ns = target.core_received_at_ns or record.command.issued_at_ns
    if _is_shown(record) and now_ns - heard_ns > seconds_to_ns(settings.unheard_s):
        return orders.ended(
            record, Phase.FAILED, now_ns, "not heard any more: nobody knows its end"
        )
    if record.phase is Phase.QUEUED:
        if now_ns < record.command.expires_at_ns:
            return record
        return orders.unsent(record, Phase.EXPIRED, now_ns, "not sent in time")
    if record.phase not in (Phase.SENT, Phase.ACKNOWLEDGED) or record.sent is None:
        return record
    waited_ns = now_ns - record.sent.sent_at_ns
    limit_s = _confirm_limit_s(record, seen, settings)
    if waited_ns < seconds_to_ns(limit_s):
        return record
    return orders.timed_out(record, now_ns, limit_s)


def _confirm_limit_s(record: OrderRecord, seen: Progress, settings: StationSettings) -> float:
    body = record.command.body
    is_begun = seen is Progress.BEGUN
    if record.command.is_emergency:
        return settings.emergency_confirm_s if is_begun else settings.emergency_answer_s
    if isinstance(body, CAMERA_BODIES):
        return settings.camera_confirm_s
    if isinstance(body, FlyMission):
        return settings.mission_takeoff_s if is_begun else settings.mission_confirm_s
    return settings.stick_confirm_s


def _repeat(
    station: Station, record: OrderRecord, now_ns: int
) -> tuple[OrderRecord, tuple[Output, ...]]:
    """Send an unconfirmed emergency order again if the gate still approves it now.

    One that has never left is no repeat: it is judged anew and waits on, until it expires. A repeat
    is never an order to take off: nothing that starts motion is sent again by itself.
    """
    left = record.repeats_left - (record.sent is not None)
    later_ns = now_ns + seconds_to_ns(station.settings.emergency_repeat_s)
    record = replace(record, repeats_left=left, next_repeat_ns=later_ns if left > 0 else None)
    command = record.command
    if record.sent is not None:
        command = replace(command, takeoff=False)
    judged = approve(command, situation(station, command, now_ns))
    if isinstance(judged, Refusal):
        waits = record.waits_to_be_heard and record.sent is None
        return (replace(record, next_repeat_ns=now_ns) if waits else record), ()
    waiting = tuple(dict.fromkeys((*record.waiting_link_ids, *judged.link_ids)))
    return replace(record, waiting_link_ids=waiting), (SendCommand(judged),)


def _put(station: Station, record: OrderRecord) -> Station:
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)
