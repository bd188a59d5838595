"""Missions of a survey that were not sent, and are requested again if the reason may pass.

Theory of operation. A mission is judged when it is ordered and, if it had to wait, at the moment of
sending. Telemetry may be late then for a moment, the link may just have closed, other vehicles may
be nearer than a second ago. The vehicle has not moved for such a mission, so:

- The mission goes back to the planner, which requests the next one after `retry_soon_s`. Meanwhile
  the survey's view states the reason. A permission to take off that was not used is kept.
- After `SurveyTimes.unsent_within_s` of such reasons without a mission sent, the vehicle is stopped
  with the last one, until an operator starts it again. The time ends with a mission that is sent,
  and while the vehicle could fly and the planner wants nothing of it.
- Any other refusal, and every mission that was sent, is handled as before: see `execution`.
"""

from dataclasses import replace

from recon.guidance.survey import refused
from recon.model.command import Phase, Refusal
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.safety.rules.link_age import RULE as LINK_AGE
from recon.safety.rules.separation import RULE as SEPARATION
from recon.station.operations.settings import SURVEY_TIMES
from recon.station.state.orders import OrderRecord
from recon.station.state.survey_record import SurveyMember, SurveyRecord

ASKS_AGAIN = "; it is asked for again every few seconds"

_NEVER_LEFT = (Phase.EXPIRED, Phase.FAILED)
"""Ends of an unsent order: too long in the queue, or the link closed. An order that a newer one has
superseded is not requested again."""


def may_end(refusal: Refusal) -> bool:
    """Return whether time ends a refusal: telemetry is late, or the connection is lost."""
    return refusal.is_stale or refusal.rule == LINK_AGE


def may_be_sent_later(order: OrderRecord) -> bool:
    """Return whether a mission was never sent, for a reason that time may end.

    Another vehicle in its way counts: the gate found none a moment before.
    """
    if not order.is_withdrawn:
        return False
    if order.phase is not Phase.REFUSED_BY_STATION:
        return order.phase in _NEVER_LEFT
    refusal = order.refusal
    return refusal is not None and (may_end(refusal) or refusal.rule == SEPARATION)


def given_back(
    record: SurveyRecord, member: SurveyMember, order: OrderRecord, now_ns: int
) -> SurveyRecord:
    """Return the survey with a mission that was approved, and not sent, back at its planner."""
    kept = replace(member, command_id=None, may_take_off=order.command.takeoff)
    return asked_again(record, kept, member.number, order.note, now_ns)


def asked_again(
    record: SurveyRecord, member: SurveyMember, number: int, reason: str, now_ns: int
) -> SurveyRecord:
    """Return the survey with a mission to be requested again for a vehicle, and since when."""
    since_ns = now_ns if member.unsent_since_ns is None else member.unsent_since_ns
    record = record.put(replace(member, unsent_since_ns=since_ns))
    if record.state is None:
        return record
    why = f"{reason}{ASKS_AGAIN}"
    state = refused(record.state, member.serial, number, why, now_ns, may_end=True)
    return replace(record, state=state)


def stopped_if_overdue(
    record: SurveyRecord, member: SurveyMember, could_fly: bool, now_ns: int
) -> SurveyMember:
    """Return the vehicle, stopped if no mission could be sent to it for too long.

    If it `could_fly` and its planner asks for nothing, as when it waits for sun, that time ends.
    """
    since_ns, state = member.unsent_since_ns, record.state
    if since_ns is None or state is None or member.stop_reason is not None:
        return member
    last = state.refusals.get(member.serial)
    asked_until_ns = since_ns if last is None else last.again_ns
    if could_fly and now_ns > asked_until_ns + seconds_to_ns(SURVEY_TIMES.asked_again_within_s):
        return replace(member, unsent_since_ns=None)
    waited_s = ns_to_seconds(now_ns - since_ns)
    if waited_s < SURVEY_TIMES.unsent_within_s:
        return member
    why = "" if last is None else f": {last.reason.removesuffix(ASKS_AGAIN)}"
    text = f"no mission could be sent to it for {waited_s:.0f} s{why}"
    return replace(member, stop_reason=text, unsent_since_ns=None)
