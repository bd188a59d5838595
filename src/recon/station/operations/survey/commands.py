"""Operator commands to a survey: start, pause, abort. Each is refused or accepted as a whole."""

from dataclasses import replace
from types import MappingProxyType

from recon.guidance.survey import SurveyState, abort, pause, start
from recon.guidance.survey.plan import RULE
from recon.model.command import Hover, LandNow, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AuthorityTaken,
    OperatorOrder,
    SurveyStarted,
    SurveyStopped,
)
from recon.safety.rules.not_expired import given_refusal
from recon.station.control import authority, handover, order_gateway
from recon.station.control.stop_latch import RULE as STOP_RULE
from recon.station.operations.survey.availability import is_flown
from recon.station.operations.survey.return_to_home import is_under_way
from recon.station.state.fleet_return_record import ENDED
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped
from recon.station.state.survey_record import SurveyMember, SurveyRecord


def start_refusal(station: Station, event: SurveyStarted, now_ns: int) -> Refusal | None:
    """Return why a survey cannot be started with these vehicles, else None."""
    record = station.surveys.records.get(event.survey_id)
    if record is None:
        return _unknown(station, event.survey_id)
    late = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
    if late is not None:
        return late
    started = _started(record, event, now_ns)
    if isinstance(started, Refusal):
        return started
    for serial in event.serials:
        refusal = _vehicle_refusal(station, record, serial, event, now_ns)
        if refusal is not None:
            return refusal
    return None


def start_survey(station: Station, event: SurveyStarted, now_ns: int) -> Stepped:
    """Start a survey, and give the named vehicles to guidance.

    For a running survey the named vehicles join it, or fly for it again. Nothing changes if any of
    them is refused.
    """
    if start_refusal(station, event, now_ns) is not None:
        return station, ()
    record = station.surveys.records[event.survey_id]
    state = _started(record, event, now_ns)
    assert isinstance(state, SurveyState)  # or it was refused
    serials = dict.fromkeys(event.serials)
    outputs: tuple[Output, ...] = ()
    for serial in serials:
        taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, event.by, event.person)
        station, withdrawn = handover.take(station, taken, now_ns)
        outputs += withdrawn
    named = {
        serial: replace(
            record.members.get(serial, SurveyMember(serial)),
            may_take_off=event.takeoff,
            stop_reason=None,
            return_reason=None,
            unsent_since_ns=None,
        )
        for serial in serials
    }
    kept = {
        serial: member
        for serial, member in record.members.items()
        if record.is_running or is_under_way(station, member)
    }
    fresh = {serial: _without_ended_mission(station, member) for serial, member in named.items()}
    record = replace(
        record,
        state=state,
        started_by=event.by,
        person=event.person,
        members=MappingProxyType({**kept, **fresh}),
        # For vehicles that join it later, it is their own takeoff that is allowed or not.
        spare_may_take_off=record.spare_may_take_off if record.is_running else event.takeoff,
        step_due_ns=now_ns,
    )
    surveys = station.surveys.without_pending(event.survey_id)
    return replace(station, surveys=surveys.put(record)), outputs


def stop_refusal(station: Station, event: SurveyStopped, now_ns: int) -> Refusal | None:
    """Return why a survey cannot be paused or aborted, else None."""
    record = station.surveys.records.get(event.survey_id)
    if record is None:
        return _unknown(station, event.survey_id)
    stopped = _stopped(station, record, event, now_ns)
    return stopped if isinstance(stopped, Refusal) else None


def stop_survey(station: Station, event: SurveyStopped, now_ns: int) -> Stepped:
    """Pause or abort a survey, and hold its vehicles.

    The holds take them from guidance: the next start names its vehicles again.
    """
    if stop_refusal(station, event, now_ns) is not None:
        return station, ()
    record = station.surveys.records[event.survey_id]
    state = _stopped(station, record, event, now_ns)
    assert isinstance(state, SurveyState)  # or it was refused
    surveys = station.surveys.without_pending(event.survey_id)
    station = replace(station, surveys=surveys.put(replace(record, state=state)))
    verb = "aborted" if event.is_aborted else "paused"
    outputs: tuple[Output, ...] = ()
    for member in record.members.values():
        is_its = record.is_running or is_under_way(station, member)
        if is_its and station.control(member.serial).authority.holder is AuthorityHolder.GUIDANCE:
            by = f"{event.by}: survey {record.survey.name} {verb}"
            station, sent = _hold(station, member, by, now_ns)
            outputs += sent
            station = authority.hand_back(station, member.serial, event.by, by, now_ns)
    return station, outputs


def _hold(station: Station, member: SurveyMember, by: str, now_ns: int) -> Stepped:
    """Hold a vehicle; land one on the ground, if its mission may yet make it take off."""
    vehicle = station.fleet.vehicles.get(member.serial)
    may_set_out = is_flown(station, member)
    if vehicle is None or (vehicle.is_flying.value is False and not may_set_out):
        return station, ()
    station, number = take_id(station)
    hold = OperatorOrder(number, Hover(), by, serial=member.serial)
    station, sent = order_gateway.submit(station, hold, now_ns)
    if station.orders.records[number].phase is not Phase.REFUSED_BY_STATION or not may_set_out:
        return station, sent
    station, number = take_id(station)
    land = OperatorOrder(number, LandNow(), by, serial=member.serial)
    station, landing = order_gateway.submit(station, land, now_ns)
    return station, (*sent, *landing)


def _without_ended_mission(station: Station, member: SurveyMember) -> SurveyMember:
    """Forget a finished mission; keep the one in flight."""
    return member if is_flown(station, member) else replace(member, command_id=None)


def _started(record: SurveyRecord, event: SurveyStarted, now_ns: int) -> SurveyState | Refusal:
    if record.refusal is not None:
        return record.refusal
    state = record.state
    if state is None:
        return Refusal(RULE, f"the rows of the survey {record.survey.name} are still being planned")
    if not record.is_running or not event.serials:
        return start(state, event.serials, now_ns)
    named = frozenset(event.serials)
    return replace(
        state,
        serials=tuple(dict.fromkeys((*state.serials, *event.serials))),
        barred=state.barred - named,
    )


def _stopped(
    station: Station, record: SurveyRecord, event: SurveyStopped, now_ns: int
) -> SurveyState | Refusal:
    if record.refusal is not None:
        return record.refusal
    if record.state is None:
        return Refusal(RULE, f"the rows of the survey {record.survey.name} are still being planned")
    if record.is_over and any(is_under_way(station, each) for each in record.members.values()):
        return record.state  # unchanged; its vehicles returning home are held
    if event.is_aborted:
        return abort(record.state, now_ns)
    return pause(record.state, now_ns)


def _vehicle_refusal(
    station: Station, record: SurveyRecord, serial: str, event: SurveyStarted, now_ns: int
) -> Refusal | None:
    taken = AuthorityTaken(serial, AuthorityHolder.GUIDANCE, event.by, event.person)
    given = handover.refusal(station, taken, now_ns)
    if given is not None:
        return given
    vehicle = station.fleet.vehicles[serial]
    name = vehicle.display_name
    if station.is_stopped(serial):
        return Refusal(STOP_RULE, f"{name} is held by an all stop; release its stop first")
    flown = record.survey.flown
    if flown is not None and flown.is_simulated and not vehicle.is_simulated:
        text = (
            f"{name} is a real drone, and the rest of {record.survey.name} is what simulated ones "
            "have left: plan all of it for real drones"
        )
        return Refusal(RULE, text)
    if serial in station.imaging.imagers:
        return Refusal(RULE, f"{name} is an imaging drone and cannot join a survey")
    other = station.surveys.running_with(serial)
    if other is not None and other.survey.id != record.survey.id:
        return Refusal(RULE, f"{name} flies for the survey {other.survey.name}; pause that first")
    running = station.fleet_return
    member = None if running is None else running.members.get(serial)
    if member is not None and member.stage not in ENDED:
        return Refusal(RULE, f"{name} is returning home; hold it first, or let it land")
    if vehicle.is_flying.value is False and not event.takeoff:
        return Refusal(RULE, f"{name} is on the ground; allow takeoff for this start")
    return None


def _unknown(station: Station, survey_id: int) -> Refusal:
    return Refusal(RULE, station.surveys.unknown_survey(survey_id))
