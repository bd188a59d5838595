"""The alarms of reliefs: a drone that must return soon, a survey without light, a relief's end."""

from collections.abc import Iterator
from math import ceil

from recon.guidance.imager_relief import RELIEF_SETTINGS
from recon.model.units import seconds_to_ns
from recon.station.imaging.at_work import imagers_at_work
from recon.station.operations.imager_motion.notices import (
    about,
    automatic_motion,
    cannot_begin,
    is_left,
)
from recon.station.operations.imager_relief import return_home
from recon.station.operations.imager_relief.automatic import by_survey
from recon.station.operations.imager_relief.outlook import needs_longer
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import ImagerRelief, MotionStage
from recon.station.state.imager_relief import ImagerOutlook
from recon.station.state.imaging import TOGETHER_WITHIN_S
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

RULE = ImagerRelief.rule


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know, while a survey runs or a relief has left something."""
    newest = station.imager_motions.of(ImagerRelief)
    running = [r for r in station.surveys.records.values() if r.is_running]
    if newest is not None:
        yield from automatic_motion(
            station, newest, f"relieves {newest.relieved_name} for its survey"
        )
        yield from _ended(station, newest)
    for record in running[:1]:
        yield from _must_return(station, record)
    for record in running:
        yield from _without_light(station, record)
    spare = next((r.survey.spare_serial for r in running if r.survey.relief_allowed), None)
    yield from cannot_begin(station, ImagerRelief, spare or "", "the relief cannot begin")


def _ended(station: Station, newest: ImagerRelief) -> Iterator[Condition]:
    is_there = newest.relieved in imagers_at_work(station)
    if newest.stage is MotionStage.DONE and newest.home_refused and is_there:
        text = f"relieves {newest.relieved_name}, and that one cannot be recalled: "
        text += f"{newest.home_refused}. Recall it"
        yield about(station, newest, Severity.WARNING, "stays", text)
    if is_left(station, newest):
        text = f"its relief of {newest.relieved_name} stopped, and it hovers: {newest.reason}. "
        text += "Fix the cause and relieve again, or recall it"
        yield about(station, newest, Severity.WARNING, "stopped", text)


def _must_return(station: Station, record: SurveyRecord) -> Iterator[Condition]:
    """A drone whose battery ends before the survey, unless a relief is under way or will begin."""
    newest = station.imager_motions.of(ImagerRelief)
    coming = None if newest is None or newest.is_over else newest.relieved
    for serial in imagers_at_work(station):
        outlook = station.reliefs.outlooks.get(serial)
        if outlook is None or outlook.return_due_ns is None or serial == coming:
            continue
        if outlook.return_due_in_s > 0.0 and _shows_too(station, serial):
            continue
        if outlook.return_due_in_s > RELIEF_SETTINGS.warned_before_s or _will_relieve(
            station, record
        ):
            continue
        if needs_longer(station.reliefs, record.survey.id, outlook.return_due_in_s):
            yield _leaves(station, record, serial, outlook)


def _shows_too(station: Station, serial: str) -> bool:
    """Whether another imaging drone at work has a shade map of now."""
    now_ns = station.reliefs.checked_at_ns or 0
    return any(
        now_ns - own.shade.captured_at_ns <= seconds_to_ns(TOGETHER_WITHIN_S)
        for other, own in station.shade.own.items()
        if other != serial and other in imagers_at_work(station)
    )


def _will_relieve(station: Station, record: SurveyRecord) -> bool:
    """Whether the survey's spare drone takes the place automatically, and is not refused."""
    survey, spare = record.survey, record.survey.spare_serial
    refused = station.imager_motions.start(ImagerRelief).refused
    if not survey.relief_allowed or spare is None or refused is not None:
        return False
    vehicle = station.fleet.vehicles.get(spare)
    is_there = vehicle is not None and vehicle.link_id is not None
    return is_there and record.spare_may_take_off


def _leaves(
    station: Station, record: SurveyRecord, serial: str, outlook: ImagerOutlook
) -> Condition:
    vehicle = station.fleet.vehicles[serial]
    name, minutes = vehicle.display_name, ceil(outlook.return_due_in_s / 60.0)
    when = "now" if outlook.return_due_in_s <= 0.0 else f"in {minutes} min"
    what = "Relieve it, or recall it"
    if record.survey.relief_allowed:
        by, now_ns = by_survey(record), station.reliefs.checked_at_ns or 0
        refused = return_home.refusal(station, serial, by, record.person, now_ns)
        what = "Relieve it, or it is recalled then"
        if refused is not None:
            what = f"It cannot be recalled automatically: {refused.reason}"
    elif outlook.return_due_in_s <= 0.0:
        what = "Recall it"
    text = (
        f"{name}: battery at the return threshold {when}; survey {record.survey.name} is still "
        f"running: without a second imaging drone, light is unknown from then on. {what}"
    )
    key = f"{RULE}:return:{serial}"
    return Condition(key, Severity.WARNING, RULE, name, text, serial, vehicle.link_id)


def _without_light(station: Station, record: SurveyRecord) -> Iterator[Condition]:
    outlook = station.reliefs.surveys.get(record.survey.id)
    if outlook is None or outlook.without_light is None:
        return
    text = (
        f"survey {record.survey.name} has no shade map: what is flown now counts as light unknown. "
        "Send an imaging drone to its place, or pause the survey"
    )
    yield Condition(f"{RULE}:light:{record.survey.id}", Severity.WARNING, RULE, "", text)
