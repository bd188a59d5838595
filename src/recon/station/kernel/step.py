"""The station's step: one event in, the next state and what is to be done out. Pure."""

from collections.abc import Callable, Mapping

from recon.fleet import step as fleet_step
from recon.model.event import (
    AlarmAcknowledged,
    AuditTroubled,
    AuthorityTaken,
    ClockRead,
    CommandAnswered,
    CommandDropped,
    CommandSent,
    DeadlineMissed,
    Event,
    FleetReturnOrdered,
    HazardDismissed,
    LinkClosed,
    LinkOpened,
    OperatorOrder,
    OwnerConnected,
    OwnerDisconnected,
    PacketReceived,
    PreflightOverridden,
    SeparationHoldSwitched,
    StationFaulted,
    SticksDue,
    SurveyAsked,
    SurveyStarted,
    SurveyStopped,
    Tick,
    WorkerResult,
)
from recon.model.imagery import Frame, GroundImage
from recon.model.replacing import replace
from recon.model.report import CoreReport, ImageReport, MessageReport, MessageSeverity
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.station.alarms import station_faults
from recon.station.alarms.conditions import conditions
from recon.station.control import authority, order_gateway, preflight
from recon.station.imaging import shade_reading as shade_reading
from recon.station.imaging import shade_work as shade_work
from recon.station.operations.fleet_return import planning
from recon.station.operations.fleet_return.advance import advance as advance_fleet_return
from recon.station.operations.fleet_return.call import call as fleet_return_call
from recon.station.operations.survey import commands, execution, observations
from recon.station.operations.survey import planning as survey_planning
from recon.station.recovery import restart
from recon.station.state import alarm_book, imaging
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.outputs import Output, StartWork
from recon.station.state.station import Station
from recon.station.state.stepped import Stepped
from recon.station.traffic import identity_grace, known_traffic, watchdog_runner

_NO_PROFILE = VehicleProfile(serial="")


def step(station: Station, event: Event, now_ns: int) -> Stepped:
    """Return the station after an event, and the outputs; the same inputs give the same outputs."""
    match event:
        case OperatorOrder():
            return order_gateway.place(station, event, now_ns)
        case CommandSent() | CommandAnswered() | CommandDropped():
            return order_gateway.follow(station, event, now_ns), ()
        case LinkOpened():
            return _fleet(station, event, now_ns)
        case LinkClosed(link_id):
            return _fleet(_lost_unidentified(station, link_id), event, now_ns)
        case PacketReceived():
            return _packet(station, event, now_ns)
        case Tick():
            return _tick(station, now_ns)
        case WorkerResult():
            return _work_done(station, event, now_ns)
        case DeadlineMissed():
            return _work_lost(station, event)
        case AuthorityTaken():
            return authority.take(station, event, now_ns), ()
        case SticksDue():
            return order_gateway.drive_streams(station, now_ns)
        case OwnerConnected(owner):
            return replace(station, owners=station.owners | {owner}), ()
        case OwnerDisconnected(owner):
            return order_gateway.owner_disconnected(station, owner, now_ns)
        case HazardDismissed():
            return known_traffic.dismiss(station, event, now_ns), ()
        case SeparationHoldSwitched():
            return watchdog_runner.switch_hold(station, event), ()
        case ClockRead():
            return preflight.read_clock(station, event, now_ns), ()
        case PreflightOverridden():
            return preflight.override(station, event, now_ns), ()
        case FleetReturnOrdered():
            return fleet_return_call(station, event, now_ns)
        case SurveyAsked():
            return survey_planning.ask(station, event, now_ns)
        case SurveyStarted():
            return commands.begin(station, event, now_ns), ()
        case SurveyStopped():
            return commands.stop(station, event, now_ns)
        case StationFaulted():
            return station_faults.note(station, event, now_ns), ()
        case AuditTroubled(problem):
            return replace(station, audit_problem=problem), ()
        case AlarmAcknowledged(alarm_id, by):
            return replace(station, alarms=alarm_book.acknowledge(station.alarms, alarm_id, by)), ()


def _fleet(station: Station, event: Event, now_ns: int) -> Stepped:
    fleet, closing = fleet_step.step(station.fleet, event, now_ns)
    return replace(station, fleet=fleet), closing


def _lost_unidentified(station: Station, link_id: int) -> Station:
    """What flew without ever saying its serial is gone from the fleet, not from the air."""
    link = station.fleet.links.get(link_id)
    if link is None or link.claimed_serial is not None or not link.own_state.is_flying.value:
        return station
    if identity_grace.is_heard_by_serial(station, link.own_state):
        return station
    return known_traffic.keep_lost(station, link_id)


def _packet(station: Station, event: PacketReceived, now_ns: int) -> Stepped:
    before = station
    station, outputs = _fleet(station, event, now_ns)
    station = preflight.after_packet(before, station, event.link_id)
    vehicle = station.fleet.vehicle_of_link(event.link_id)
    if vehicle is None:
        return station, outputs
    if isinstance(event.report, CoreReport):
        station = observations.see_vehicle(station, vehicle, now_ns)
    if vehicle.serial in station.restored_flights:
        station = restart.recheck(station, vehicle.serial, now_ns)
    match event.report:
        case CoreReport() if vehicle.serial is not None and _is_imager(station, vehicle):
            kept = station.settings.pose_history_samples
            seen = imaging.with_sample(station.imaging, vehicle, now_ns, kept)
            station = replace(station, imaging=seen)
        case ImageReport() as report if vehicle.serial is not None:
            station, work = _frame(station, vehicle, report, now_ns)
            return station, (*outputs, *work)
        case MessageReport() as report:
            station = _message(station, vehicle, report, now_ns)
    spoken = () if vehicle.serial is None else (vehicle.serial,)
    station, orders = order_gateway.watch(station, now_ns, spoken)
    return station, (*outputs, *orders)


def _tick(station: Station, now_ns: int) -> Stepped:
    outputs: tuple[Output, ...] = ()
    for part in TICK_PARTS.values():
        station, more = part(station, now_ns)
        outputs += more
    return station, outputs


def _let_time_pass(station: Station, now_ns: int) -> Stepped:
    return _fleet(station, Tick(), now_ns)


def raise_alarms(station: Station, now_ns: int) -> Stepped:
    """Bring the book of alarms up to date with what is the case now."""
    kept = station.settings.alarms_kept
    book = alarm_book.update(station.alarms, conditions(station, now_ns), now_ns, kept)
    return replace(station, alarms=book), ()


TICK_PARTS: Mapping[str, Callable[[Station, int], Stepped]] = {
    "counting the links' silence": _let_time_pass,
    "driving the streams of sticks": order_gateway.drive_streams,
    "watching the orders": order_gateway.watch,
    "leading the fleet home": advance_fleet_return,
    "carrying the surveys on": execution.carry_on,
    "looking with the watchdogs": watchdog_runner.look,
    "raising alarms": raise_alarms,
}
"""What a tick does, in this order, and each in words."""


def _is_imager(station: Station, vehicle: VehicleState) -> bool:
    return vehicle.serial == station.imaging.imager_serial


def _frame(
    station: Station, vehicle: VehicleState, report: ImageReport, now_ns: int
) -> tuple[Station, tuple[Output, ...]]:
    """Keep the newest frame of every vehicle; the eye's frames are laid on the ground."""
    profile = vehicle.profile or _NO_PROFILE
    serial = vehicle.serial or ""
    frame = Frame(
        id=station.next_frame_id,
        serial=serial,
        received_at_ns=now_ns,
        captured_at_ns=now_ns - seconds_to_ns(profile.video_latency_s),
        captured_sigma_s=profile.video_latency_sigma_s,
        rgb=report.rgb,
        jpeg=report.jpeg,
    )
    others = ((key, kept) for key, kept in station.frames.items() if key != serial)
    frames = dict([*others, (serial, frame)][-station.settings.frames_kept :])
    station = replace(station, frames=frames, next_frame_id=frame.id + 1)
    if not _is_imager(station, vehicle):
        return station, ()
    is_flying = vehicle.is_flying.value is True
    seen, work = imaging.take_frame(station.imaging, frame, is_flying)
    station = replace(station, imaging=seen)
    return station, () if work is None else (StartWork(work[0], imaging.LAY_FRAME, work[1]),)


def _work_done(station: Station, event: WorkerResult, now_ns: int) -> Stepped:
    """Take in what the worker brings."""
    match event.kind:
        case planning.PLAN_RETURN:
            return planning.take(station, event, now_ns), ()
        case survey_planning.PLAN_SURVEY:
            return survey_planning.take_plan(station, event), ()
        case survey_planning.STEP_SURVEY:
            return execution.take_step(station, event, now_ns)
        case shade_work.READ_SHADE:
            return _shade_read(station, event)
        case _:
            return _frame_laid(station, event)


def _work_lost(station: Station, event: DeadlineMissed) -> Stepped:
    """Work was dropped for newer work."""
    match event.kind:
        case planning.PLAN_RETURN:
            return planning.lost(station, event.job_id), ()
        case survey_planning.PLAN_SURVEY:
            return survey_planning.lost_plan(station, event.job_id), ()
        case survey_planning.STEP_SURVEY:
            return execution.lost_step(station, event.job_id), ()
        case shade_work.READ_SHADE:
            return shade_reading.lost(station, event.job_id)
        case _:
            dropped = station.imaging.frames_dropped + 1
            return replace(station, imaging=replace(station.imaging, frames_dropped=dropped)), ()


def _frame_laid(station: Station, event: WorkerResult) -> Stepped:
    """Take a ground image in, unless a newer one is already there; it is to be read for shade."""
    seen = station.imaging
    if not isinstance(event.result, GroundImage):
        return replace(station, imaging=replace(seen, latest_error=event.error)), ()
    image, latest = event.result, seen.ground_image
    if latest is not None and latest.captured_at_ns > image.captured_at_ns:
        return station, ()
    station = replace(station, imaging=replace(seen, ground_image=image, latest_error=None))
    return shade_reading.take_image(station, image)


def _shade_read(station: Station, event: WorkerResult) -> Stepped:
    """Take a shade map in, and let the surveys see it."""
    before = station.shade.number
    station, work = shade_reading.take_result(station, event)
    shade = station.shade.shade
    if shade is not None and station.shade.number != before:
        station = observations.see_shade(station, shade)
    return station, work


def _message(
    station: Station, vehicle: VehicleState, report: MessageReport, now_ns: int
) -> Station:
    """An app's own warnings and errors are shown until somebody has seen them."""
    if report.severity not in (MessageSeverity.WARNING, MessageSeverity.ERROR):
        return station
    is_error = report.severity is MessageSeverity.ERROR
    who = vehicle.serial if vehicle.serial is not None else f"link {vehicle.link_id}"
    if _unseen_messages(station, f"app:{who}:") >= station.settings.app_messages_kept:
        return station
    condition = Condition(
        key=f"app:{who}:{report.text}",
        severity=Severity.ERROR if is_error else Severity.WARNING,
        rule="app_message",
        vehicle_name=vehicle.display_name,
        text=f"{vehicle.display_name}: its app says: {report.text}",
        serial=vehicle.serial,
        link_id=vehicle.link_id,
    )
    book = alarm_book.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book)


def _unseen_messages(station: Station, key_start: str) -> int:
    alarms_kept = station.alarms.alarms.values()
    return sum(alarm.condition.key.startswith(key_start) for alarm in alarms_kept)
