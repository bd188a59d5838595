"""The station's step: one event in, the next state and what is to be done out. Pure.

Events go to their handlers by one table; a tick goes through one tuple of parts. Both take the
operations from `OPERATIONS`: a new one changes nothing here.
"""

from collections.abc import Mapping
from typing import Any

from recon.fleet import pairing
from recon.fleet import step as fleet_step
from recon.fleet.app_facts import new_photos
from recon.model.app_report import AppFacts, OutcomeReport, PhotosReport
from recon.model.event import (
    AlarmAcknowledged,
    AllStopped,
    AppAdmitted,
    AppListFailed,
    AppRefused,
    AuditFailed,
    AuthorityTaken,
    ClockGap,
    ClockRead,
    CommandAnswered,
    CommandDropped,
    CommandSent,
    Event,
    GuardActed,
    HazardDismissed,
    ImagerMarked,
    LinkClosed,
    LinkLimitReached,
    LinkOpened,
    LoginAccepted,
    LoginRefused,
    OperatorOrder,
    OwnerConnected,
    OwnerDisconnected,
    PacketReceived,
    PersonConnected,
    PersonDisconnected,
    PreflightOverridden,
    RecordFailed,
    SeparationHoldSwitched,
    SetpointsDue,
    SiteRedrawn,
    StationFaulted,
    StopReleased,
    Tick,
    UsersChanged,
    ZoneDrawn,
    ZoneEnded,
)
from recon.model.light import LightRead
from recon.model.replacing import replace
from recon.model.report import CoreReport, ImageReport, MessageReport, Report
from recon.model.vehicle import VehicleState
from recon.station.alarms import event_alarms
from recon.station.alarms.conditions import raise_alarms
from recon.station.control import (
    app_outcomes,
    handover,
    operator_lease,
    order_gateway,
    preflight,
    site_drawing,
    stop_latch,
    temporary_zones,
)
from recon.station.imaging import frames, light_sensors, marking
from recon.station.kernel import fault_isolation
from recon.station.kernel.failsafe_orders import run_failsafes, run_failsafes_isolated
from recon.station.kernel.fault_isolation import TickPart
from recon.station.kernel.watchdog_holds import run_watchdogs
from recon.station.operations import OPERATIONS
from recon.station.recovery import restart
from recon.station.state import alarm_book
from recon.station.state.station import Station
from recon.station.state.steps import (
    Handler,
    JobDone,
    JobDropped,
    JobFailed,
    Output,
    Stepped,
    changing,
    on,
)
from recon.station.traffic import known_traffic, watchdog_runner


def step(station: Station, event: Event, now_ns: int) -> Stepped:
    """Return the station after an event, and the outputs; the same inputs give the same outputs."""
    return HANDLERS[type(event)](station, event, now_ns)


def _fleet(station: Station, event: Event, now_ns: int) -> Stepped:
    fleet, closing = fleet_step.step(station.fleet, event, now_ns)
    return station.with_fleet(fleet), closing


def _clock_gap(station: Station, event: ClockGap, now_ns: int) -> Stepped:
    return _fleet(event_alarms.note_gap(station, event, now_ns), event, now_ns)


def _link_closed(station: Station, event: LinkClosed, now_ns: int) -> Stepped:
    return _fleet(known_traffic.keep_lost(station, event.link_id), event, now_ns)


def _app_refused(station: Station, event: AppRefused, now_ns: int) -> Stepped:
    """Keep the link's vehicle as a hazard: a refusal does not state where it is."""
    if pairing.refusal_to_refuse(station.fleet, event) is None:
        station = known_traffic.keep_lost(station, event.link_id)
    return _fleet(station, event, now_ns)


def _app_list_failed(station: Station, event: AppListFailed, _now_ns: int) -> Station:
    return replace(station, app_list_problem=event.problem)


def _packet(station: Station, event: PacketReceived, now_ns: int) -> Stepped:
    before = station
    station, outputs = _fleet(station, event, now_ns)
    if isinstance(event.report, AppFacts):  # settings of the aircraft: no order's end
        return station, outputs
    station = preflight.after_packet(before, station, event.link_id)
    vehicle = station.fleet.vehicle_of_link(event.link_id)
    if vehicle is None:
        return station, outputs
    received_at_ns = event.received_at_ns(now_ns)
    station, more = _reported(station, vehicle, event.report, received_at_ns)
    if isinstance(event.report, PhotosReport):
        station = _photos(before, station, event.link_id, event.report, received_at_ns)
    if station.control(vehicle.serial).restored is not None:
        station = restart.recheck(station, vehicle.serial, now_ns)
    orders: tuple[Output, ...] = ()
    # Images confirm camera orders only, and photos none: ticks see them.
    if not isinstance(event.report, ImageReport | PhotosReport):
        serials = () if vehicle.serial is None else (vehicle.serial,)
        station, orders = order_gateway.update_orders(station, now_ns, serials)
    return station, (*outputs, *more, *orders)


def _photos(
    before: Station, station: Station, link_id: int, report: PhotosReport, received_at_ns: int
) -> Station:
    """Give the operations the photos that were not known before the report."""
    was, vehicle = before.fleet.vehicle_of_link(link_id), station.fleet.vehicle_of_link(link_id)
    taken = () if was is None else new_photos(was, report, received_at_ns)
    for operation in OPERATIONS:
        if operation.on_photos is not None and vehicle is not None:
            station = operation.on_photos(station, vehicle, taken)
    return station


def _reported(
    station: Station, vehicle: VehicleState, report: Report, received_at_ns: int
) -> Stepped:
    """Apply a report's effects besides its part in the vehicle's state."""
    match report:
        case ImageReport():
            return frames.on_frame(station, vehicle, report, received_at_ns)
        case OutcomeReport():
            return app_outcomes.on_outcome(station, vehicle, report, received_at_ns), ()
        case MessageReport():
            return event_alarms.on_message(station, vehicle, report, received_at_ns)
        case CoreReport() if vehicle.core_received_at_ns == received_at_ns:
            for operation in OPERATIONS:
                if operation.on_position is not None:
                    station = operation.on_position(station, vehicle, received_at_ns)
            return frames.on_telemetry(station, vehicle, received_at_ns), ()
    return station, ()  # or another link has brought newer telemetry


def _job_done(station: Station, event: JobDone[Any, Any], now_ns: int) -> Stepped:
    number = station.shade.number
    station, outputs = event.kind.done(station, event.job_id, event.result, now_ns)
    shade = station.shade.followed
    if shade is not None and station.shade.number != number:
        for operation in OPERATIONS:
            if operation.on_shade is not None:
                station = operation.on_shade(station, shade)
    return station, outputs


def _job_failed(station: Station, event: JobFailed[Any, Any], now_ns: int) -> Stepped:
    return event.kind.failed(station, event.job_id, event.error, now_ns)


def _job_dropped(station: Station, event: JobDropped[Any, Any], now_ns: int) -> Stepped:
    return event.kind.dropped(station, event.job_id, now_ns)


def _answered(station: Station, event: CommandAnswered, now_ns: int) -> Station:
    noted = event_alarms.note_slow_answer(station, event, now_ns)
    return order_gateway.on_link_event(noted, event, now_ns)


def _guard_acted(station: Station, event: GuardActed, now_ns: int) -> Stepped:
    """The guard has held vehicles: the orders that steered them are over."""
    station = event_alarms.note_guard(station, event, now_ns)
    if event.by is not None:
        return station, ()  # its all stop is given here as well
    return order_gateway.end_streams(station, event.serials, event.why, now_ns)


def _setpoints_due(station: Station, _event: SetpointsDue, now_ns: int) -> Stepped:
    return order_gateway.update_streams(station, now_ns)


def _owner_connected(station: Station, event: OwnerConnected, _now_ns: int) -> Station:
    return replace(station, owners=station.owners | {event.owner})


def _owner_disconnected(station: Station, event: OwnerDisconnected, now_ns: int) -> Stepped:
    return order_gateway.on_owner_disconnected(station, event.owner, now_ns)


def _audit_failed(station: Station, event: AuditFailed, _now_ns: int) -> Station:
    return replace(station, audit_problem=event.problem)


def _record_failed(station: Station, event: RecordFailed, _now_ns: int) -> Station:
    return replace(station, record_problem=event.problem)


def _link_limit(station: Station, event: LinkLimitReached, _now_ns: int) -> Station:
    others = {key: text for key, text in station.link_limits.items() if key != event.limit}
    reached = {} if event.problem is None else {event.limit: event.problem}
    return replace(station, link_limits={**others, **reached})


def _audited_only(station: Station, _event: Event, _now_ns: int) -> Station:
    return station


def _acknowledged(station: Station, event: AlarmAcknowledged, _now_ns: int) -> Station:
    book = alarm_book.acknowledge(station.alarms, event.alarm_id, event.by)
    return replace(station, alarms=book)


def _tick(station: Station, _event: Tick, now_ns: int) -> Stepped:
    outputs: tuple[Output, ...] = ()
    for part in TICK_PARTS:
        station, more = part.run(station, now_ns)
        outputs += more
    return station, outputs


def _pass_time(station: Station, now_ns: int) -> Stepped:
    return _fleet(station, Tick(), now_ns)


TICK_PARTS: tuple[TickPart, ...] = (
    TickPart("measuring the links' silence", _pass_time),
    TickPart("ending temporary zones", temporary_zones.end_due),
    TickPart("ending the leases of absent persons", operator_lease.settle),
    TickPart(
        "driving the setpoint streams",
        order_gateway.update_streams,
        fault_isolation.drive_streams_isolated,
    ),
    TickPart(
        "following the orders", order_gateway.update_orders, fault_isolation.follow_orders_isolated
    ),
    *(TickPart(f"advancing the {each.name}", each.tick) for each in OPERATIONS),
    TickPart("comparing light sensors", light_sensors.compare),
    TickPart("running the watchdogs", run_watchdogs, fault_isolation.run_watchdogs_isolated),
    TickPart("running the failsafe matrix", run_failsafes, run_failsafes_isolated),
    TickPart("raising alarms", raise_alarms, fault_isolation.raise_alarms_isolated),
)
"""What a tick does, in this order."""

HANDLERS: Mapping[type[Any], Handler] = dict(
    (
        on(Tick, _tick),
        on(SetpointsDue, _setpoints_due),
        on(LinkOpened, _fleet),
        on(LinkClosed, _link_closed),
        on(PacketReceived, _packet),
        on(JobDone, _job_done),
        on(JobFailed, _job_failed),
        on(JobDropped, _job_dropped),
        on(OperatorOrder, order_gateway.submit),
        changing(CommandSent, order_gateway.on_link_event),
        changing(CommandAnswered, _answered),
        changing(CommandDropped, order_gateway.on_link_event),
        on(AppAdmitted, _fleet),
        on(AppRefused, _app_refused),
        changing(AppListFailed, _app_list_failed),
        on(AllStopped, stop_latch.latch),
        changing(StopReleased, stop_latch.release),
        changing(ZoneDrawn, temporary_zones.draw),
        changing(ZoneEnded, temporary_zones.end),
        changing(SiteRedrawn, site_drawing.redraw),
        changing(ImagerMarked, marking.mark),
        on(AuthorityTaken, handover.take),
        changing(PersonConnected, operator_lease.connected),
        changing(PersonDisconnected, operator_lease.disconnected),
        changing(OwnerConnected, _owner_connected),
        on(OwnerDisconnected, _owner_disconnected),
        changing(HazardDismissed, known_traffic.dismiss),
        changing(SeparationHoldSwitched, watchdog_runner.switch_hold),
        changing(ClockRead, preflight.read_clock),
        on(ClockGap, _clock_gap),
        changing(PreflightOverridden, preflight.override),
        changing(StationFaulted, event_alarms.note_fault),
        on(GuardActed, _guard_acted),
        changing(AuditFailed, _audit_failed),
        changing(RecordFailed, _record_failed),
        changing(LinkLimitReached, _link_limit),
        changing(LightRead, light_sensors.on_light_read),
        changing(AlarmAcknowledged, _acknowledged),
        changing(LoginAccepted, _audited_only),
        changing(LoginRefused, event_alarms.note_refused_login),
        changing(UsersChanged, event_alarms.note_users),
        *(command for each in OPERATIONS for command in each.commands),
    )
)
"""The handler of each type of event."""
