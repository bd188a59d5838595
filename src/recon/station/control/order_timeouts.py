"""The life of an order that was sent: what time and telemetry make of it."""

from recon.fleet.confirmation import Progress, reading_of_sent
from recon.fleet.flight_table import Verdict
from recon.model.command import CAMERA_BODIES, FlyMission, Phase, VirtualStick
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.control import missions, mode_tracking
from recon.station.control.order_targets import flying_rivals, is_shown, target_of
from recon.station.state import orders
from recon.station.state.orders import OrderRecord
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station


def pilot_of(station: Station, record: OrderRecord, target: VehicleState) -> str | None:
    """Return why an order that telemetry has not shown meets a pilot, else None."""
    if record.sent is None or isinstance(record.command.body, CAMERA_BODIES) or is_shown(record):
        return None
    body = missions.present_part(record.command, record.plan).body
    states = (target, *flying_rivals(station, record, target))
    readings = [reading_of_sent(body, record.sent, state) for state in states]
    is_pilot = all(r.verdict is Verdict.PILOT and r.is_at_once for r in readings)
    return readings[0].why if is_pilot else None


def intents_after(
    station: Station, before: OrderRecord, record: OrderRecord, seen: Progress, now_ns: int
) -> Station:
    """Keep what the vehicle does true to what telemetry has just shown of an order."""
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


def timed_out_by_now(
    record: OrderRecord,
    target: VehicleState,
    seen: Progress,
    settings: StationSettings,
    now_ns: int,
) -> OrderRecord:
    """What telemetry does not show in time has ended; that it is shown late ends the alarm."""
    heard_ns = target.core_received_at_ns or record.command.issued_at_ns
    if is_shown(record) and now_ns - heard_ns > seconds_to_ns(settings.unheard_s):
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
