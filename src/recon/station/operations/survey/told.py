"""What is told of surveys: their alarms, and their views for consoles and programs."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from recon.api import schema
from recon.guidance.survey import SurveyState, figures
from recon.model.survey import SurveyPhase
from recon.model.units import ns_to_seconds
from recon.station.api_views.corners import corners_lon_lat
from recon.station.operations.fleet_return.progress import newest_motion
from recon.station.operations.survey.availability import hindrance, is_flown
from recon.station.operations.survey.places import lon_lat
from recon.station.operations.survey.return_to_home import is_under_way
from recon.station.operations.survey.settings import SETTINGS
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.fleet_return_record import Stage
from recon.station.state.station import Station
from recon.station.state.survey_record import SURVEYS_KEPT, Member, SurveyRecord

RULE = "survey"
RULE_LEFT = "survey_over"
RULE_HOME = "survey_home"


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what somebody must see to: surveys that stand still, vehicles that fly no more."""
    for record in station.surveys.records.values():
        state = record.state
        if state is not None and state.phase is SurveyPhase.PAUSED and state.refusals:
            text = f"the survey {record.survey.name} has paused by itself: {state.reason}"
            key = f"{RULE}:{record.survey.id}"
            yield Condition(key, Severity.WARNING, RULE, "", f"{text}; start it again, or abort it")
        if record.is_running and record.trouble is not None:
            text = f"the survey {record.survey.name} is not carried on: {record.trouble}"
            key = f"{RULE}_trouble:{record.survey.id}"
            yield Condition(key, Severity.ERROR, RULE, "", f"{text}; pause it")
        for member in record.members.values():
            yield from _of_member(station, record, member)


def _of_member(station: Station, record: SurveyRecord, member: Member) -> Iterator[Condition]:
    name = record.survey.name
    if record.is_running and member.stopped is not None:
        text = f"flies no more rows of the survey {name}: {member.stopped}"
        yield _about(station, member, RULE, f"{text}; look, then start it again")
    elif is_under_way(station, member):
        yield from _waits_long(station, member)
    elif record.is_running and member.homeward is not None and _stands(station, member):
        text = f"has come home, {member.homeward}: change its battery, then let it join the survey"
        again = f"recon survey start {record.survey.id} {member.serial} --takeoff"
        yield _about(station, member, RULE, f"{text} {name} again ({again})")
    elif record.is_over and _hovers_since(station, member):
        text = f"hovers, for the survey {name} is over: call it home, or fly it on"
        yield _about(station, member, RULE_LEFT, text)


def view(station: Station, now_ns: int) -> list[schema.SurveyView]:
    """Return every survey of this run that is remembered, the newest first."""
    records = reversed(tuple(station.surveys.records.values()))
    return [survey_view(station, record, now_ns) for record in records]


def survey_view(station: Station, record: SurveyRecord, now_ns: int) -> schema.SurveyView:
    """Return one survey as the API says it."""
    state, survey = record.state, record.survey
    phase, reason = record.phase
    return schema.SurveyView(
        id=survey.id,
        name=survey.name,
        phase=phase,
        reason=reason,
        asked_by=record.by,
        age_s=ns_to_seconds(now_ns - record.asked_at_ns),
        started_by=record.started_by or None,
        planner=survey.planner,
        when_done=survey.when_done.value,
        height_above_takeoff_m=survey.height_above_takeoff_m,
        speed_mps=survey.speed_mps,
        round=0 if state is None else state.round,
        missions=0 if state is None else state.missions,
        flown_m=0.0 if state is None else state.flown_m,
        vehicles=[_member(station, record, each, now_ns) for each in record.members.values()],
        figures=None if state is None else _figures(state),
        cells=None if state is None else _cells(state),
        rows=0 if state is None else len(state.plan.pieces),
        ways=sum(len(way) for way in record.flown.values()),
    )


def ways(record: SurveyRecord) -> schema.SurveyWays | None:
    """Return the planned rows, what is flown now, and what has been flown; None without rows."""
    state = record.state
    if state is None:
        return None
    frame = state.plan.frame
    return schema.SurveyWays(
        survey_id=record.survey.id,
        rows=[lon_lat(frame, row) for row in state.plan.rows_m],
        flying=[
            schema.SurveyWay(
                serial=serial, number=each.number, places=lon_lat(frame, each.corners_m)
            )
            for serial, each in state.flights.items()
        ],
        flown=[
            schema.SurveyWay(serial=serial, number=number, places=lon_lat(frame, way))
            for (serial, number), way in record.flown.items()
        ],
    )


def _member(
    station: Station, record: SurveyRecord, member: Member, now_ns: int
) -> schema.SurveyingView:
    state = record.state
    assert state is not None  # members come with the start
    vehicle = station.fleet.vehicles.get(member.serial)
    is_told = record.is_running or is_under_way(station, member)
    waits = hindrance(station, member, now_ns) if is_told else None
    refused = None if record.is_over else state.refusals.get(member.serial)
    return schema.SurveyingView(
        serial=member.serial,
        vehicle_name=member.serial if vehicle is None else vehicle.display_name,
        is_flying_rows=is_flown(station, member),
        waits_for=waits,
        refused=None if refused is None else refused.reason,
        has_come_home=member.homeward is not None and _stands(station, member),
        mission_command_id=member.command_id,
    )


@lru_cache(maxsize=SURVEYS_KEPT)
def _figures(state: SurveyState) -> schema.SurveyFiguresView:
    """A survey changes once a second, and is told ten times."""
    seen = figures(state)
    return schema.SurveyFiguresView(
        region_m2=seen.region_m2,
        reached_m2=seen.reached_m2,
        not_yet_m2=seen.not_yet_m2,
        in_shade_m2=seen.in_shade_m2,
        in_sun_m2=seen.in_sun_m2,
        sun_unknown_m2=seen.sun_unknown_m2,
        time_to_95_imaged_s=seen.time_to_95_imaged_s,
        time_to_95_in_sun_s=seen.time_to_95_in_sun_s,
    )


def cells_number(state: SurveyState) -> int:
    """Return a number that rises whenever a cell does: the sum of their states."""
    return int(state.progress.state.sum(dtype="int64"))


def _cells(state: SurveyState) -> schema.SurveyCellsView:
    grid = state.plan.cells.grid
    return schema.SurveyCellsView(
        number=cells_number(state),
        corners=corners_lon_lat(grid),
        cell_m=grid.cell_m,
        rows=grid.rows,
        cols=grid.cols,
    )


def _waits_long(station: Station, member: Member) -> Iterator[Condition]:
    """A way home that is not free for long is told: its battery is what it waits with."""
    running = station.fleet_return
    returning = None if running is None else running.members.get(member.serial)
    if returning is not None and returning.stage in (Stage.STOPPING, Stage.WAITING):
        why = returning.reason or "its turn has not come"
        condition = _about(station, member, RULE_HOME, f"still waits to fly home: {why}")
        yield replace(condition, after_s=SETTINGS.home_waits_s)


def _stands(station: Station, member: Member) -> bool:
    vehicle = station.fleet.vehicles.get(member.serial)
    return vehicle is not None and vehicle.is_flying.value is False


def _hovers_since(station: Station, member: Member) -> bool:
    """Whether a vehicle is in the air, and a mission of the survey is the last it was told."""
    vehicle = station.fleet.vehicles.get(member.serial)
    newest = newest_motion(station, member.serial)
    is_up = vehicle is not None and vehicle.is_flying.value is True
    return is_up and newest is not None and newest.command.id == member.command_id


def _about(station: Station, member: Member, rule: str, text: str) -> Condition:
    vehicle = station.fleet.vehicles.get(member.serial)
    name = member.serial if vehicle is None else vehicle.display_name
    link_id = None if vehicle is None else vehicle.link_id
    key = f"{rule}:{member.serial}"
    return Condition(key, Severity.WARNING, rule, name, f"{name}: {text}", member.serial, link_id)
