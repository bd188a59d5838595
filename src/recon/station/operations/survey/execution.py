"""A running survey carried on: looked at once a second, its missions given through the gate."""

from dataclasses import replace

from recon.guidance.survey import refused
from recon.model.authority import AuthorityHolder
from recon.model.command import Hover, Phase, Refusal
from recon.model.event import OperatorOrder
from recon.model.survey import MissionFor, SurveyPhase
from recon.model.units import seconds_to_ns
from recon.safety.rules.battery import RULE as BATTERY
from recon.station.control import authority, order_gateway
from recon.station.operations.survey.availability import looked_at, surveyors
from recon.station.operations.survey.mission_dispatch import order_of
from recon.station.operations.survey.planning import StepSurvey, SurveyStepped, step_survey
from recon.station.operations.survey.return_to_home import (
    IS_DONE,
    NO_BATTERY,
    comes_home,
    flies_home,
    is_under_way,
    send_home,
)
from recon.station.operations.survey.settings import SETTINGS, SurveyCarrying
from recon.station.state.command_ids import take_id
from recon.station.state.jobs import Job, JobKind
from recon.station.state.outputs import Output
from recon.station.state.station import Station
from recon.station.state.stepped import Stepped
from recon.station.state.survey_record import Look, SurveyRecord


def advance(station: Station, now_ns: int, settings: SurveyCarrying = SETTINGS) -> Stepped:
    """Return the station after looking whether a survey is due, and the work for the one that is.

    One at a time: the survey that has waited longest.
    """
    surveys = station.surveys
    if not surveys.records:
        return station, ()
    look = surveys.look
    if look is not None:
        if now_ns - look.asked_at_ns < seconds_to_ns(settings.answered_within_s):
            return station, ()
        surveys = replace(surveys, look=None)
    due = [r for r in surveys.records.values() if _is_alive(r) and now_ns >= r.look_at_ns]
    if not due:
        return replace(station, surveys=surveys), ()
    record = min(due, key=lambda each: each.look_at_ns)
    station, held = _look_at_members(replace(station, surveys=surveys), record, now_ns)
    station, work = _ask(station, record.survey.id, settings, now_ns)
    return station, (*held, *work)


def _stepped(station: Station, job_id: int, result: SurveyStepped, now_ns: int) -> Stepped:
    """Take the survey's new state, and order its missions as far as the gate approves them."""
    station, record = _without_look(station, job_id)
    if record is None:
        return station, ()
    record = replace(record, state=result.state, trouble=None)
    station = replace(station, surveys=station.surveys.put(record))
    outputs: tuple[Output, ...] = ()
    for mission in result.missions:
        station, sent = _give(station, record.survey.id, mission, now_ns)
        outputs += sent
    if comes_home(record):
        for serial in result.spent:
            station, sent = send_home(station, record.survey.id, serial, NO_BATTERY, now_ns)
            outputs += sent
    station, sent = _over(station, record.survey.id, now_ns)
    return station, (*outputs, *sent)


def _not_stepped(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    station, record = _without_look(station, job_id)
    if record is None:
        return station, ()
    return replace(station, surveys=station.surveys.put(replace(record, trouble=error))), ()


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    """The next step counts the same observations."""
    look = station.surveys.look
    if look is None or look.job_id != job_id:
        return station, ()
    return replace(station, surveys=replace(station.surveys, look=None)), ()


STEP_SURVEY: JobKind[StepSurvey, SurveyStepped] = JobKind(
    "step_survey", lambda _site: step_survey, _stepped, _not_stepped, _dropped
)
"""Counts observations and decides which vehicle flies what next."""


def _without_look(station: Station, job_id: int) -> tuple[Station, SurveyRecord | None]:
    """End the look that a job was for: return its survey without the observations it counted.

    None for a job that nothing waits for. Observations that could not be counted are dropped too.
    """
    surveys, look = station.surveys, station.surveys.look
    if look is None or look.job_id != job_id:
        return station, None
    surveys = replace(surveys, look=None)
    record = surveys.records.get(look.survey_id)
    if record is None or record.state is None:
        return replace(station, surveys=surveys), None
    seen, shade = record.seen.from_number(look.seen_end), record.shade.from_number(look.shade_end)
    record = replace(record, seen=seen, shade=shade)
    return replace(station, surveys=surveys.put(record)), record


def _is_alive(record: SurveyRecord) -> bool:
    """Whether time and positions still change it: it runs, or something flown is not counted."""
    is_paused = record.state is not None and record.state.phase is SurveyPhase.PAUSED
    return record.is_running or (is_paused and bool(record.seen.items))


def _look_at_members(station: Station, record: SurveyRecord, now_ns: int) -> Stepped:
    """Take in how the missions have ended; stop a vehicle that might begin one late."""
    outputs: tuple[Output, ...] = ()
    for member in record.members.values():
        seen, order = looked_at(station, member)
        record = record.put(seen)
        if order is not None and order.phase is Phase.TIMED_OUT and record.is_running:
            station, number = take_id(station)
            why = f"the mission of order {order.command.id} was ignored"
            by = f"station: survey {record.survey.name}: {why}"
            hold = OperatorOrder(
                number, Hover(), by, serial=member.serial, asked_as=AuthorityHolder.GUIDANCE
            )
            station, sent = order_gateway.place(station, hold, now_ns)
            outputs += sent
    return replace(station, surveys=station.surveys.put(record)), outputs


def _ask(station: Station, survey_id: int, settings: SurveyCarrying, now_ns: int) -> Stepped:
    surveys = station.surveys
    record = surveys.records[survey_id]
    assert record.state is not None  # or it would not be due
    who = tuple(surveyors(station, record, now_ns))
    work = StepSurvey(record.state, record.seen.items, record.shade.items, who, now_ns)
    look = Look(surveys.next_job_id, survey_id, now_ns, record.seen.end, record.shade.end)
    record = replace(record, look_at_ns=now_ns + seconds_to_ns(settings.look_every_s))
    surveys = replace(surveys.put(record), look=look, next_job_id=look.job_id + 1)
    return replace(station, surveys=surveys), (Job(look.job_id, STEP_SURVEY, work),)


def _give(station: Station, survey_id: int, given: MissionFor, now_ns: int) -> Stepped:
    """Order one mission, as guidance; tell the survey when the gate refuses it."""
    record = station.surveys.records[survey_id]
    member, state = record.members.get(given.serial), record.state
    vehicle = station.fleet.vehicles.get(given.serial)
    if member is None or state is None or vehicle is None:
        return station, ()
    station, number = take_id(station)
    order, why = order_of(station, record, given, vehicle, now_ns)
    order = replace(order, command_id=number)
    sent: tuple[Output, ...] = ()
    if isinstance(why, Refusal):
        station = order_gateway.refuse(station, order, why, now_ns)
    else:
        station, sent = order_gateway.place(station, order, now_ns)
    placed = station.orders.records[number]
    words = placed.note if isinstance(why, Refusal) else placed.note + why
    if placed.phase is Phase.REFUSED_BY_STATION:
        state = refused(state, given.serial, given.number, words, now_ns)
        record = replace(record, state=state)
        station = replace(station, surveys=station.surveys.put(record))
        if comes_home(record) and placed.note.startswith(f"{BATTERY}: "):
            return send_home(station, survey_id, given.serial, NO_BATTERY, now_ns)
    else:
        used = replace(member, number=given.number, command_id=number, may_take_off=False)
        record = record.put(used)
    return replace(station, surveys=station.surveys.put(record)), sent


def _over(station: Station, survey_id: int, now_ns: int) -> Stepped:
    """A survey that has ended calls its vehicles home if it was asked to; one that is over, or has
    paused by itself, leads nobody else any more: they hover."""
    record = station.surveys.records[survey_id]
    if record.is_running or record.state is None:
        return station, ()
    outputs: tuple[Output, ...] = ()
    why = f"the survey {record.survey.name} is {record.state.phase.value}: {record.state.reason}"
    for member in record.members.values():
        if flies_home(record) and member.stopped is None:
            station, sent = send_home(station, survey_id, member.serial, IS_DONE, now_ns)
            outputs += sent
        if not is_under_way(station, station.surveys.records[survey_id].members[member.serial]):
            station = authority.hand_back(station, member.serial, record.started_by, why, now_ns)
    return station, outputs
