"""Automatic reliefs and recalls: for a running survey that allows them.

A relief begins two and a half minutes before it must, if the survey would outlast its imaging
drone's stay. A drone that must return is recalled, relieved or not: its battery ends; a relief
that was refused until then still follows. Both are ordered for the person who started the survey,
and refused for the same reasons as when a person asks.

The permission to take off, given with the survey's start, is for one relief: whatever ends that, no
other begins automatically until the survey is started again.
"""

from collections.abc import Iterator
from dataclasses import replace

from recon.guidance.imager_relief import (
    FRAMES_HZ,
    RELIEF_SETTINGS,
    ImagerReliefSettings,
    transit_time_s,
)
from recon.model.command import Refusal
from recon.model.event import ReliefOrdered
from recon.model.units import seconds_to_ns
from recon.station.imaging.at_work import imagers_at_work, is_in_the_air
from recon.station.operations.imager_motion.execution import after_automatic_begin, not_refused
from recon.station.operations.imager_relief.commands import begin
from recon.station.operations.imager_relief.outlook import needs_longer
from recon.station.operations.imager_relief.return_home import recall
from recon.station.state.imager_motion import ImagerRelief
from recon.station.state.imager_relief import Recall
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped
from recon.station.state.survey_record import SurveyRecord


def begin_if_due(
    station: Station, now_ns: int, settings: ImagerReliefSettings = RELIEF_SETTINGS
) -> Stepped:
    """Begin a relief for a survey whose imaging drone must return soon."""
    due = next(_due(station, settings), None)
    motions = station.imager_motions
    if due is None:
        return not_refused(station, ImagerRelief), ()
    if now_ns < motions.start(ImagerRelief).due_ns or motions.under_way() is not None:
        return station, ()
    record, event = due
    begun, again_s = begin(station, event, now_ns), settings.refused_again_s
    station, outputs = after_automatic_begin(station, ImagerRelief, begun, again_s, again_s, now_ns)
    if not isinstance(begun, Refusal):
        used = replace(record, spare_may_take_off=False)
        station = replace(station, surveys=station.surveys.put(used))
    return station, outputs


def recall_if_due(
    station: Station, now_ns: int, settings: ImagerReliefSettings = RELIEF_SETTINGS
) -> Stepped:
    """Recall each imaging drone that must return now, if a running survey allows it."""
    record = next((r for r in _running(station) if r.survey.relief_allowed), None)
    outputs: tuple[Output, ...] = ()
    if record is None:
        return station, outputs
    motion, again_ns = station.imager_motions.under_way(), seconds_to_ns(settings.called_again_s)
    for serial in imagers_at_work(station):
        if motion is not None and motion.serial == serial:
            continue  # it flies as ordered; the failsafe matrix decides
        outlook = station.reliefs.outlooks.get(serial)
        if outlook is None or outlook.return_due_ns is None or outlook.return_due_ns > now_ns:
            continue
        before = station.reliefs.recalled.get(serial)
        if before is not None and now_ns - before.at_ns < again_ns:
            continue
        called = recall(station, serial, by_survey(record), record.person, now_ns)
        if not isinstance(called, Refusal):
            station, outputs = called[0], (*outputs, *called[1])
            left = Recall(record.survey.id, now_ns)
            all_left = {**station.reliefs.recalled, serial: left}
            station = replace(station, reliefs=replace(station.reliefs, recalled=all_left))
    return station, outputs


def by_survey(record: SurveyRecord) -> str:
    """Return for whom a survey's imaging drone flies."""
    return record.issuer


def relief_takes_s(station: Station, relieved: str, spare: str) -> float | None:
    """Return how long a relief takes until its maps come; None while a place is not known."""
    at, vehicle = station.reliefs.places.get(relieved), station.fleet.vehicles.get(spare)
    if at is None or vehicle is None:
        return None
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    if here is None or height_m is None:
        return None
    settings = RELIEF_SETTINGS
    maps_s = settings.camera_quiet_s + settings.maps_in_a_row / FRAMES_HZ
    return transit_time_s(here, at.up_m - height_m, at.place) + maps_s


def _running(station: Station) -> Iterator[SurveyRecord]:
    return (each for each in station.surveys.records.values() if each.is_running)


def _due(
    station: Station, settings: ImagerReliefSettings
) -> Iterator[tuple[SurveyRecord, ReliefOrdered]]:
    """Yield the reliefs that must begin now, of surveys that allow them."""
    at_work, called = imagers_at_work(station), station.reliefs.recalled
    for record in _running(station):
        survey, spare = record.survey, record.survey.spare_serial
        if not survey.relief_allowed or spare is None or not record.spare_may_take_off:
            continue
        due = [each for each in at_work if is_due(station, record, each, spare, settings)]
        left = [serial for serial, each in called.items() if each.survey_id == survey.id]
        for serial in due if at_work else left:
            takeoff = not is_in_the_air(station, spare)
            by, person = by_survey(record), record.person
            event = ReliefOrdered(serial, spare, by, takeoff, person=person, survey_id=survey.id)
            if serial != spare:
                yield record, event


def is_due(
    station: Station,
    record: SurveyRecord,
    serial: str,
    spare: str,
    settings: ImagerReliefSettings,
) -> bool:
    """Return whether an imaging drone's relief must begin now, for its survey to have light."""
    outlook = station.reliefs.outlooks.get(serial)
    takes_s = relief_takes_s(station, serial, spare)
    if outlook is None or outlook.return_due_ns is None or takes_s is None:
        return False
    is_soon = outlook.return_due_in_s <= takes_s + settings.early_s
    return is_soon and needs_longer(station.reliefs, record.survey.id, outlook.return_due_in_s)
