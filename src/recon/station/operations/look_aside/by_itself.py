"""A look aside by itself: for a running survey that allows it, while light is mostly unknown.

It is ordered like one that a person asks for, for the person who started the survey, and refused
for the same reasons. At most once in five minutes; a refused one is tried again after a minute.
"""

from dataclasses import replace

from recon.guidance.look_aside import LookAsideSettings
from recon.model.command import Refusal
from recon.model.event import LookAsideOrdered
from recon.model.units import seconds_to_ns
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
        if asides.refused is not None:
            station = replace(station, look_asides=replace(asides, refused=None))
        return station, ()
    if now_ns < asides.due_ns:
        return station, ()
    by = f"{record.started_by}: survey {record.survey.name}"
    event = LookAsideOrdered(by, person=record.person, survey_id=record.survey.id, serial=serial)
    begun = begin(station, event, now_ns)
    if isinstance(begun, Refusal):
        due_ns = now_ns + seconds_to_ns(settings.refused_again_s)
        refused = replace(asides, due_ns=due_ns, refused=begun.reason)
        return replace(station, look_asides=refused), ()
    due_ns = now_ns + seconds_to_ns(settings.by_itself_every_s)
    waits = replace(begun.station.look_asides, due_ns=due_ns)
    return replace(begun.station, look_asides=waits), begun.outputs


def unknown_for_long(station: Station, now_ns: int, settings: LookAsideSettings) -> str | None:
    """Return an imaging drone with a recent shade map, and light mostly unknown for long."""
    for serial, since_ns in station.look_asides.unknown_since_ns.items():
        captured_at_ns = station.shade.own[serial].shade.captured_at_ns
        is_recent = now_ns - captured_at_ns <= seconds_to_ns(settings.map_within_s)
        if is_recent and captured_at_ns - since_ns >= seconds_to_ns(settings.unknown_for_s):
            return serial
    return None


def _survey_that_allows(station: Station) -> SurveyRecord | None:
    records = station.surveys.records.values()
    return next((r for r in records if r.is_running and r.survey.look_aside_allowed), None)
