"""Surveys, the fleet return and motions of imaging drones, as the API sends them."""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, TypedDict

import numpy as np

from recon.api import schema
from recon.geo import geo_from_enu
from recon.guidance.survey import SurveyState, figures
from recon.guidance.survey.state import Refused
from recon.model.geo import LocalFrame
from recon.model.units import seconds_to_ns
from recon.station.api_views.ages import since_s
from recon.station.api_views.imaging_views import corners_lon_lat, upwind_place_view
from recon.station.api_views.relief_views import light_view
from recon.station.operations.fleet_return.conditions import in_turn
from recon.station.operations.settings import SURVEY_TIMES
from recon.station.operations.survey.availability import (
    hindrance,
    is_flown,
    is_on_ground,
    takes_off_automatically,
)
from recon.station.operations.survey.return_to_home import is_under_way
from recon.station.state.fleet_return_record import ReturningVehicle
from recon.station.state.imager_motion import ImagerMotion, ImagerRelief, MoveUpwind, SideStep
from recon.station.state.station import Station
from recon.station.state.survey_record import SURVEYS_KEPT, EastNorth, SurveyMember, SurveyRecord

DECIMALS = 7
"""Decimals of a degree: a centimetre."""


def survey_views(station: Station, now_ns: int) -> list[schema.SurveyView]:
    """Return the kept surveys of this run, the newest first."""
    records = reversed(tuple(station.surveys.records.values()))
    return [survey_view(station, record, now_ns) for record in records]


def survey_view(station: Station, record: SurveyRecord, now_ns: int) -> schema.SurveyView:
    """Return one survey."""
    state, survey = record.state, record.survey
    phase, reason = record.phase
    return schema.SurveyView(
        id=survey.id,
        name=survey.name,
        region=survey.region_name,
        phase=phase,
        reason=reason,
        asked_by=record.by,
        age_s=since_s(record.asked_at_ns, now_ns),
        started_by=record.started_by or None,
        planner=survey.planner,
        when_done=survey.when_done.value,
        side_step_allowed=survey.side_step_allowed,
        upwind_allowed=survey.upwind_allowed,
        relief_allowed=survey.relief_allowed,
        spare_serial=survey.spare_serial,
        light=light_view(station, record, now_ns),
        height_above_takeoff_m=survey.height_above_takeoff_m,
        height_above_ground_m=survey.height_above_ground_m,
        speed_mps=survey.speed_mps,
        rows_note=survey.rows_note,
        rest_since_unix_s=None if survey.flown is None else survey.flown.since_s,
        round=0 if state is None else state.round,
        missions=0 if state is None else state.missions,
        flown_m=0.0 if state is None else state.flown_m,
        vehicles=[_member(station, record, each, now_ns) for each in record.members.values()],
        figures=None if state is None else _figures(state),
        cells=None if state is None else _cells(state),
        rows=0 if state is None else state.plan.row_count,
        paths=sum(len(path) for path in record.flown.values()),
    )


def survey_paths(record: SurveyRecord) -> schema.SurveyPaths | None:
    """Return the planned rows, the missions in flight and the flown paths; None without rows."""
    state = record.state
    if state is None:
        return None
    frame = state.plan.frame
    return schema.SurveyPaths(
        survey_id=record.survey.id,
        rows=[_lon_lat(frame, row) for row in state.plan.rows_m],
        flying=[
            schema.SurveyPath(
                serial=serial, number=each.number, places=_lon_lat(frame, each.corners_m)
            )
            for serial, each in state.flights.items()
        ],
        flown=[
            schema.SurveyPath(serial=serial, number=number, places=_lon_lat(frame, path))
            for (serial, number), path in record.flown.items()
        ],
    )


def _refused(state: SurveyState, serial: str, now_ns: int) -> Refused | None:
    """The refusal that a vehicle waits for now, not one of a mission that was flown since."""
    found = state.refusals.get(serial)
    if found is None:
        return None
    until_ns = found.again_ns + seconds_to_ns(SURVEY_TIMES.asked_again_within_s)
    return found if serial in state.barred or now_ns < until_ns else None


def _member(
    station: Station, record: SurveyRecord, member: SurveyMember, now_ns: int
) -> schema.SurveyingView:
    state = record.state
    assert state is not None  # members come with the start
    vehicle = station.fleet.vehicles.get(member.serial)
    is_active = record.is_running or is_under_way(station, member)
    waits = hindrance(station, member, now_ns) if is_active else None
    decision = state.decisions.get(member.serial) if is_active and waits is None else None
    flies = is_flown(station, member)
    refused = None if record.is_over or flies else _refused(state, member.serial, now_ns)
    return schema.SurveyingView(
        serial=member.serial,
        vehicle_name=member.serial if vehicle is None else vehicle.display_name,
        is_flying_rows=flies,
        not_flying_reason=waits,
        decision=None if decision is None else decision.text,
        refused=None if refused is None else refused.reason,
        waits_for=None if refused is None else refused.waits_for or None,
        takes_off_automatically=takes_off_automatically(station, record, member),
        has_come_home=member.return_reason is not None and is_on_ground(station, member),
        mission_command_id=member.command_id,
    )


@lru_cache(maxsize=SURVEYS_KEPT)
def _figures(state: SurveyState) -> schema.SurveyFiguresView:
    """Cached: a survey changes once a second and is sent ten times."""
    seen = figures(state)
    return schema.SurveyFiguresView(
        region_m2=seen.region_m2,
        reached_m2=seen.reached_m2,
        not_yet_m2=seen.not_yet_m2,
        in_shade_m2=seen.in_shade_m2,
        in_sun_m2=seen.in_sun_m2,
        sun_unknown_m2=seen.sun_unknown_m2,
        not_shown_m2=seen.not_shown_m2,
        time_to_95_imaged_s=seen.time_to_95_imaged_s,
        time_to_95_in_sun_s=seen.time_to_95_in_sun_s,
    )


def cells_number(state: SurveyState) -> int:
    """Return a number that rises whenever a cell does: with its state, or its known light."""
    progress = state.progress
    return int(progress.state.sum(dtype="int64") + progress.is_sun_known.sum(dtype="int64"))


def _cells(state: SurveyState) -> schema.SurveyCellsView:
    grid = state.plan.cells.grid
    return schema.SurveyCellsView(
        number=cells_number(state),
        corners=corners_lon_lat(grid),
        cell_m=grid.cell_m,
        rows=grid.rows,
        cols=grid.cols,
    )


def _lon_lat(frame: LocalFrame, places_m: Iterable[EastNorth]) -> list[tuple[float, float]]:
    """Return (longitude, latitude) of places in east-north metres of the frame."""
    points_m = np.array([(*place, 0.0) for place in places_m]).reshape(-1, 3)
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, points_m)
    return [
        (round(float(lon), DECIMALS), round(float(lat), DECIMALS))
        for lon, lat in zip(longitude_deg, latitude_deg, strict=True)
    ]


class OperationFields(TypedDict):
    """The fields of the state that show operations: the newest one of each kind."""

    fleet_return: schema.FleetReturnView | None
    side_step: schema.SideStepView | None
    move_upwind: schema.MoveUpwindView | None
    imager_relief: schema.ImagerReliefView | None
    surveys: list[schema.SurveyView]


def operation_fields(station: Station, now_ns: int) -> OperationFields:
    """Return what the state shows of operations."""
    return OperationFields(
        fleet_return=_fleet_return(station, now_ns),
        side_step=_side_step(station, now_ns),
        move_upwind=_move_upwind(station, now_ns),
        imager_relief=_imager_relief(station, now_ns),
        surveys=survey_views(station, now_ns),
    )


def _fleet_return(station: Station, now_ns: int) -> schema.FleetReturnView | None:
    """Return the newest fleet return; None before the first."""
    running = station.fleet_return
    if running is None:
        return None
    return schema.FleetReturnView(
        called_by=running.by,
        age_s=since_s(running.called_at_ns, now_ns),
        is_over=running.is_over,
        vehicles=[_returning(member, now_ns) for member in in_turn(running)],
    )


def _side_step(station: Station, now_ns: int) -> schema.SideStepView | None:
    """Return the newest side-step; None before the first."""
    newest = station.imager_motions.of(SideStep)
    if newest is None:
        return None
    return schema.SideStepView(**_motion(newest, now_ns), bearing_deg=newest.bearing_deg)


def _move_upwind(station: Station, now_ns: int) -> schema.MoveUpwindView | None:
    """Return the newest move upwind; None before the first."""
    newest = station.imager_motions.of(MoveUpwind)
    if newest is None:
        return None
    place = upwind_place_view(newest.proposal)
    return schema.MoveUpwindView(**_motion(newest, now_ns), place=place)


def _imager_relief(station: Station, now_ns: int) -> schema.ImagerReliefView | None:
    """Return the newest relief of an imaging drone; None before the first."""
    newest = station.imager_motions.of(ImagerRelief)
    if newest is None:
        return None
    return schema.ImagerReliefView(
        **_motion(newest, now_ns),
        relieved=newest.relieved,
        relieved_name=newest.relieved_name,
        maps=newest.maps,
    )


def _motion(newest: ImagerMotion, now_ns: int) -> dict[str, Any]:
    """The fields of every motion of an imaging drone."""
    return {
        "serial": newest.serial,
        "vehicle_name": newest.name,
        "stage": newest.stage.value,
        "since_age_s": since_s(newest.since_ns, now_ns),
        "begun_by": newest.by,
        "begun_age_s": since_s(newest.begun_at_ns, now_ns),
        "reason": newest.reason or None,
        "survey_id": newest.survey_id,
    }


def _returning(member: ReturningVehicle, now_ns: int) -> schema.ReturningView:
    flight = member.flight
    return schema.ReturningView(
        serial=member.serial,
        vehicle_name=member.name,
        stage=member.stage.value,
        since_age_s=since_s(member.since_ns, now_ns),
        reason=member.reason or None,
        wave=None if flight is None else flight.wave,
        layer_height_m=None if flight is None else flight.layer_up_m,
        layer_height_above_takeoff_m=None
        if flight is None
        else flight.layer_up_m - flight.takeoff_up_m,
        pad=None if flight is None else flight.pad.name,
        hold_command_id=member.hold_id,
        mission_command_id=member.mission_id,
    )
