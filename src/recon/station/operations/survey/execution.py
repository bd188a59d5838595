"""The execution of surveys: a step once a second, its missions ordered through the gate.

A survey is planned, created, running, paused, and in the end aborted or done (`SurveyPhase`). Only
an operator starts, pauses or aborts it; it becomes done, or pauses itself, by its own step:

1. On a tick, at most once a second, the survey that has waited longest is due. The outcome of each
   vehicle's mission is read: a vehicle whose mission ended unfinished is stopped until an operator
   starts it again. If its mission was ignored it is held, for it might begin late. One that was not
   sent, for a reason that may pass, is requested again (`unsent_missions`).
2. The worker counts the positions and shade maps since the last step, and decides which vehicle
   flies what next. One step at a time; after 30 s without an answer it counts as lost. A command
   to the survey meanwhile makes the answer count for nothing.
3. After temporary zones have changed its rows are planned anew instead (`zone_changes`).
4. Each mission is ordered under guidance, with an approach of its own. A refusal goes back to the
   planner, which tries other rows or another vehicle.
5. A vehicle with a battery too low for any row, one whose battery is better changed now, and every
   vehicle of a survey that is done fly home if the survey is to return. Those of a survey that is
   over, or has paused itself, otherwise hover and go back to the operator.
"""

from math import dist
from types import MappingProxyType

from recon.guidance.survey import NO_BATTERY, PositionSample, SurveyState, refused
from recon.model.command import Phase, Refusal, issued_by_station
from recon.model.event import SurveyStopped
from recon.model.replacing import replace
from recon.model.shade import ShadeMap
from recon.model.survey import MissionAssignment, SurveyPhase
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety.datum import places_m, takeoff_up_m
from recon.safety.rules.authority import RULE as AUTHORITY
from recon.safety.rules.battery import RULE as BATTERY
from recon.safety.rules.separation import RULE as SEPARATION
from recon.station.control import order_gateway
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.operations.settings import SURVEY_TIMES
from recon.station.operations.survey.availability import (
    after_mission,
    available_vehicles,
    closed_areas,
    hindrance,
    is_flown,
)
from recon.station.operations.survey.commands import stop_survey
from recon.station.operations.survey.mission_dispatch import dispatch
from recon.station.operations.survey.photos import reports_photos, watch_timer
from recon.station.operations.survey.planning import (
    StepSurvey,
    SurveyStepped,
    outside_planner,
    step_ended,
    step_survey,
)
from recon.station.operations.survey.return_to_home import (
    release_vehicles,
    returns_home,
    send_home,
)
from recon.station.operations.survey.unsent_missions import (
    asked_again,
    given_back,
    may_be_sent_later,
    may_end,
    stopped_if_overdue,
)
from recon.station.operations.survey.zone_changes import is_outdated, start_replan
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Job, JobKind, Output, Stepped
from recon.station.state.survey_record import EastNorth, PendingStep, SurveyMember, SurveyRecord

FAILED_STEPS_MOST = 10
"""Failed steps in a row, one a second, after which a survey is paused: the process of a planner
that was late once needs some seconds to start again."""
TAKES_OFF = "takes off first: its aircraft takes no missions, and is steered along its rows"


def on_position(station: Station, vehicle: VehicleState, now_ns: int) -> Station:
    """Keep a vehicle's new position for the surveys it belongs to."""
    surveys, serial = station.surveys, vehicle.serial
    frame = station.airspace.airspace.frame
    by_photos = bool(surveys.records) and reports_photos(vehicle, now_ns)
    for record in surveys.records.values():
        if serial is None or serial not in record.members or frame is None or not record.is_open:
            continue
        at, height_m = vehicle.position, vehicle.height_above_takeoff_m
        if at.value is None or height_m.value is None or at.received_at_ns != now_ns:
            continue
        east_m, north_m = (float(metres) for metres in places_m(frame, [at.value])[0])
        takeoff_m = takeoff_up_m(station.airspace, vehicle)
        sample = PositionSample(now_ns, east_m, north_m, height_m.value, takeoff_m)
        if by_photos:
            record = watch_timer(record, serial, sample)
        else:
            kept = record.positions.with_one((serial, sample), SURVEY_TIMES.positions_kept)
            record = replace(record, positions=kept)
        record = _with_path(station, record, serial, (east_m, north_m))
        surveys = surveys.put(record)
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def on_shade(station: Station, shade: ShadeMap) -> Station:
    """Keep a new shade map for every running or paused survey."""
    surveys = station.surveys
    for record in surveys.records.values():
        if record.is_open:
            kept = record.shade_maps.with_one(shade, SURVEY_TIMES.shade_maps_kept)
            surveys = surveys.put(replace(record, shade_maps=kept))
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def _with_path(
    station: Station,
    record: SurveyRecord,
    serial: str,
    place_m: EastNorth,
) -> SurveyRecord:
    """Extend the flown path of the vehicle's mission, if it flies one."""
    member = record.members[serial]
    if not is_flown(station, member):
        return record
    key = serial, member.number
    path = record.flown.get(key, ())
    if len(path) >= SURVEY_TIMES.track_corners:
        return record
    if path and dist(path[-1], place_m) < SURVEY_TIMES.track_step_m:
        return record
    flown = MappingProxyType({**record.flown, key: (*path, place_m)})
    return replace(record, flown=flown)


def advance(station: Station, now_ns: int) -> Stepped:
    """Start the step of the survey that has waited longest, if one is due and none is pending."""
    surveys = station.surveys
    if not surveys.records:
        return station, ()
    pending = surveys.pending
    outdated = next((r for r in surveys.records.values() if is_outdated(station, r)), None)
    if outdated is not None and (pending is None or not pending.is_replan):
        return start_replan(station, outdated, now_ns)
    if pending is not None:
        if now_ns - pending.asked_at_ns < seconds_to_ns(SURVEY_TIMES.answered_within_s):
            return station, ()
        surveys = replace(surveys, pending=None)
    due = [r for r in surveys.records.values() if _needs_steps(r) and now_ns >= r.step_due_ns]
    if not due:
        return replace(station, surveys=surveys), ()
    record = min(due, key=lambda each: each.step_due_ns)
    station = replace(station, surveys=surveys)
    station, held = _read_missions(station, record, now_ns)
    station, job = _start_step(station, record.survey.id, now_ns)
    return station, (*held, *job)


def _stepped(station: Station, job_id: int, result: SurveyStepped, now_ns: int) -> Stepped:
    """Take the survey's new state, and order its missions as far as the gate approves them."""
    station, record = step_ended(station, job_id)
    if record is None:
        return station, ()
    survey_id, was_running = record.survey.id, record.is_running
    record = replace(record, state=result.state, trouble=None, failed_steps=0)
    station = replace(station, surveys=station.surveys.put(record))
    outputs: tuple[Output, ...] = ()
    for mission in result.missions:
        station, sent = _order_mission(station, survey_id, mission, now_ns)
        outputs += sent
    if returns_home(record):
        for serial, why in result.returning.items():
            station, sent = send_home(station, survey_id, serial, why, now_ns)
            outputs += sent
    if was_running:
        station, sent = release_vehicles(station, survey_id, now_ns)
        outputs += sent
    return station, outputs


def _not_stepped(station: Station, job_id: int, error: str, now_ns: int) -> Stepped:
    station, record = step_ended(station, job_id)
    if record is None:
        return station, ()
    record = replace(record, trouble=error, failed_steps=record.failed_steps + 1)
    station = replace(station, surveys=station.surveys.put(record))
    if record.failed_steps < FAILED_STEPS_MOST or not record.is_running:
        return station, ()
    return _paused(station, record, now_ns)


def _paused(station: Station, record: SurveyRecord, now_ns: int) -> Stepped:
    """Pause a survey whose steps fail, and hold its vehicles: nothing would follow their missions.

    A failure may pass, as one of a single observation does: only several in a row count.
    """
    name, planner = record.survey.id, record.survey.planner
    paused = SurveyStopped(name, record.started_by, is_aborted=False)
    station, held = stop_survey(station, paused, now_ns)
    record = station.surveys.records[name]
    if record.state is None or record.is_running:
        return station, held
    reason = f"its planner {planner} failed {record.failed_steps} times in a row: {record.trouble}"
    record = replace(record, state=replace(record.state, reason=reason), failed_steps=0)
    return replace(station, surveys=station.surveys.put(record)), held


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    """Forget the step; the next one counts the same observations."""
    pending = station.surveys.pending
    if pending is None or pending.job_id != job_id:
        return station, ()
    return replace(station, surveys=replace(station.surveys, pending=None)), ()


STEP_SURVEY: JobKind[StepSurvey, SurveyStepped] = JobKind(
    "step_survey",
    lambda _site: step_survey,
    _stepped,
    _not_stepped,
    _dropped,
    outside=outside_planner,
)
"""Counts observations and decides which vehicle flies what next."""


def _needs_steps(record: SurveyRecord) -> bool:
    """Whether it runs, or is paused with positions that are not counted yet."""
    is_paused = record.state is not None and record.state.phase is SurveyPhase.PAUSED
    return record.is_running or (is_paused and bool(record.positions.items))


def _read_missions(station: Station, record: SurveyRecord, now_ns: int) -> Stepped:
    """Read the outcome of each vehicle's mission; hold a vehicle that might begin one late."""
    outputs: tuple[Output, ...] = ()
    for member in record.members.values():
        updated, order = after_mission(station, member)
        if order is not None and may_be_sent_later(order):
            record = given_back(record, member, order, now_ns)
            continue
        could_fly = hindrance(station, updated, now_ns) is None
        record = record.put(stopped_if_overdue(record, updated, could_fly, now_ns))
        if order is not None and order.phase is Phase.TIMED_OUT and record.is_running:
            why = f"the mission of order {order.command.id} was ignored"
            by = issued_by_station(f"survey {record.survey.name}: {why}")
            station, hold = guidance_hold(station, member.serial, by)
            station, sent = order_gateway.submit(station, hold, now_ns)
            outputs += sent
    return replace(station, surveys=station.surveys.put(record)), outputs


def _start_step(station: Station, survey_id: int, now_ns: int) -> Stepped:
    surveys = station.surveys
    record = surveys.records[survey_id]
    assert record.state is not None  # or it would not be due
    vehicles = tuple(available_vehicles(station, record, now_ns))
    closed = tuple(closed_areas(station, now_ns))
    positions, shade_maps = record.positions, record.shade_maps
    work = StepSurvey(
        record.state,
        positions.items,
        shade_maps.items,
        vehicles,
        now_ns,
        station.shade.newest_sun(station.settings.forecast),
        closed,
    )
    job = Job(surveys.next_job_id, STEP_SURVEY, work)
    pending = PendingStep(job.id, survey_id, now_ns, positions.end, shade_maps.end)
    record = replace(record, step_due_ns=now_ns + seconds_to_ns(SURVEY_TIMES.step_every_s))
    surveys = replace(surveys.put(record), pending=pending, next_job_id=job.id + 1)
    return replace(station, surveys=surveys), (job,)


def _order_mission(
    station: Station, survey_id: int, given: MissionAssignment, now_ns: int
) -> Stepped:
    """Order one mission under guidance; give a refusal back to the survey."""
    record = station.surveys.records[survey_id]
    member, state = record.members.get(given.serial), record.state
    vehicle = station.fleet.vehicles.get(given.serial)
    if member is None or state is None or vehicle is None:
        return station, ()
    ready = dispatch(station, record, given, vehicle, now_ns)
    if ready.in_the_way is not None:
        # Without a place to wait at a vehicle waits where it is; that must not bar it from rows.
        waits, why = given.stands_by, f"{ready.in_the_way.reason}{ready.tried}"
        record = _refused(record, given, ready.in_the_way, why, now_ns, may_end=waits)
        return replace(station, surveys=station.surveys.put(record)), ()
    station, number = take_id(station)
    station, sent = order_gateway.submit(station, replace(ready.order, command_id=number), now_ns)
    refusal = station.orders.records[number].refusal
    if refusal is None:
        record = _ordered(record, member, given, number, now_ns, takes_off=ready.is_takeoff)
        return replace(station, surveys=station.surveys.put(record)), sent
    why = f"{refusal.reason}{ready.tried}"
    if may_end(refusal):
        record = asked_again(record, member, given.number, why, now_ns)
        return replace(station, surveys=station.surveys.put(record)), sent
    record = record.put(replace(member, unsent_since_ns=None))
    # One taken from guidance during the step is not able until it is given back; then it may fly.
    waits = given.stands_by or refusal.rule == AUTHORITY
    # Fewer rows may last for what is in the battery, as they may keep clear of another vehicle.
    takes_fewer = refusal.rule == BATTERY and _may_take_fewer(state, given.serial)
    record = _refused(record, given, refusal, why, now_ns, may_end=waits, takes_fewer=takes_fewer)
    station = replace(station, surveys=station.surveys.put(record))
    flies_on = takes_fewer or (record.state is not None and given.serial in record.state.flights)
    if returns_home(record) and refusal.rule == BATTERY and not flies_on:
        return send_home(station, survey_id, given.serial, NO_BATTERY, now_ns)
    return station, sent


def _refused(
    record: SurveyRecord,
    given: MissionAssignment,
    refusal: Refusal,
    why: str,
    now_ns: int,
    *,
    may_end: bool,
    takes_fewer: bool = False,
) -> SurveyRecord:
    """Return the survey after the gate refused a mission, for another vehicle in its way or not."""
    if record.state is None:
        return record
    is_separation = refusal.rule == SEPARATION
    state = refused(
        record.state,
        given.serial,
        given.number,
        why,
        now_ns,
        may_end=may_end,
        in_the_way=is_separation or takes_fewer,
        waits_for=str(refusal.parameters.get("other", "")) if is_separation else "",
    )
    return replace(record, state=state)


def _ordered(
    record: SurveyRecord,
    member: SurveyMember,
    given: MissionAssignment,
    order_id: int,
    now_ns: int,
    *,
    takes_off: bool,
) -> SurveyRecord:
    """Return the survey with a mission ordered; after a takeoff alone it is asked for again."""
    member = replace(member, may_take_off=False)
    if takes_off:
        return asked_again(record, member, given.number, TAKES_OFF, now_ns)
    return record.put(
        replace(member, number=given.number, command_id=order_id, ordered_id=order_id)
    )


def _may_take_fewer(state: SurveyState, serial: str) -> bool:
    """Whether a vehicle's mission was chosen for it alone, and has several rows."""
    flight = state.flights.get(serial)
    return flight is not None and flight.is_chosen and len(flight.route) > 1
