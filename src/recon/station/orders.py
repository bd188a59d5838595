"""The life of every order: queued, sent, answered, confirmed by telemetry, or not."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from recon.fleet.confirmation import SentContext
from recon.model.command import Command, Phase
from recon.model.event import CommandAnswered, CommandDropped, CommandSent


@dataclass(frozen=True, slots=True)
class PhaseChange:
    """One step of a life."""

    phase: Phase
    at_ns: int
    note: str


@dataclass(frozen=True, slots=True)
class OrderRecord:
    """One order and what has become of it.

    `is_watched`: telemetry can still confirm it. `next_repeat_ns`: when an emergency order is sent
    again if nothing has ended that.
    """

    command: Command
    vehicle_name: str
    history: tuple[PhaseChange, ...]
    altitudes: str | None = None
    sent: SentContext | None = None
    times_sent: int = 0
    is_watched: bool = True
    next_repeat_ns: int | None = None
    repeats_left: int = 0
    waits_to_be_heard: bool = False
    """A stop for a vehicle that cannot be heard: judged anew with every word of it."""
    waiting_link_ids: tuple[int, ...] = ()
    """Links whose queue it may still stand in: dropped by one, it can yet be sent by another."""

    @property
    def phase(self) -> Phase:
        """Where it is now."""
        return self.history[-1].phase

    @property
    def note(self) -> str:
        """The latest word on it."""
        return self.history[-1].note

    @property
    def is_unsure(self) -> bool:
        """Whether nothing has confirmed an order, sent or stuck unsent: a person must look."""
        return self.is_watched and self.phase in UNSURE_PHASES


UNSURE_PHASES = (Phase.TIMED_OUT, Phase.REFUSED_BY_APP, Phase.EXPIRED, Phase.FAILED)


@dataclass(frozen=True, slots=True)
class OrderBook:
    """All orders lately given; `watched` are those that time and telemetry still change."""

    records: Mapping[int, OrderRecord] = field(default_factory=dict)

    @property
    def watched(self) -> tuple[OrderRecord, ...]:
        """The orders still alive."""
        return tuple(record for record in self.records.values() if record.is_watched)


def changed(
    record: OrderRecord, phase: Phase, at_ns: int, note: str = "", *, is_watched: bool = True
) -> OrderRecord:
    """Return the record after a change of phase."""
    history = (*record.history, PhaseChange(phase, at_ns, note))
    record = replace(record, history=history, is_watched=is_watched)
    return record if is_watched else replace(record, next_repeat_ns=None, repeats_left=0)


def underway(record: OrderRecord, at_ns: int, note: str) -> OrderRecord:
    """Return a confirmed record whose end telemetry still has to show; repeats end."""
    confirmed = changed(record, Phase.CONFIRMED, at_ns, note)
    return replace(confirmed, next_repeat_ns=None, repeats_left=0)


def unsent(record: OrderRecord, phase: Phase, at_ns: int, note: str) -> OrderRecord:
    """Return a record that never left. For an emergency order that is an alarm: it stays watched,
    until a newer order takes its place."""
    kept = changed(record, phase, at_ns, note, is_watched=record.command.is_emergency)
    return replace(kept, next_repeat_ns=None, repeats_left=0)


def put(book: OrderBook, record: OrderRecord, kept: int) -> OrderBook:
    """Return the book with a record in it; the oldest other finished ones are forgotten."""
    newest_id = record.command.id
    records = {**book.records, newest_id: record}
    if len(records) > kept:
        finished = [key for key, r in records.items() if not r.is_watched and key != newest_id]
        for key in finished[: len(records) - kept]:
            del records[key]
    return OrderBook(records)


def on_sent(record: OrderRecord, event: CommandSent, context: SentContext) -> OrderRecord:
    """The packet is on its way; the first time counts for what telemetry must be newer than."""
    record = _no_longer_waiting(record, event.link_id)
    again = replace(record, times_sent=record.times_sent + 1)
    if record.sent is not None:
        note = f"sent again, on link {event.link_id}"
        change = PhaseChange(record.phase, context.sent_at_ns, note)
        return replace(again, history=(*record.history, change))
    if not record.is_watched:
        return again
    return changed(replace(again, sent=context), Phase.SENT, context.sent_at_ns)


def on_answered(record: OrderRecord, event: CommandAnswered, now_ns: int) -> OrderRecord:
    """The app answered, or its answer missed its time. Neither confirms anything."""
    if record.phase not in (Phase.SENT, Phase.ACKNOWLEDGED):
        return record
    if event.positive is None:
        return changed(record, record.phase, now_ns, "the app has not acknowledged it in time")
    if event.positive:
        return (
            record
            if record.phase is Phase.ACKNOWLEDGED
            else changed(record, Phase.ACKNOWLEDGED, now_ns)
        )
    note = "the app refused it"
    return changed(
        record, Phase.REFUSED_BY_APP, now_ns, note, is_watched=record.command.is_emergency
    )


def on_dropped(record: OrderRecord, event: CommandDropped, now_ns: int) -> OrderRecord:
    """It left a queue unsent. That ends it only when no other link can send it, nor has."""
    record = _no_longer_waiting(record, event.link_id)
    if record.phase is not Phase.QUEUED or record.waiting_link_ids:
        return record
    return unsent(record, event.phase, now_ns, event.reason)


def _no_longer_waiting(record: OrderRecord, link_id: int) -> OrderRecord:
    waiting = tuple(other for other in record.waiting_link_ids if other != link_id)
    return replace(record, waiting_link_ids=waiting)
