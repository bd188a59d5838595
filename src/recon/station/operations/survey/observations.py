"""Where a survey's vehicles are seen, and which shade: kept until the next look counts it."""

from dataclasses import replace
from math import hypot
from types import MappingProxyType

from recon.guidance.survey import PositionSample
from recon.model.shade import ShadeMap
from recon.model.survey import SurveyPhase
from recon.model.vehicle import VehicleState
from recon.safety.datum import places_m
from recon.station.operations.survey.availability import is_flown
from recon.station.operations.survey.settings import SETTINGS, SurveyCarrying
from recon.station.state.station import Station
from recon.station.state.survey_record import Place, SurveyRecord

_OPEN = (SurveyPhase.RUNNING, SurveyPhase.PAUSED)


def see_vehicle(
    station: Station, vehicle: VehicleState, now_ns: int, settings: SurveyCarrying = SETTINGS
) -> Station:
    """Return the station after a vehicle told where it is."""
    surveys, serial = station.surveys, vehicle.serial
    frame = station.airspace.airspace.frame
    for record in surveys.records.values():
        if serial is None or serial not in record.members or frame is None or not _is_open(record):
            continue
        at, height_m = vehicle.position, vehicle.height_above_takeoff_m
        if at.value is None or height_m.value is None or at.received_at_ns != now_ns:
            continue
        east_m, north_m = (float(metres) for metres in places_m(frame, [at.value])[0])
        seen = PositionSample(now_ns, east_m, north_m, height_m.value)
        record = replace(record, seen=record.seen.with_one((serial, seen), settings.seen_kept))
        record = _drawn(station, record, serial, (east_m, north_m), settings)
        surveys = surveys.put(record)
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def see_shade(station: Station, shade: ShadeMap, settings: SurveyCarrying = SETTINGS) -> Station:
    """Return the station after a shade map, for every survey that flies or pauses."""
    surveys = station.surveys
    for record in surveys.records.values():
        if _is_open(record):
            kept = record.shade.with_one(shade, settings.shade_kept)
            surveys = surveys.put(replace(record, shade=kept))
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def _is_open(record: SurveyRecord) -> bool:
    return record.state is not None and record.state.phase in _OPEN


def _drawn(
    station: Station,
    record: SurveyRecord,
    serial: str,
    place_m: Place,
    settings: SurveyCarrying,
) -> SurveyRecord:
    """With the way of the mission that the vehicle flies, if it flies one."""
    member = record.members[serial]
    if not is_flown(station, member):
        return record
    key = serial, member.number
    way = record.flown.get(key, ())
    if len(way) >= settings.track_corners:
        return record
    if way and hypot(way[-1][0] - place_m[0], way[-1][1] - place_m[1]) < settings.track_step_m:
        return record
    flown = MappingProxyType({**record.flown, key: (*way, place_m)})
    return replace(record, flown=flown)
