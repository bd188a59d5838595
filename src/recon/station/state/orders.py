"""The record of every order and the transitions of its phase (theory: `control/order_timeouts`).

An order ends in exactly one final phase. Later telemetry adds a note and may end the alarm; it
never changes that phase.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import islice

from recon.fleet.confirmation import Progress, SentContext
from recon.model.command import (
    Body,
    Command,
    FlyMission,
    Hover,
    LandNow,
    Phase,
    Refusal,
    ReturnHome,
    VirtualStick,
)
from recon.model.control import ControlAuthority
from recon.model.event import CommandAnswered, CommandDropped, CommandSent
from recon.model.mission import Mission
from recon.model.units import seconds_to_ns

UNCONFIRMED = "order_not_confirmed"
MISSION_IGNORED = "mission_ignored"
MISSION_BROKEN_OFF = "mission_broken_off"
LANDING_STOPPED = "landing_stopped"


@dataclass(frozen=True, slots=True)
class PhaseChange:
    """One change of phase, or a note within a phase."""

    phase: Phase
    at_ns: int
    note: str


@dataclass(frozen=True, slots=True)
class FlightPlan:
    """A mission as it is sent: one part, or several flown one after the other.

    A next part is only sent while the chain is whole: `link_id` is the link the order went to,
    `authority` the vehicle's authority then, and `telemetry_at_ns` the time of its last telemetry.
    `broken` is why no further part will be flown.
    """

    parts: tuple[Mission, ...]
    repairs: tuple[str, ...] = ()
    index: int = 0
    """Index of the part sent last."""
    link_id: int | None = None
    authority: ControlAuthority | None = None
    telemetry_at_ns: int | None = None
    broken: str | None = None

    @property
    def part(self) -> Mission:
        """The part sent last."""
        return self.parts[self.index]

    @property
    def is_last(self) -> bool:
        """Whether no part follows the present one."""
        return self.index + 1 >= len(self.parts)

    @property
    def label(self) -> str:
        """The present part as in `part 2 of 3`; "" for a mission of one."""
        return "" if len(self.parts) == 1 else f"part {self.index + 1} of {len(self.parts)}"


@dataclass(frozen=True, slots=True)
class OrderRecord:
    """One order and its phases so far.

    `next_repeat_ns`: when an emergency order is sent again if nothing has ended that. `alarm` is
    the rule of the alarm it raises, until telemetry shows it carried out or a newer order comes.
    """

    command: Command
    vehicle_name: str
    history: tuple[PhaseChange, ...]
    altitudes: str | None = None
    sent: SentContext | None = None
    """What was known at the first sending; of a mission in parts, at that of the present part."""
    times_sent: int = 0
    next_repeat_ns: int | None = None
    repeats_left: int = 0
    waits_for_telemetry: bool = False
    """A stop refused because telemetry is stale, judged again at each packet of its vehicle; or one
    sent without it, and sent again when telemetry returns and does not show it obeyed."""
    follows: int | None = None
    """For a stop: the order to take off that it follows (`control/takeoff_stops`)."""
    waiting_link_ids: tuple[int, ...] = ()
    """Links whose queue may still have it: dropped by one, it can yet be sent by another."""
    is_refused_by_app: bool = False
    """An app has refused an emergency order that is still repeated."""
    alarm: str | None = None
    plan: FlightPlan | None = None
    """For a mission: its parts, and which one is flown."""
    refusal: Refusal | None = None
    """The gate's refusal that ended it: of the order when given or when sent, of a mission's later
    part, or of a setpoint."""

    @property
    def phase(self) -> Phase:
        """Where it is now."""
        return self.history[-1].phase

    @property
    def note(self) -> str:
        """The note of the latest change."""
        return self.history[-1].note

    @property
    def left_at_ns(self) -> int | None:
        """When it was last sent, of a steered one its first stick; None: not yet."""
        left = (each.at_ns for each in reversed(self.history) if each.phase is Phase.SENT)
        return next(left, None)

    @property
    def is_withdrawn(self) -> bool:
        """Whether it has ended unsent, and waits in no queue."""
        return self.phase.is_final and self.times_sent == 0 and not self.waiting_link_ids

    @property
    def is_tracked(self) -> bool:
        """Whether time and telemetry still change it: it is open, or its alarm is."""
        return not self.phase.is_final or self.alarm is not None


@dataclass(frozen=True, slots=True)
class OrderBook:
    """The recent orders.

    `tracked` are those that time and telemetry still change: alive, or with an alarm. `put` keeps
    it up to date, because it is read with every packet.
    """

    records: Mapping[int, OrderRecord] = field(default_factory=dict)
    tracked: tuple[OrderRecord, ...] = ()


def interrupted_mission(book: OrderBook, serial: str) -> OrderRecord | None:
    """Return a vehicle's newest order to move, if it is a mission that was sent and ended early."""
    for record in reversed(tuple(book.records.values())):
        if record.command.serial != serial or not record.command.moves:
            continue
        is_early = record.phase in (Phase.SUPERSEDED, Phase.FAILED, Phase.TIMED_OUT)
        is_mission = isinstance(record.command.body, FlyMission)
        return record if is_mission and is_early and record.times_sent else None
    return None


def changed(record: OrderRecord, phase: Phase, at_ns: int, note: str = "") -> OrderRecord:
    """Return the record after a change of phase. A final phase stays: then it is a note only."""
    kept = record.phase if record.phase.is_final else phase
    record = replace(record, history=(*record.history, PhaseChange(kept, at_ns, note)))
    return replace(record, next_repeat_ns=None, repeats_left=0) if kept.is_final else record


def noted(record: OrderRecord, at_ns: int, note: str) -> OrderRecord:
    """Return the record with a note that changes no phase."""
    return changed(record, record.phase, at_ns, note)


def ended(
    record: OrderRecord, phase: Phase, at_ns: int, note: str = "", *, alarm: str | None = None
) -> OrderRecord:
    """Return the record at its end; with an alarm if an operator must act."""
    return replace(changed(record, phase, at_ns, note), alarm=alarm)


def underway(record: OrderRecord, phase: Phase, at_ns: int, note: str) -> OrderRecord:
    """Return a record that telemetry shows carried out; repeats and its alarm end."""
    shown = changed(record, phase, at_ns, note)
    return replace(shown, next_repeat_ns=None, repeats_left=0, alarm=None)


def unsent(record: OrderRecord, phase: Phase, at_ns: int, note: str) -> OrderRecord:
    """Return a record that never left. For an emergency order, or a later part of a mission, that
    is an alarm until a newer order takes its place."""
    return ended(record, phase, at_ns, _of_part(record, note), alarm=_alarm_when_lost(record))


def shown(record: OrderRecord, seen: Progress, at_ns: int) -> OrderRecord:
    """Return the record after what telemetry shows of it.

    An order that has ended shows a word beside its end, and the end of its alarm.
    """
    if seen < Progress.CONFIRMED:
        return record
    body = record.command.body
    begins, text = _BEGINNINGS.get(type(body), (Phase.CONFIRMED, "confirmed by telemetry"))
    text = _of_part(record, text)
    if record.phase.is_final:
        late = noted(record, at_ns, f"{text}, after its time")
        return record if record.alarm is None else replace(late, alarm=None)
    is_complete = seen is Progress.COMPLETE
    if record.phase is not begins and not (is_complete and _is_shown_by_its_end(body)):
        record = underway(record, begins, at_ns, text)
    return ended(record, Phase.DONE, at_ns, _end_text(body)) if is_complete else record


_BEGINNINGS: dict[type, tuple[Phase, str]] = {
    FlyMission: (Phase.STARTED, "telemetry shows the mission flying"),
    LandNow: (Phase.CONFIRMED, "telemetry shows it landing"),
    ReturnHome: (Phase.CONFIRMED, "telemetry shows it flying home"),
    Hover: (Phase.CONFIRMED, "telemetry shows it hovering"),
}


def _of_part(record: OrderRecord, text: str) -> str:
    """Return the text, after the present part of a mission in parts."""
    label = "" if record.plan is None else record.plan.label
    return f"{label}: {text}" if label else text


def _alarm_when_lost(record: OrderRecord) -> str | None:
    """The alarm of an order that did not get through: a stop, or a mission's later part."""
    if record.command.is_emergency:
        return UNCONFIRMED
    is_later_part = record.plan is not None and record.plan.index > 0
    return MISSION_BROKEN_OFF if is_later_part else None


def _is_shown_by_its_end(body: Body) -> bool:
    """Whether nothing is to be seen between the sending and the end: the camera's orders, and a
    landing or return that is on the ground at once."""
    return not isinstance(body, (Hover, VirtualStick))


def _end_text(body: Body) -> str:
    return "telemetry shows it on the ground" if isinstance(body, (LandNow, ReturnHome)) else ""


def stick_over(record: OrderRecord, at_ns: int) -> OrderRecord:
    """Return the record of a stick, done when the time it is held for is over."""
    body, sent = record.command.body, record.sent
    if not isinstance(body, VirtualStick) or record.phase is not Phase.CONFIRMED or sent is None:
        return record
    is_over = at_ns - sent.sent_at_ns >= seconds_to_ns(body.timeout_s)
    return ended(record, Phase.DONE, at_ns, "hold time over") if is_over else record


def timed_out(record: OrderRecord, at_ns: int, limit_s: float) -> OrderRecord:
    """Return a record that telemetry has not shown in time: an alarm, for what moves a vehicle."""
    if record.is_refused_by_app:
        return ended(
            record,
            Phase.REFUSED_BY_APP,
            at_ns,
            "the app refused it, and telemetry shows no effect",
            alarm=UNCONFIRMED,
        )
    note = _of_part(record, f"telemetry has not confirmed it within {limit_s:g} s")
    alarm = MISSION_IGNORED if isinstance(record.command.body, FlyMission) else None
    if record.command.is_emergency or isinstance(record.command.body, VirtualStick):
        alarm = UNCONFIRMED
    return ended(record, Phase.TIMED_OUT, at_ns, note, alarm=alarm)


def put(book: OrderBook, record: OrderRecord, kept: int) -> OrderBook:
    """Return the book with a record in it; the oldest other finished ones are forgotten."""
    newest_id = record.command.id
    records = {**book.records, newest_id: record}
    if len(records) > kept:
        finished = (key for key, r in records.items() if not r.is_tracked and key != newest_id)
        for key in tuple(islice(finished, len(records) - kept)):
            del records[key]
    return OrderBook(records, _tracked(book.tracked, record))


def _tracked(before: tuple[OrderRecord, ...], newest: OrderRecord) -> tuple[OrderRecord, ...]:
    """Return the tracked records with one replaced, in their order."""
    newest_id = newest.command.id
    if all(record.command.id != newest_id for record in before):
        return (*before, newest) if newest.is_tracked else before
    changed_ones = (newest if r.command.id == newest_id else r for r in before)
    return tuple(record for record in changed_ones if record.is_tracked)


def on_sent(record: OrderRecord, event: CommandSent, context: SentContext) -> OrderRecord:
    """The packet is on its way; the first time counts for what telemetry must be newer than."""
    record = no_longer_waiting(record, event.link_id)
    again = replace(record, times_sent=record.times_sent + 1)
    if record.sent is not None:
        return noted(again, context.sent_at_ns, f"sent again, on link {event.link_id}")
    if record.phase.is_final:
        return replace(again, sent=context)
    return changed(replace(again, sent=context), Phase.SENT, context.sent_at_ns)


def on_answered(record: OrderRecord, event: CommandAnswered, now_ns: int) -> OrderRecord:
    """The app answered, or its answer missed its time. Neither confirms anything.

    The refusal of an emergency order is an alarm at once, and its end only when no repeat of it
    has had an effect in time.
    """
    if record.phase not in (Phase.SENT, Phase.ACKNOWLEDGED):
        return record
    if event.positive is None:
        return noted(record, now_ns, "the app has not acknowledged it in time")
    if event.positive:
        is_known = record.phase is Phase.ACKNOWLEDGED
        return record if is_known else changed(record, Phase.ACKNOWLEDGED, now_ns)
    if not record.command.is_emergency:
        note, alarm = _of_part(record, "the app refused it"), _alarm_when_lost(record)
        return ended(record, Phase.REFUSED_BY_APP, now_ns, note, alarm=alarm)
    refused = noted(record, now_ns, "the app refused it")
    return replace(refused, is_refused_by_app=True, alarm=UNCONFIRMED)


def on_dropped(record: OrderRecord, event: CommandDropped, now_ns: int) -> OrderRecord:
    """Return an order that left a queue unsent: ended only if no other link has or can send it."""
    record = no_longer_waiting(record, event.link_id)
    if event.phase is Phase.REFUSED_BY_STATION and record.next_repeat_ns is not None:
        return record
    if record.phase is not Phase.QUEUED or record.waiting_link_ids:
        return record
    record = replace(record, refusal=event.refusal or record.refusal)
    return unsent(record, event.phase, now_ns, event.reason)


def no_longer_waiting(record: OrderRecord, link_id: int) -> OrderRecord:
    """Return the record without the link whose queue it has left."""
    waiting = tuple(other for other in record.waiting_link_ids if other != link_id)
    return replace(record, waiting_link_ids=waiting)
