"""The move upwind: an imaging drone flies by one goto to where it sees more of the coming shade.

While a survey that allows it runs, a place is proposed every ten seconds (`upwind_search`). A move
begins once a place is better by a clear margin for half a minute, for the person who started the
survey, and at most once in three minutes; a refused one is tried again after a minute.

    upwind --arrived--> done
    upwind --the survey no longer runs, or what ends any motion--> stopped

A person's order to the imaging drone, and a stopped move, are that person's decision where it
hovers: it does not move automatically again until the survey has been paused and started again.
"""

from collections.abc import Iterator, Mapping
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
from recon.station.operations.imager_motion import notices
from recon.station.operations.imager_motion.claim import claimed
from recon.station.operations.imager_motion.execution import (
    after_automatic_begin,
    begin_with,
    done,
    follow,
    go_on,
    held,
    is_refused,
    not_refused,
)
from recon.station.operations.imager_motion.upwind_search import search, with_search
from recon.station.operations.operation import Operation
from recon.station.state.alarm_book import Condition
from recon.station.state.imager_motion import MotionStage, MoveUpwind, UpwindSearch
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.steps import Stepped
from recon.station.state.survey_record import SurveyRecord

NOT_RUNNING = "its survey no longer runs"
STAYS = "It stays there until it is sent elsewhere, or its survey is paused and started again"


def advance(
    station: Station, now_ns: int, settings: MoveUpwindSettings = MOVE_UPWIND_SETTINGS
) -> Stepped:
    """Advance the move under way, or search for a place and begin a move there if it is due."""

    def advanced(station: Station, current: MoveUpwind, now_ns: int) -> Stepped:
        record = station.surveys.records.get(current.survey_id or 0)
        if record is None or not record.is_running:
            return held(station, current, NOT_RUNNING, now_ns)
        within_s = current.proposal.takes_s + settings.late_by_s
        return follow(station, current, within_s, done, now_ns)

    went_on = go_on(station, MoveUpwind, advanced, now_ns)
    return _search_and_begin(station, settings, now_ns) if went_on is None else went_on


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know: a motion without an order of now, and where it ended.

    Where it hovers after its survey matters to nothing that runs.
    """
    motions = station.imager_motions
    newest, found = motions.of(MoveUpwind), motions.upwind.proposal
    if newest is not None:
        text = f"moves upwind for its survey: {newest.proposal.sentence}"
        yield from notices.automatic_motion(station, newest, text)
    if motions.upwind.survey_id is not None:
        yield from notices.off_its_place(station, newest, STAYS)
    if found is not None:
        text = f"the imaging drone {found.sentence}, and cannot fly there"
        yield from notices.cannot_begin(station, MoveUpwind, found.serial, text)


def _described(motion: MoveUpwind) -> tuple[str, Mapping[str, float]]:
    found = motion.proposal
    details = {"distance_m": found.distance_m, "gain": found.gain}
    return f"move upwind ({found.sentence})", details


def _search_and_begin(station: Station, settings: MoveUpwindSettings, now_ns: int) -> Stepped:
    records = station.surveys.records.values()
    allowing = [each for each in records if each.is_running and each.survey.upwind_allowed]
    station = _with_placed(_for_survey(station, allowing[0] if allowing else None, now_ns))
    if not allowing:
        return station, ()
    regions = [each.survey.region for each in allowing]
    station, job = search(station, regions, settings, now_ns)
    station, sent = _begin_if_due(station, allowing[0], settings, now_ns)
    return station, (*job, *sent)


def _for_survey(station: Station, record: SurveyRecord | None, now_ns: int) -> Station:
    """Return the station that searches for this survey, anew if it did not before."""
    before = station.imager_motions.upwind
    survey_id = None if record is None else record.survey.id
    if survey_id == before.survey_id:
        return station
    anew = UpwindSearch(survey_id, allowed_since_ns=now_ns, next_job_id=before.next_job_id)
    return with_search(not_refused(station, MoveUpwind), anew)


def _begin_if_due(
    station: Station, record: SurveyRecord, settings: MoveUpwindSettings, now_ns: int
) -> Stepped:
    motions = station.imager_motions
    found, better_since_ns = motions.upwind.proposal, motions.upwind.better_since_ns
    if found is None or better_since_ns is None:
        return not_refused(station, MoveUpwind), ()
    is_early = now_ns - better_since_ns < seconds_to_ns(settings.better_for_s)
    is_early = is_early or now_ns < motions.start(MoveUpwind).due_ns
    if is_early or motions.under_way() is not None:
        return station, ()
    every_s, again_s = settings.every_s, settings.refused_again_s
    if found.serial in motions.upwind.placed:
        stays: Stepped = (station, ())
        return after_automatic_begin(station, MoveUpwind, stays, again_s, again_s, now_ns)
    begun = _begin(station, record, found, now_ns)
    return after_automatic_begin(station, MoveUpwind, begun, every_s, again_s, now_ns)


def _begin(
    station: Station, record: SurveyRecord, found: UpwindProposal, now_ns: int
) -> Stepped | Refusal:
    """Return the station with a move begun, or why the imaging drone or the gate refuses it."""
    by = record.issuer
    drone = claimed(station, MoveUpwind.rule, found.serial, by, record.person, now_ns)
    if isinstance(drone, Refusal):
        return drone
    height_m = drone.height_above_takeoff_m
    motion = MoveUpwind(
        serial=found.serial,
        name=drone.vehicle.display_name,
        by=by,
        begun_at_ns=now_ns,
        place=found.place,
        height_above_takeoff_m=height_m,
        stage=MotionStage.UPWIND,
        since_ns=now_ns,
        survey_id=record.survey.id,
        proposal=found,
    )
    body = GoTo(found.place, height_m, SPEED_MPS, found.yaw_deg)
    # After the move the search begins anew, from there.
    before = station.imager_motions.upwind
    anew = replace(before, proposal=None, better_since_ns=None, asked_at_ns=None, job_id=None)
    return begin_with(
        replace(drone, station=with_search(drone.station, anew)), motion, body, now_ns
    )


def _with_placed(station: Station) -> Station:
    """Note the imaging drones of which a person has decided where they hover, since the survey was
    started: orders are forgotten sooner than a survey ends."""
    newest, upwind = station.imager_motions.of(MoveUpwind), station.imager_motions.upwind
    since_ns = upwind.allowed_since_ns
    is_stopped = newest is not None and newest.stage is MotionStage.STOPPED
    placed = {newest.serial} if newest and is_stopped and newest.since_ns >= since_ns else set()
    persons = [each.command for each in station.orders.records.values() if _is_a_persons(each)]
    placed |= {
        serial
        for serial in station.imaging.imagers
        if any(each.serial == serial and each.issued_at_ns >= since_ns for each in persons)
    }
    if placed <= upwind.placed:
        return station
    return with_search(station, replace(upwind, placed=upwind.placed | placed))


def _is_a_persons(record: OrderRecord) -> bool:
    """Whether a person moved or stopped a vehicle by an order that was not refused."""
    command = record.command
    if command.role is not AuthorityHolder.OPERATOR or lane_of(command) is Lane.CAMERA:
        return False
    return not is_refused(record) and not command.is_own


MOVE_UPWIND = Operation(
    name="move upwind",
    tick=advance,
    conditions=conditions,
    audit=notices.audit_of(MoveUpwind, _described),
)
