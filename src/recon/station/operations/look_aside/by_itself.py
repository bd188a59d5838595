"""A look aside by itself: for a running survey that allows it, while light is mostly unknown.

It is ordered like one that a person asks for, for the person who started the survey, and refused
for the same reasons. At most once in five minutes; a refused one is tried again after a minute.
"""

from dataclasses import replace

from recon.guidance.look_aside import LookAsideSettings
from recon.model.command import Refusal
from recon.model.event import LookAsideOrdered
from recon.model.units import seconds_to_ns
from recon.station.operations.imager_motion.claim import motion_under_way
from recon.station.operations.look_aside.commands import begin
from recon.station.state.station import Station
from recon.station.state.steps import Stepped
from recon.station.state.survey_record import SurveyRecord


def begin_if_due(station: Station, now_ns: int, settings: LookAsideSettings) -> Stepped:
    """Begin a look aside for a survey if its light has been unknown for long enough."""
    asides = station.look_asides
    record = _survey_that_allows(station)
    serial = unknown_for_long(station, now_ns, settings)
    if record is None or serial is None:
        return replace(station, look_asides=asides.not_refused()), ()
    if now_ns < asides.due_ns or motion_under_way(station) is not None:
        return station, ()
    by = record.issuer
    event = LookAsideOrdered(by, person=record.person, survey_id=record.survey.id, serial=serial)
    begun = begin(station, event, now_ns)
    refusal = begun if isinstance(begun, Refusal) else None
    station, outputs = (station, ()) if isinstance(begun, Refusal) else begun
    every_s, again_s = settings.by_itself_every_s, settings.refused_again_s
    asides = station.look_asides.after_try(refusal, every_s, again_s, now_ns)
    return replace(station, look_asides=asides), outputs


def unknown_for_long(station: Station, now_ns: int, settings: LookAsideSettings) -> str | None:
    """Return an imaging drone with a recent shade map, and light mostly unknown for long."""
    for serial, since_ns in station.look_asides.unknown_since_ns.items():
        own = station.shade.own.get(serial)
        if own is None:
            continue  # a keyframe of a record holds no maps
        captured_at_ns = own.shade.captured_at_ns
        is_recent = now_ns - captured_at_ns <= seconds_to_ns(settings.map_within_s)
        if is_recent and captured_at_ns - since_ns >= seconds_to_ns(settings.unknown_for_s):
            return serial
    return None


def _survey_that_allows(station: Station) -> SurveyRecord | None:
    records = station.surveys.records.values()
    return next((r for r in records if r.is_running and r.survey.look_aside_allowed), None)
