"""The alarms of surveys."""

from collections.abc import Iterator
from dataclasses import replace

from recon.guidance.survey import PAUSED_BY_COMMAND
from recon.model.survey import SurveyPhase
from recon.station.operations.motion_orders import newest_motion
from recon.station.operations.settings import SURVEY_TIMES
from recon.station.operations.survey.availability import (
    is_on_ground,
    may_stay,
    takes_off_automatically,
)
from recon.station.operations.survey.return_to_home import is_under_way
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.fleet_return_record import Stage
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyMember, SurveyRecord

RULE = "survey"
RULE_LEFT = "survey_over"
RULE_HOME = "survey_home"
RULE_TAKEOFF = "survey_takeoff"
RULE_PHOTOS = "survey_photos"


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must see to: surveys that have stopped, vehicles that have stopped."""
    for record in station.surveys.records.values():
        state = record.state
        is_paused = state is not None and state.phase is SurveyPhase.PAUSED
        if is_paused and state is not None and state.reason != PAUSED_BY_COMMAND:
            text = f"survey {record.survey.name} has paused automatically: {state.reason}"
            key = f"{RULE}:{record.survey.id}"
            yield Condition(key, Severity.WARNING, RULE, "", f"{text}. Start it again, or abort it")
        if record.is_running and record.trouble is not None:
            text = f"survey {record.survey.name} cannot continue: {record.trouble}"
            key = f"{RULE}_trouble:{record.survey.id}"
            yield Condition(key, Severity.ERROR, RULE, "", f"{text}. Pause it")
        for member in record.members.values():
            yield from _of_vehicle(station, record, member)
            yield from _of_photos(station, record, member)


def _of_vehicle(
    station: Station, record: SurveyRecord, member: SurveyMember
) -> Iterator[Condition]:
    name = record.survey.name
    if record.is_running and member.stop_reason is not None:
        text = f"stopped flying survey {name}: {member.stop_reason}"
        yield _about(station, member, RULE, f"{text}. Check it, then resume it")
    elif takes_off_automatically(station, record, member):
        text = (
            f"on the ground, and takes off automatically as soon as survey {name} has rows for it. "
            "Keep clear of it, and pause the survey before anyone goes there"
        )
        condition = _about(station, member, RULE_TAKEOFF, text)
        yield replace(condition, after_s=SURVEY_TIMES.takeoff_waits_s)
    elif is_under_way(station, member):
        yield from _waits_long(station, member)
    elif record.is_running and member.return_reason is not None and is_on_ground(station, member):
        again = f"recon survey start {record.survey.id} {member.serial} --takeoff"
        text = f"let it join survey {name} again ({again})"
        of_battery = _about_battery(station, member)
        yield _about(
            station, member, RULE, f"has returned home: {member.return_reason}. {of_battery} {text}"
        )
    elif record.is_over and _hovers_since(station, member):
        why = "" if member.stop_reason is None else f"; it had stopped: {member.stop_reason}"
        text = f"hovers: survey {name} is over{why}. Recall it, or give it an order"
        yield _about(station, member, RULE_LEFT, text)


def _of_photos(station: Station, record: SurveyRecord, member: SurveyMember) -> Iterator[Condition]:
    """A camera that takes no photos: the rows flown meanwhile are flown for nothing."""
    watch = record.photo_watches.get(member.serial)
    vehicle = station.fleet.vehicles.get(member.serial)
    if watch is None or watch.silent_s is None or not record.is_running or vehicle is None:
        return
    if vehicle.is_flying.value is False:
        return
    never = watch.newest_photo_ns is None
    what = "has taken no photo yet" if never else f"took no photo for {watch.silent_s:.1f} s"
    text = (
        f"{what} on its row of survey {record.survey.name}, which needs one every "
        f"{record.survey.camera.interval_s:g} s: start its camera's timer"
    )
    yield _about(station, member, RULE_PHOTOS, text)


def _about_battery(station: Station, member: SurveyMember) -> str:
    left = station.fleet.vehicles[member.serial].battery_fraction.value
    if left is None:
        return "Change its battery if it is low, then"
    return "Its battery is good:" if may_stay(station, left) else "Change its battery, then"


def _waits_long(station: Station, member: SurveyMember) -> Iterator[Condition]:
    """A vehicle that waits long for its route home: its battery is limited."""
    running = station.fleet_return
    returning = None if running is None else running.members.get(member.serial)
    if returning is not None and returning.stage in (Stage.STOPPING, Stage.WAITING):
        why = returning.reason or "its turn has not come"
        condition = _about(station, member, RULE_HOME, f"is waiting to fly home: {why}")
        yield replace(condition, after_s=SURVEY_TIMES.home_waits_s)


def _hovers_since(station: Station, member: SurveyMember) -> bool:
    """Whether a vehicle is in the air, and its newest order is a mission of the survey.

    The station's own holds do not count: after one it hovers as well. Orders are compared by their
    ids: surveys of one region have one name.
    """
    vehicle = station.fleet.vehicles.get(member.serial)
    if vehicle is None or vehicle.is_flying.value is not True:
        return False
    if station.surveys.running_with(member.serial) is not None:
        return False
    newest = newest_motion(station, member.serial, own=False)
    return newest is not None and newest.command.id == member.ordered_id


def _about(station: Station, member: SurveyMember, rule: str, text: str) -> Condition:
    vehicle = station.fleet.vehicles.get(member.serial)
    name = member.serial if vehicle is None else vehicle.display_name
    link_id = None if vehicle is None else vehicle.link_id
    key = f"{rule}:{member.serial}"
    return Condition(key, Severity.WARNING, rule, name, f"{name}: {text}", member.serial, link_id)
