"""The life of a sent order: what telemetry and time make of it.

Theory of operation. A record passes through these phases; a final one is never left:

    queued -> sent -> acknowledged -> confirmed -> done      hold, land, return, camera, stick
    queued -> sent -> acknowledged -> started   -> done      mission, steered order

- An acknowledgement proves only that the app received the packet. Telemetry newer than the sending
  confirms or starts an order (`fleet.confirmation`); a camera order is done at once.
- Timeouts, see `StationSettings`. Not sent before it expires: *expired*. Not shown by telemetry
  within its limit: *timed out*, with an alarm for what moves a vehicle; the limit is longer once
  telemetry shows its beginning. Shown, then no telemetry for `telemetry_lost_s`: *failed*.
- An emergency order (hold, land, return) is repeated every 0.7 s, three times at most, until
  telemetry shows it. The gate judges each repeat anew, and a repeat never allows takeoff. A stop
  refused only because telemetry is stale waits, and is judged again at each packet of its vehicle;
  one sent without telemetry is sent anew when it returns. A stop of a vehicle that is about to take
  off follows it (`takeoff_stops`).
- A newer order to the same vehicle ends it as *superseded*; so does its pilot. From *started* on
  `mode_tracking` finds the end of a mission, and a setpoint stream reports that of a steered order.
- Telemetry that shows an ended order late is noted and ends its alarm, but not its phase.
"""

from recon.fleet.confirmation import Progress, progress, reading_of_sent
from recon.fleet.flight_table import Verdict
from recon.model.command import CAMERA_BODIES, FlyMission, Phase, Refusal, VirtualStick
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.control import missions, mode_tracking, takeoff_stops
from recon.station.control.order_records import is_stale, target_of
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import Judge, Output, SendCommand


def progress_of(
    station: Station, record: OrderRecord, target: VehicleState, now_ns: int
) -> Progress:
    """Return how much of an order telemetry shows, on every link it is for."""
    if record.sent is None:
        return Progress.UNSEEN
    body, sent = missions.present_part(record.command, record.plan).body, record.sent
    states = (target, *_flying_rivals(station, record, target))
    return min(progress(body, sent, state, now_ns) for state in states)


def pilot_takeover(station: Station, record: OrderRecord, target: VehicleState) -> str | None:
    """Return the reason if telemetry shows a pilot instead of an order just sent, else None."""
    is_camera = isinstance(record.command.body, CAMERA_BODIES)
    if record.sent is None or is_camera or _is_confirmed(record):
        return None
    body = missions.present_part(record.command, record.plan).body
    states = (target, *_flying_rivals(station, record, target))
    readings = [reading_of_sent(body, record.sent, state) for state in states]
    is_pilot = all(r.verdict is Verdict.PILOT and r.is_at_once for r in readings)
    return readings[0].why if is_pilot else None


def with_intent_of(
    station: Station, before: OrderRecord, record: OrderRecord, seen: Progress, now_ns: int
) -> Station:
    """Return the station with its vehicle's intent as telemetry has just shown of an order."""
    target = target_of(station, record.command)
    if target is None or target.serial is None:
        return station
    body = missions.present_part(record.command, record.plan).body
    if isinstance(body, VirtualStick) and record.phase is Phase.DONE:
        return mode_tracking.hold_here(station, target.serial, now_ns)
    is_news = record.phase is not before.phase or record.alarm is not before.alarm
    if seen >= Progress.CONFIRMED and is_news and not isinstance(body, CAMERA_BODIES):
        return mode_tracking.on_order_begun(station, target.serial, record.command.id, body, now_ns)
    return station


def after_time(
    station: Station, record: OrderRecord, target: VehicleState, seen: Progress, now_ns: int
) -> OrderRecord:
    """Return the record after its timeouts."""
    settings = station.settings
    if record.follows is not None:
        return takeoff_stops.updated(station, record, target, settings, now_ns)
    if record.waits_for_telemetry and record.sent is not None:
        return _after_blind_stop(record, target, settings, now_ns)
    return _timed_out_by_now(record, target, seen, settings, now_ns)


def _after_blind_stop(
    record: OrderRecord, target: VehicleState, settings: StationSettings, now_ns: int
) -> OrderRecord:
    """A stop sent without telemetry: sent anew when that returns, and else an alarm."""
    assert record.sent is not None
    if (target.core_received_at_ns or 0) > record.sent.sent_at_ns:
        note = "telemetry is back: sent again until it shows the vehicle hovering"
        expires_at_ns = now_ns + seconds_to_ns(settings.order_expiry_s)
        return replace(
            orders.changed(record, Phase.QUEUED, now_ns, note),
            command=replace(record.command, expires_at_ns=expires_at_ns),
            sent=None,
            waits_for_telemetry=False,
            next_repeat_ns=now_ns,
            repeats_left=settings.emergency_repeats,
        )
    if now_ns - record.sent.sent_at_ns < seconds_to_ns(settings.stop_waits_s):
        return record
    return orders.timed_out(record, now_ns, settings.stop_waits_s)


def _timed_out_by_now(
    record: OrderRecord,
    target: VehicleState,
    seen: Progress,
    settings: StationSettings,
    now_ns: int,
) -> OrderRecord:
    received_ns = target.core_received_at_ns or record.command.issued_at_ns
    if _is_confirmed(record) and now_ns - received_ns > seconds_to_ns(settings.telemetry_lost_s):
        return orders.ended(record, Phase.FAILED, now_ns, "telemetry lost: outcome unknown")
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


def repeat(
    station: Station, record: OrderRecord, judge: Judge, now_ns: int
) -> tuple[OrderRecord, tuple[Output, ...]]:
    """Send an unconfirmed emergency order again if the gate still approves it.

    One that was never sent uses up no repeat: it is judged again until it expires.
    """
    target = target_of(station, record.command)
    if target is None or not takeoff_stops.may_go(record, target):
        return replace(record, next_repeat_ns=now_ns), ()
    left = record.repeats_left - (record.sent is not None)
    later_ns = now_ns + seconds_to_ns(station.settings.emergency_repeat_s)
    record = replace(record, repeats_left=left, next_repeat_ns=later_ns if left > 0 else None)
    command = record.command
    if record.sent is not None:
        # Nothing that starts motion is sent again automatically.
        command = replace(command, takeoff=False)
    judged = judge(station, command)
    if isinstance(judged, Refusal):
        waits = (record.waits_for_telemetry or record.follows is not None) and record.sent is None
        return (replace(record, next_repeat_ns=now_ns) if waits else record), ()
    waiting = tuple(dict.fromkeys((*record.waiting_link_ids, *judged.link_ids)))
    waits = record.waits_for_telemetry and is_stale(station, target, now_ns)
    record = replace(record, waiting_link_ids=waiting, waits_for_telemetry=waits)
    return record, (SendCommand(judged),)


def _is_confirmed(record: OrderRecord) -> bool:
    return record.phase in (Phase.CONFIRMED, Phase.STARTED)


def _flying_rivals(
    station: Station, record: OrderRecord, target: VehicleState
) -> tuple[VehicleState, ...]:
    """Return flying links that claim the same serial: an emergency order is for them too."""
    if not record.command.is_emergency:
        return ()
    links = (station.fleet.links[link_id] for link_id in target.rival_link_ids)
    return tuple(link.own_state for link in links if link.own_state.is_flying.value is True)


def _confirm_limit_s(record: OrderRecord, seen: Progress, settings: StationSettings) -> float:
    body = record.command.body
    is_begun = seen is Progress.BEGUN
    if record.command.is_emergency:
        return settings.emergency_confirm_s if is_begun else settings.emergency_answer_s
    if isinstance(body, CAMERA_BODIES):
        return settings.camera_confirm_s
    if isinstance(body, FlyMission):
        part = body.mission if record.plan is None else record.plan.part
        starts_s = settings.safety.prediction.starts_within_s(part)
        return starts_s + settings.mission_takeoff_s if is_begun else starts_s
    return settings.stick_confirm_s
