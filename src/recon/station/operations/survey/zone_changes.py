"""Surveys when temporary zones are drawn or end: held where they would enter one, planned anew.

Theory of operation. A survey's plan remembers the number of zone changes it was made after
(`SurveyRecord.zone_changes`). While that is old, at every tick:

1. Each of its vehicles whose mission leads through a temporary zone, whatever the zone's heights,
   is held under guidance: it stays the survey's, and gets other rows.
2. The worker plans the survey's rows anew, as its one pending step. Vehicles clear of the zones fly
   on; the rows of held vehicles wait for them.
3. Without any row left the survey pauses, with an alarm; an operator starts it again when the zone
   has ended.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from recon.geo import Footprints
from recon.guidance.survey import (
    SurveyPlan,
    SurveyState,
    SurveySurroundings,
    plan_survey,
    surroundings_of,
)
from recon.guidance.survey.replan import replanned
from recon.model.command import Refusal, issued_by_station
from recon.model.control import AuthorityHolder
from recon.model.geo import LocalFrame
from recon.model.mission import Waypoint
from recon.safety.airspace import PreparedZone
from recon.safety.datum import places_m
from recon.station.control import order_gateway
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.operations.survey.availability import is_flown
from recon.station.operations.survey.planning import step_ended
from recon.station.operations.survey.return_to_home import release_vehicles
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Output, Stepped
from recon.station.state.survey_record import PendingStep, SurveyMember, SurveyRecord


@dataclass(frozen=True, slots=True, eq=False)
class SurveyReplanRequest:
    """A survey, where the site allows it to fly now, and the vehicles that fly on."""

    state: SurveyState
    frame: LocalFrame
    surroundings: SurveySurroundings
    flying: frozenset[str]
    changes: int
    now_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class SurveyReplanned:
    """The survey after the zone changes up to `changes`."""

    state: SurveyState
    changes: int


def replan(work: SurveyReplanRequest) -> SurveyReplanned:
    """Plan a survey anew: the worker's part."""
    plan: SurveyPlan | Refusal = plan_survey(work.state.plan.survey, work.frame, work.surroundings)
    state = replanned(work.state, plan, work.flying, work.now_ns)
    return SurveyReplanned(state, work.changes)


def is_outdated(station: Station, record: SurveyRecord) -> bool:
    """Return whether zones have changed since a survey that is not over was planned."""
    is_planned = record.state is not None and not record.is_over
    return is_planned and record.zone_changes != station.temporary_zones.changes


def start_replan(station: Station, record: SurveyRecord, now_ns: int) -> Stepped:
    """Hold what would enter a zone, and start to plan the survey anew."""
    station, held = _hold_crossing(station, record, now_ns)
    record = station.surveys.records[record.survey.id]
    state, air = record.state, station.airspace.airspace
    assert state is not None, "it is outdated, and so was planned"
    assert air.frame is not None, "a survey was planned, so the site has a frame"
    flying = frozenset(each.serial for each in record.members.values() if is_flown(station, each))
    surveys, changes = station.surveys, station.temporary_zones.changes
    work = SurveyReplanRequest(state, air.frame, surroundings_of(air), flying, changes, now_ns)
    job = Job(surveys.next_job_id, REPLAN_SURVEY, work)
    # None of the observations is counted by it: they wait for the next step.
    kept = record.positions.first, record.shade_maps.first
    pending = PendingStep(job.id, record.survey.id, now_ns, *kept, is_replan=True)
    surveys = replace(surveys, pending=pending, next_job_id=job.id + 1)
    return replace(station, surveys=surveys), (*held, job)


def _hold_crossing(station: Station, record: SurveyRecord, now_ns: int) -> Stepped:
    outputs: tuple[Output, ...] = ()
    for member in record.members.values():
        zone = _zone_on_the_way(station, member)
        if zone is None:
            continue
        why = f"survey {record.survey.name}: its rows lead through {zone.zone.name}"
        by = issued_by_station(why)
        station, hold = guidance_hold(station, member.serial, by)
        station, sent = order_gateway.submit(station, hold, now_ns)
        outputs += sent
        # Its mission is over for the survey, and no reason to leave the vehicle out.
        record = record.put(replace(member, command_id=None))
    return replace(station, surveys=station.surveys.put(record)), outputs


def _zone_on_the_way(station: Station, member: SurveyMember) -> PreparedZone | None:
    """The temporary zone that what is left of a vehicle's mission comes too near to."""
    zones, frame = station.airspace.temporary_zones, station.airspace.airspace.frame
    if not zones or frame is None or not is_flown(station, member):
        return None
    if station.control(member.serial).authority.holder is not AuthorityHolder.GUIDANCE:
        return None
    places = tuple(_waypoints_left(station, member))
    if not places:
        return None
    points_m = places_m(frame, places)
    legs_m = np.stack([points_m[:-1], points_m[1:], points_m[1:]], axis=1)
    margin_m = station.airspace.airspace.limits.boundary_margin_m
    paths = Footprints(legs_m)
    crossed = (each for each in zones if not each.polygon.is_clear_of(paths, margin_m).all())
    return next(crossed, None)


def _waypoints_left(station: Station, member: SurveyMember) -> Iterator[Waypoint]:
    """Yield the waypoints from the last passed one on, of the present part and all that follow."""
    record = station.orders.records.get(member.command_id or 0)
    if record is None or record.plan is None:
        return
    parts, index = record.plan.parts, record.plan.index
    intent = station.control(member.serial).intent
    passed = intent.passed if intent.mission is parts[index] else 0
    yield from parts[index].waypoints[max(0, passed - 1) :]
    for part in parts[index + 1 :]:
        yield from part.waypoints


def _replanned(station: Station, job_id: int, result: SurveyReplanned, now_ns: int) -> Stepped:
    station, record = step_ended(station, job_id)
    if record is None:
        return station, ()
    was_running = record.is_running
    record = replace(record, state=result.state, zone_changes=result.changes)
    station = replace(station, surveys=station.surveys.put(record))
    return release_vehicles(station, record.survey.id, now_ns) if was_running else (station, ())


def _not_replanned(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    """Keep the old rows: the gate refuses those that lead through a zone."""
    changes = station.temporary_zones.changes
    station, record = step_ended(station, job_id)
    if record is None:
        return station, ()
    trouble = f"its rows could not be planned round the temporary zones: {error}"
    record = replace(record, trouble=trouble, zone_changes=changes)
    return replace(station, surveys=station.surveys.put(record)), ()


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    """Plan it again with the next tick."""
    return step_ended(station, job_id)[0], ()


REPLAN_SURVEY: JobKind[SurveyReplanRequest, SurveyReplanned] = JobKind(
    "replan_survey", lambda _site: replan, _replanned, _not_replanned, _dropped
)
"""Plans a survey's rows again after zones have changed."""
