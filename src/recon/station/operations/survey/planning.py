"""Rows and looks are worked out by the worker: both may take longer than a step may."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from recon.guidance.survey import (
    PositionSample,
    Surroundings,
    Surveyor,
    SurveyPlan,
    SurveyState,
    create,
    observe,
    observe_shade,
    plan_survey,
    spent,
    step,
)
from recon.guidance.survey.plan import RULE
from recon.model.command import Refusal
from recon.model.event import SurveyAsked, WorkerResult
from recon.model.geo import LocalFrame
from recon.model.shade import ShadeMap
from recon.model.survey import MissionFor, Survey
from recon.model.zone import ZoneKind
from recon.station.state.outputs import Output, StartWork
from recon.station.state.station import Station
from recon.station.state.survey_record import SURVEYS_KEPT, SurveyRecord

PLAN_SURVEY = "plan_survey"
"""The kind of work that makes a survey's rows; its job is numbered as the survey is."""

STEP_SURVEY = "step_survey"
"""The kind of work that counts what was seen and says who flies what next."""

NO_SITE = "a survey needs a site with a place: start the station with --site FOLDER"
TOO_MANY = f"{SURVEYS_KEPT} surveys are under way: abort one of them first"
PUSHED_OUT = "another survey was asked for at the same moment: ask for this one again"


@dataclass(frozen=True, slots=True, eq=False)
class PlanSurvey:
    """What is asked for, and what the site leaves to fly over."""

    survey: Survey
    frame: LocalFrame
    surroundings: Surroundings


@dataclass(frozen=True, slots=True, eq=False)
class StepSurvey:
    """A survey, what was seen since the last look, and its vehicles as they are now."""

    state: SurveyState
    seen: tuple[tuple[str, PositionSample], ...]
    shade: tuple[ShadeMap, ...]
    surveyors: tuple[Surveyor, ...]
    now_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class SurveyStepped:
    """The survey a moment later, and the missions to give."""

    state: SurveyState
    missions: tuple[MissionFor, ...]
    spent: tuple[str, ...] = ()
    """Who waits in the air, or on the ground, with a battery that lasts for no row."""


def plan_task(payload: object) -> SurveyPlan | Refusal:
    """Make a survey's rows; this is what the worker does."""
    assert isinstance(payload, PlanSurvey)
    return plan_survey(payload.survey, payload.frame, payload.surroundings)


def step_task(payload: object) -> SurveyStepped:
    """Count what was seen and take a survey's step; this is what the worker does."""
    assert isinstance(payload, StepSurvey)
    state = payload.state
    for shade in payload.shade:
        state = observe_shade(state, shade)
    for serial, seen in _by_vehicle(payload.seen).items():
        state = observe(state, serial, seen)
    state, missions = step(state, payload.surveyors, payload.now_ns)
    return SurveyStepped(state, missions, spent(state, payload.surveyors))


def ask(station: Station, event: SurveyAsked, now_ns: int) -> tuple[Station, tuple[Output, ...]]:
    """Return the station with a survey whose rows are being worked out, or that is refused."""
    record = SurveyRecord(event.survey, event.by, now_ns)
    refusal = refusal_of(station)
    if refusal is not None:
        return _put(station, replace(record, refusal=refusal)), ()
    frame = station.airspace.airspace.frame
    assert frame is not None  # or it was refused
    work = PlanSurvey(event.survey, frame, surroundings(station))
    return _put(station, record), (StartWork(event.survey.id, PLAN_SURVEY, work),)


def refusal_of(station: Station) -> Refusal | None:
    """Return why no survey can be asked for now, else None."""
    if station.airspace.airspace.frame is None:
        return Refusal(RULE, NO_SITE)
    alive = [each for each in station.surveys.records.values() if not each.is_over]
    return Refusal(RULE, TOO_MANY) if len(alive) >= SURVEYS_KEPT else None


def surroundings(station: Station) -> Surroundings:
    """Return what the site leaves: its boundary, and all keep-out zones, whatever their heights."""
    air = station.airspace.airspace
    shut = tuple(zone.region for zone in air.zones if zone.kind is ZoneKind.KEEP_OUT)
    return Surroundings(air.boundary, shut, air.limits.boundary_margin_m)


def take_plan(station: Station, result: WorkerResult) -> Station:
    """Return the station with a survey that waits to be started, or that there is no way to fly."""
    record = station.surveys.records.get(result.job_id)
    if record is None or record.state is not None or record.refusal is not None:
        return station
    plan = result.result
    if isinstance(plan, SurveyPlan):
        made = create(plan)
        if isinstance(made, SurveyState):
            return _put(station, replace(record, state=made))
        return _put(station, replace(record, refusal=made))
    refusal = plan if isinstance(plan, Refusal) else Refusal(RULE, _not_planned(result))
    return _put(station, replace(record, refusal=refusal))


def lost_plan(station: Station, survey_id: int) -> Station:
    """Return the station after the worker has dropped the planning of a survey."""
    record = station.surveys.records.get(survey_id)
    if record is None or record.state is not None:
        return station
    return _put(station, replace(record, refusal=Refusal(RULE, PUSHED_OUT)))


def _not_planned(result: WorkerResult) -> str:
    return f"its rows could not be worked out: {result.error}"


def _put(station: Station, record: SurveyRecord) -> Station:
    return replace(station, surveys=station.surveys.put(record))


def _by_vehicle(seen: Sequence[tuple[str, PositionSample]]) -> Mapping[str, list[PositionSample]]:
    each: dict[str, list[PositionSample]] = {}
    for serial, place in seen:
        each.setdefault(serial, []).append(place)
    return each
