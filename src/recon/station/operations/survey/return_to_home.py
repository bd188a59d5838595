"""A survey's vehicles fly home when there is nothing left for them to fly.

They join the fleet return: a hold, then a landing mission at a height of its own, each in its turn.
All of it is ordered under guidance, for the user that started the survey, and goes through the
gate. It ends when an operator or a pilot takes control of the vehicle.
"""

from dataclasses import replace

from recon.model.command import Phase
from recon.model.control import AuthorityHolder
from recon.model.survey import SurveyPhase, WhenDone
from recon.station.control import authority
from recon.station.operations.fleet_return import commands
from recon.station.operations.guidance_hold import guidance_hold
from recon.station.state.fleet_return_record import ENDED
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped
from recon.station.state.survey_record import SurveyMember, SurveyRecord

IS_DONE = "the survey is done"


def is_done_and_returns(record: SurveyRecord) -> bool:
    """Return whether the survey is done and its vehicles are to fly home then."""
    is_done = record.state is not None and record.state.phase is SurveyPhase.DONE
    return is_done and returns_home(record)


def returns_home(record: SurveyRecord) -> bool:
    """Return whether a survey's vehicles fly home when there is nothing left for them to fly."""
    return record.survey.when_done is WhenDone.RETURN_HOME


def is_under_way(station: Station, member: SurveyMember) -> bool:
    """Return whether a vehicle flies home for its survey, or waits for its turn."""
    running = station.fleet_return
    returning = None if running is None else running.members.get(member.serial)
    if member.return_reason is None or returning is None or returning.stage in ENDED:
        return False
    return returning.role is AuthorityHolder.GUIDANCE


def send_home(station: Station, survey_id: int, serial: str, why: str, now_ns: int) -> Stepped:
    """Call one of a survey's vehicles home, if guidance controls it and it flies.

    One that cannot be called goes back to the operator, with the reason; it hovers, with an alarm.
    """
    record = station.surveys.records[survey_id]
    member, vehicle = record.members[serial], station.fleet.vehicles.get(serial)
    if station.control(serial).authority.holder is not AuthorityHolder.GUIDANCE or vehicle is None:
        return station, ()
    if vehicle.is_flying.value is False or is_under_way(station, member):
        return station, ()
    refusal = commands.refusal(station, serial)
    if refusal is not None:
        return _hand_back(station, record, serial, refusal.reason, now_ns), ()
    by = record.issuer
    station, hold = guidance_hold(station, serial, f"{by}: {why}")
    station, sent = commands.join(station, hold, by, now_ns)
    placed = station.orders.records[hold.command_id]
    if placed.phase is Phase.REFUSED_BY_STATION:
        return _hand_back(station, record, serial, placed.note, now_ns), sent
    record = record.put(replace(member, return_reason=why, may_take_off=False))
    return replace(station, surveys=station.surveys.put(record)), sent


def release_vehicles(station: Station, survey_id: int, now_ns: int) -> Stepped:
    """Give back the vehicles of a survey that has just ended or paused, or send them home.

    To be called once, when it stops running: later they may fly for another survey.
    """
    record = station.surveys.records[survey_id]
    if record.is_running or record.state is None:
        return station, ()
    outputs: tuple[Output, ...] = ()
    why = f"survey {record.survey.name} is {record.state.phase.value}: {record.state.reason}"
    for member in record.members.values():
        if is_done_and_returns(record) and member.stop_reason is None:
            station, sent = send_home(station, survey_id, member.serial, IS_DONE, now_ns)
            outputs += sent
        if not is_under_way(station, station.surveys.records[survey_id].members[member.serial]):
            station = authority.hand_back(station, member.serial, record.started_by, why, now_ns)
    return station, outputs


def _hand_back(
    station: Station, record: SurveyRecord, serial: str, why: str, now_ns: int
) -> Station:
    words = f"the survey {record.survey.name} could not send it home: {why}"
    return authority.hand_back(station, serial, record.started_by, words, now_ns)
