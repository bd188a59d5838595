"""Positions of a survey's vehicles and shade maps, kept until the next step counts them."""

from dataclasses import replace
from math import hypot
from types import MappingProxyType

from recon.guidance.survey import PositionSample
from recon.model.shade import ShadeMap
from recon.model.survey import SurveyPhase
from recon.model.vehicle import VehicleState
from recon.safety.datum import places_m
from recon.station.operations.settings import SURVEY_TIMES, SurveyTimes
from recon.station.operations.survey.availability import is_flown
from recon.station.state.station import Station
from recon.station.state.survey_record import EastNorth, SurveyRecord

_OPEN = (SurveyPhase.RUNNING, SurveyPhase.PAUSED)


def on_position(
    station: Station, vehicle: VehicleState, now_ns: int, settings: SurveyTimes = SURVEY_TIMES
) -> Station:
    """Keep a vehicle's new position for the surveys it belongs to."""
    surveys, serial = station.surveys, vehicle.serial
    frame = station.airspace.airspace.frame
    for record in surveys.records.values():
        if serial is None or serial not in record.members or frame is None or not _is_open(record):
            continue
        at, height_m = vehicle.position, vehicle.height_above_takeoff_m
        if at.value is None or height_m.value is None or at.received_at_ns != now_ns:
            continue
        east_m, north_m = (float(metres) for metres in places_m(frame, [at.value])[0])
        sample = PositionSample(now_ns, east_m, north_m, height_m.value)
        kept = record.positions.with_one((serial, sample), settings.positions_kept)
        record = replace(record, positions=kept)
        record = _with_path(station, record, serial, (east_m, north_m), settings)
        surveys = surveys.put(record)
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def on_shade(station: Station, shade: ShadeMap, settings: SurveyTimes = SURVEY_TIMES) -> Station:
    """Keep a new shade map for every running or paused survey."""
    surveys = station.surveys
    for record in surveys.records.values():
        if _is_open(record):
            kept = record.shade_maps.with_one(shade, settings.shade_maps_kept)
            surveys = surveys.put(replace(record, shade_maps=kept))
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def _is_open(record: SurveyRecord) -> bool:
    return record.state is not None and record.state.phase in _OPEN


def _with_path(
    station: Station,
    record: SurveyRecord,
    serial: str,
    place_m: EastNorth,
    settings: SurveyTimes,
) -> SurveyRecord:
    """Extend the flown path of the vehicle's mission, if it flies one."""
    member = record.members[serial]
    if not is_flown(station, member):
        return record
    key = serial, member.number
    path = record.flown.get(key, ())
    if len(path) >= settings.track_corners:
        return record
    if path and hypot(path[-1][0] - place_m[0], path[-1][1] - place_m[1]) < settings.track_step_m:
        return record
    flown = MappingProxyType({**record.flown, key: (*path, place_m)})
    return replace(record, flown=flown)
