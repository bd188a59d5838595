"""The execution of a move upwind: one goto to the proposed place, then a hold.

While a survey that allows it runs, a place is proposed every ten seconds (`search`). A move begins
once a place is better by a clear margin for half a minute, for the person who started the survey,
and at most once in three minutes; a refused one is tried again after a minute.

    upwind --arrived--> done
    upwind --the survey no longer runs, or what ends any motion--> stopped

A person's order to the imaging drone, and a stopped move, are that person's decision where it
hovers: it does not move by itself again until the survey has been paused and started again.
"""

from dataclasses import replace

from recon.guidance.upwind_proposal import (
    MOVE_UPWIND_SETTINGS,
    SPEED_MPS,
    MoveUpwindSettings,
    UpwindProposal,
)
from recon.link.outbox import Lane, lane_of
from recon.model.command import GoTo, Refusal
from recon.model.control import AuthorityHolder
from recon.model.units import seconds_to_ns
from recon.station.operations.imager_motion.claim import claimed, motion_under_way
from recon.station.operations.imager_motion.execution import (
    done,
    follow,
    held,
    is_refused,
    not_of_guidance,
    put,
    tried,
)
from recon.station.operations.move_upwind.search import search
from recon.station.state.imager_motion import MotionStage, MoveUpwind, UpwindMoves
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Stepped
from recon.station.state.survey_record import SurveyRecord

NOT_RUNNING = "its survey no longer runs"


def advance(
    station: Station, now_ns: int, settings: MoveUpwindSettings = MOVE_UPWIND_SETTINGS
) -> Stepped:
    """Advance the move under way, or search for a place and begin a move there if it is due."""
    current = station.upwind_moves.newest
    if current is not None and not current.is_over:
        return _go_on(station, current, settings, now_ns)
    records = station.surveys.records.values()
    allowing = [each for each in records if each.is_running and each.survey.upwind_allowed]
    station = _with_placed(_for_survey(station, allowing[0] if allowing else None, now_ns))
    if not allowing:
        return station, ()
    regions = [each.survey.region for each in allowing]
    station, job = search(station, regions, settings, now_ns)
    station, sent = _begin_if_due(station, allowing[0], settings, now_ns)
    return station, (*job, *sent)


def _go_on(
    station: Station, current: MoveUpwind, settings: MoveUpwindSettings, now_ns: int
) -> Stepped:
    ended = not_of_guidance(station, current, now_ns)
    if ended is not None:
        return ended, ()
    record = station.surveys.records.get(current.survey_id or 0)
    if record is None or not record.is_running:
        return held(station, current, NOT_RUNNING, now_ns)
    within_s = current.proposal.takes_s + settings.late_by_s
    return follow(station, current, within_s, done, now_ns)


def _for_survey(station: Station, record: SurveyRecord | None, now_ns: int) -> Station:
    """Return the station that searches for this survey, anew if it did not before."""
    moves = station.upwind_moves
    survey_id = None if record is None else record.survey.id
    if survey_id == moves.survey_id:
        return station
    moves = UpwindMoves(
        newest=moves.newest,
        due_ns=moves.due_ns,
        survey_id=survey_id,
        allowed_since_ns=now_ns,
        next_job_id=moves.next_job_id,
    )
    return replace(station, upwind_moves=moves)


def _begin_if_due(
    station: Station, record: SurveyRecord, settings: MoveUpwindSettings, now_ns: int
) -> Stepped:
    moves = station.upwind_moves
    found = moves.proposal
    if found is None or moves.better_since_ns is None:
        return replace(station, upwind_moves=moves.not_refused()), ()
    is_early = now_ns - moves.better_since_ns < seconds_to_ns(settings.better_for_s)
    if is_early or now_ns < moves.due_ns or motion_under_way(station) is not None:
        return station, ()
    every_s, again_s = settings.every_s, settings.refused_again_s
    if found.serial in moves.placed:
        moves = moves.after_try(None, again_s, again_s, now_ns)
        return replace(station, upwind_moves=moves), ()
    begun = _begin(station, record, found, now_ns)
    refusal = begun if isinstance(begun, Refusal) else None
    station, outputs = (station, ()) if isinstance(begun, Refusal) else begun
    moves = station.upwind_moves.after_try(refusal, every_s, again_s, now_ns)
    return replace(station, upwind_moves=moves), outputs


def _begin(
    station: Station, record: SurveyRecord, found: UpwindProposal, now_ns: int
) -> Stepped | Refusal:
    """Return the station with a move begun, or why the imaging drone or the gate refuses it."""
    by = record.issuer
    drone = claimed(station, MoveUpwind.rule, found.serial, by, record.person, now_ns)
    if isinstance(drone, Refusal):
        return drone
    height_m = drone.height_above_takeoff_m
    body = GoTo(found.place, height_m, SPEED_MPS, found.yaw_deg)
    station, outputs, order = tried(drone.station, MoveUpwind, by, found.serial, body, now_ns)
    if is_refused(order):
        assert order.refusal is not None, "a refused order has its refusal"
        return order.refusal
    motion = MoveUpwind(
        serial=found.serial,
        name=drone.vehicle.display_name,
        by=by,
        begun_at_ns=now_ns,
        place=found.place,
        height_above_takeoff_m=height_m,
        command_id=order.command.id,
        stage=MotionStage.UPWIND,
        since_ns=now_ns,
        survey_id=record.survey.id,
        proposal=found,
    )
    # After the move the search begins anew, from there.
    moves = replace(station.upwind_moves, proposal=None, better_since_ns=None, asked_at_ns=None)
    station = put(replace(station, upwind_moves=replace(moves, job_id=None)), motion)
    return station, (*drone.outputs, *outputs)


def _with_placed(station: Station) -> Station:
    """Note the imaging drones of which a person has decided where they hover, since the survey was
    started: orders are forgotten sooner than a survey ends."""
    moves = station.upwind_moves
    newest, since_ns = moves.newest, moves.allowed_since_ns
    is_stopped = newest is not None and newest.stage is MotionStage.STOPPED
    placed = {newest.serial} if newest and is_stopped and newest.since_ns >= since_ns else set()
    persons = [each.command for each in station.orders.records.values() if _is_a_persons(each)]
    placed |= {
        serial
        for serial in station.imaging.imagers
        if any(each.serial == serial and each.issued_at_ns >= since_ns for each in persons)
    }
    if placed <= moves.placed:
        return station
    return replace(station, upwind_moves=replace(moves, placed=moves.placed | placed))


def _is_a_persons(record: OrderRecord) -> bool:
    """Whether a person moved or stopped a vehicle by an order that was not refused."""
    command = record.command
    if command.role is not AuthorityHolder.OPERATOR or lane_of(command) is Lane.CAMERA:
        return False
    return not is_refused(record) and not command.is_own
