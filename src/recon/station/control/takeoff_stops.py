"""Stops that follow a takeoff: the vehicle is on the ground, and about to leave it.

Theory of operation. A hold, landing or return is no use on the ground: apps in the field ignore it
or answer it with a takeoff. But a takeoff that was given before may still wait in a queue, or the
app may carry it out some seconds later. So the stop withdraws what waits, and follows the rest:

    queued: waits --the takeoff was withdrawn unsent--> done, on the ground
                  --telemetry shows it in the air--> sent, and again every 0.7 s
    sent --telemetry shows it obeyed--> confirmed
    confirmed --telemetry shows the mission begun after all--> queued again, sent at once
    after `takeoff_stop_s`: on the ground: done; confirmed: as any stop; else expired, an alarm

It ends early by a newer order or the pilot only: within `takeoff_stop_s` the mission may begin
late, with the vehicle on the ground or hovering until then. This is the case in which more than
three repeats are allowed (decisions on the ICD, 16 b).
"""

from recon.fleet.confirmation import Progress
from recon.fleet.flight_table import ModeKind, kind_of
from recon.model.command import Command, Phase
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.control.order_records import target_of
from recon.station.state import orders
from recon.station.state.orders import OrderRecord, PhaseChange
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station

_SHOWN = (Phase.CONFIRMED, Phase.STARTED, Phase.DONE)


def takeoff_under_way(station: Station, command: Command, now_ns: int) -> OrderRecord | None:
    """Return the newest order to take off that telemetry may yet show, for a stop to follow.

    It waits in a queue, or was sent at most `takeoff_stop_s` ago.
    """
    if not command.is_emergency or command.takeoff or command.serial is None:
        return None
    late_ns = now_ns - seconds_to_ns(station.settings.takeoff_stop_s)
    for record in reversed(tuple(station.orders.records.values())):
        if record.command.serial != command.serial or not record.command.takeoff:
            continue
        if was_shown(record):
            return None
        if record.waiting_link_ids:
            return record
        if record.sent is not None:
            return record if record.sent.sent_at_ns >= late_ns else None
        # It was refused, and hides no earlier one that has left.
    return None


def was_shown(record: OrderRecord) -> bool:
    """Return whether telemetry has ever shown an order confirmed, begun or carried out."""
    return any(change.phase in _SHOWN for change in record.history)


def following_record(
    station: Station, command: Command, takeoff: OrderRecord, now_ns: int
) -> OrderRecord:
    """Return the record of a stop that follows a takeoff."""
    settings = station.settings
    follow_ns = seconds_to_ns(settings.takeoff_stop_s)
    target = target_of(station, command)
    order = takeoff.command
    note = f"follows the takeoff of order {order.id}: sent as soon as telemetry shows it in the air"
    return OrderRecord(
        command=replace(command, expires_at_ns=now_ns + follow_ns),
        vehicle_name=order.serial or "" if target is None else target.display_name,
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        next_repeat_ns=now_ns,
        repeats_left=round(follow_ns / seconds_to_ns(settings.emergency_repeat_s)),
        follows=order.id,
    )


def may_go(record: OrderRecord, target: VehicleState) -> bool:
    """Return whether a stop may be sent: one that follows a takeoff waits for the air."""
    return record.follows is None or target.is_flying.value is True


def shown_so_far(record: OrderRecord, seen: Progress, now_ns: int) -> Progress:
    """Return what counts of what telemetry shows: while the takeoff may be late, no end."""
    if record.follows is None or now_ns >= record.command.expires_at_ns:
        return seen
    if record.sent is None:
        return Progress.UNSEEN
    return min(seen, Progress.CONFIRMED)


def updated(
    station: Station,
    record: OrderRecord,
    target: VehicleState,
    settings: StationSettings,
    now_ns: int,
) -> OrderRecord:
    """Return a stop that follows a takeoff after telemetry and time."""
    takeoff = station.orders.records.get(record.follows or 0)
    if record.sent is None and takeoff is not None and takeoff.is_withdrawn:
        note = f"on the ground; order {takeoff.command.id} was withdrawn before it was sent"
        return orders.ended(record, Phase.DONE, now_ns, note)
    if now_ns >= record.command.expires_at_ns:
        return _at_its_end(record, target, settings, now_ns)
    if record.phase is Phase.CONFIRMED and _has_begun_late(record, target):
        note = "its mission began after the stop: stopped again"
        again = orders.changed(record, Phase.QUEUED, now_ns, note)
        left = (record.command.expires_at_ns - now_ns) // seconds_to_ns(settings.emergency_repeat_s)
        return replace(again, sent=None, next_repeat_ns=now_ns, repeats_left=max(1, left))
    return record


def _has_begun_late(record: OrderRecord, target: VehicleState) -> bool:
    """Whether telemetry newer than the confirmation shows a mission flown."""
    mode = target.flight_mode
    if mode.value is None or (mode.received_at_ns or 0) <= record.history[-1].at_ns:
        return False
    return kind_of(mode.value, target.gnss_signal_level.value) is ModeKind.WAYPOINT


def _at_its_end(
    record: OrderRecord, target: VehicleState, settings: StationSettings, now_ns: int
) -> OrderRecord:
    age_s = target.is_flying.age_s(now_ns)
    is_fresh = age_s is not None and age_s <= settings.safety.fresh_telemetry_s
    if is_fresh and target.is_flying.value is False:
        return orders.ended(record, Phase.DONE, now_ns, "telemetry shows it on the ground")
    if record.phase is Phase.CONFIRMED:
        return replace(record, follows=None)
    if record.sent is None:
        return orders.unsent(record, Phase.EXPIRED, now_ns, "not sent: no telemetry showed flight")
    return orders.timed_out(record, now_ns, settings.takeoff_stop_s)
