"""The worker's two jobs for surveys: planning rows, and the survey's step once a second.

Both may take longer than a step of the station may.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from recon.guidance.survey import (
    PLANNERS,
    ClosedArea,
    PhotoSample,
    PositionSample,
    Surveyor,
    SurveyPlan,
    SurveyState,
    SurveySurroundings,
    create,
    observe,
    observe_shade,
    plan_survey,
    returning,
    step,
    surroundings_of,
)
from recon.guidance.survey.plan import RULE
from recon.model.command import Refusal
from recon.model.event import SurveyRequested
from recon.model.geo import LocalFrame
from recon.model.shade import ShadeMap, SunForecast
from recon.model.survey import MissionAssignment, Survey
from recon.station.state.imaging import DueForecast, made
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped
from recon.station.state.survey_record import SURVEYS_KEPT, SurveyRecord

NO_SITE = "a survey needs a site with an origin; start the station with --site FOLDER"
TOO_MANY = f"{SURVEYS_KEPT} surveys are under way; abort one of them first"
PUSHED_OUT = "another survey was requested at the same moment; request this one again"


@dataclass(frozen=True, slots=True, eq=False)
class SurveyPlanRequest:
    """The requested survey, and where the site allows it to fly."""

    survey: Survey
    frame: LocalFrame
    surroundings: SurveySurroundings


@dataclass(frozen=True, slots=True, eq=False)
class StepSurvey:
    """A survey, its observations since the last step, and its vehicles as they are now."""

    state: SurveyState
    positions: tuple[tuple[str, PositionSample | PhotoSample], ...]
    shade_maps: tuple[ShadeMap, ...]
    vehicles: tuple[Surveyor, ...]
    now_ns: int
    sun: SunForecast | DueForecast | None = None
    """The newest forecast, or what it is made of."""
    closed: tuple[ClosedArea, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SurveyStepped:
    """The survey after the step, and the missions to order."""

    state: SurveyState
    missions: tuple[MissionAssignment, ...]
    returning: Mapping[str, str] = field(default_factory=dict)
    """Serials of idle vehicles that should fly home, and why."""


def make_rows(work: SurveyPlanRequest) -> SurveyPlan | Refusal:
    """Return a survey's rows: the worker's part."""
    return plan_survey(work.survey, work.frame, work.surroundings)


def step_survey(work: StepSurvey) -> SurveyStepped:
    """Add the new observations and take a survey's step: the worker's part."""
    state = work.state
    for shade in work.shade_maps:
        state = observe_shade(state, shade)
    for serial, samples in _by_vehicle(work.positions).items():
        state = observe(state, serial, samples)
    state, missions = step(state, work.vehicles, work.now_ns, lambda: made(work.sun), work.closed)
    if not isinstance(state, SurveyState):
        raise ValueError(f"expected a SurveyState of the planner, got {state!r:.80}")
    return SurveyStepped(state, tuple(missions), returning(state, work.vehicles))


def outside_planner(work: StepSurvey) -> str:
    """Return the name of the survey's planner if an installed package offers it; else nothing."""
    name = work.state.plan.survey.planner
    return name if name in PLANNERS.outside else ""


def request_survey(station: Station, event: SurveyRequested, now_ns: int) -> Stepped:
    """Record a requested survey, and start planning its rows unless it is refused."""
    changes = station.temporary_zones.changes
    record = SurveyRecord(event.survey, event.by, now_ns, zone_changes=changes)
    refusal = refusal_of(station)
    if refusal is not None:
        return _put(station, replace(record, refusal=refusal)), ()
    air = station.airspace.airspace
    assert air.frame is not None  # or it was refused
    work = SurveyPlanRequest(event.survey, air.frame, surroundings_of(air))
    return _put(station, record), (Job(event.survey.id, PLAN_SURVEY, work),)


def refusal_of(station: Station) -> Refusal | None:
    """Return why no survey can be requested now, else None."""
    if station.airspace.airspace.frame is None:
        return Refusal(RULE, NO_SITE)
    alive = [each for each in station.surveys.records.values() if not each.is_over]
    return Refusal(RULE, TOO_MANY) if len(alive) >= SURVEYS_KEPT else None


def _planned(station: Station, survey_id: int, plan: SurveyPlan | Refusal, _now_ns: int) -> Stepped:
    """The survey can be started now, or is refused."""
    made = plan if isinstance(plan, Refusal) else create(plan)
    return _with_plan(station, survey_id, made)


def _not_planned(station: Station, survey_id: int, error: str, _now_ns: int) -> Stepped:
    return _with_plan(station, survey_id, Refusal(RULE, f"its rows could not be planned: {error}"))


def _dropped(station: Station, survey_id: int, _now_ns: int) -> Stepped:
    return _with_plan(station, survey_id, Refusal(RULE, PUSHED_OUT))


def _with_plan(station: Station, survey_id: int, made: SurveyState | Refusal) -> Stepped:
    record = station.surveys.records.get(survey_id)
    if record is None or record.state is not None or record.refusal is not None:
        return station, ()
    if isinstance(made, Refusal):
        return _put(station, replace(record, refusal=made)), ()
    return _put(station, replace(record, state=made)), ()


PLAN_SURVEY: JobKind[SurveyPlanRequest, SurveyPlan | Refusal] = JobKind(
    "plan_survey", lambda _site: make_rows, _planned, _not_planned, _dropped
)
"""Plans a survey's rows; the job has the survey's number."""


def _put(station: Station, record: SurveyRecord) -> Station:
    return replace(station, surveys=station.surveys.put(record))


def step_ended(station: Station, job_id: int) -> tuple[Station, SurveyRecord | None]:
    """End the pending step: return its survey without the observations that the step counted.

    None if the job is not the pending one. A step that failed drops its observations too: they
    might make the next one fail again.
    """
    surveys, pending = station.surveys, station.surveys.pending
    if pending is None or pending.job_id != job_id:
        return station, None
    surveys = replace(surveys, pending=None)
    record = surveys.records.get(pending.survey_id)
    if record is None or record.state is None:
        return replace(station, surveys=surveys), None
    record = replace(
        record,
        positions=record.positions.from_number(pending.positions_end),
        shade_maps=record.shade_maps.from_number(pending.shade_maps_end),
    )
    return replace(station, surveys=surveys.put(record)), record


def _by_vehicle(
    samples: Sequence[tuple[str, PositionSample | PhotoSample]],
) -> Mapping[str, list[PositionSample | PhotoSample]]:
    each: dict[str, list[PositionSample | PhotoSample]] = {}
    for serial, sample in samples:
        each.setdefault(serial, []).append(sample)
    return each
