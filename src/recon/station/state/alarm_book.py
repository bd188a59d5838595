"""Alarms: each names its vehicle and stays until its cause has ended and it is acknowledged."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from recon.model.severity import Severity
from recon.model.units import seconds_to_ns


@dataclass(frozen=True, slots=True)
class Condition:
    """A fact that holds now, and an alarm after `after_s`. The same `key` is the same cause."""

    key: str
    severity: Severity
    rule: str
    vehicle_name: str
    text: str
    serial: str | None = None
    link_id: int | None = None
    after_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Alarm:
    """A condition that was raised."""

    id: int
    condition: Condition
    raised_at_ns: int
    is_active: bool = True
    acknowledged_by: str | None = None


@dataclass(frozen=True, slots=True)
class AlarmBook:
    """All alarms that are active or not yet acknowledged."""

    alarms: Mapping[int, Alarm] = field(default_factory=dict)
    since_ns: Mapping[str, int] = field(default_factory=dict)
    """Start of each present condition, by key."""
    next_id: int = 1


def update(book: AlarmBook, conditions: Iterable[Condition], now_ns: int, kept: int) -> AlarmBook:
    """Return the book after the conditions that hold now: alarms begin, change text, and end."""
    present = {condition.key: condition for condition in conditions}
    since_ns = {key: book.since_ns.get(key, now_ns) for key in present}
    ripe = {
        key: condition
        for key, condition in present.items()
        if now_ns - since_ns[key] >= seconds_to_ns(condition.after_s)
    }
    alarms = {alarm.id: _continued(alarm, ripe) for alarm in book.alarms.values()}
    active = {alarm.condition.key for alarm in alarms.values() if alarm.is_active}
    next_id = book.next_id
    for key, condition in ripe.items():
        if key not in active:
            alarms[next_id] = Alarm(next_id, condition, now_ns)
            next_id += 1
    return AlarmBook(_bounded(alarms, kept), since_ns, next_id)


def _continued(alarm: Alarm, ripe: Mapping[str, Condition]) -> Alarm:
    """Return the alarm with its condition as it is now. One not acknowledged becomes active again;
    one whose severity rose must be acknowledged again."""
    condition = ripe.get(alarm.condition.key)
    if condition is None:
        return replace(alarm, is_active=False)
    is_worse = condition.severity.is_worse_than(alarm.condition.severity)
    seen_by = None if is_worse else alarm.acknowledged_by
    return replace(alarm, condition=condition, is_active=True, acknowledged_by=seen_by)


def note(book: AlarmBook, condition: Condition, now_ns: int, kept: int) -> AlarmBook:
    """Return the book with an event without a duration; it stays until acknowledged.

    The same cause is not raised twice before that.
    """
    if any(a.condition.key == condition.key for a in book.alarms.values()):
        return book
    alarm = Alarm(book.next_id, condition, now_ns, is_active=False)
    alarms = _bounded({**book.alarms, alarm.id: alarm}, kept)
    return replace(book, alarms=alarms, next_id=book.next_id + 1)


def acknowledge(book: AlarmBook, alarm_id: int, by: str) -> AlarmBook:
    """Return the book after an operator acknowledged an alarm; an ended one is removed."""
    alarm = book.alarms.get(alarm_id)
    if alarm is None:
        return book
    seen = {**book.alarms, alarm_id: replace(alarm, acknowledged_by=by)}
    return replace(book, alarms=_bounded(seen, len(seen)))


def _bounded(alarms: dict[int, Alarm], kept: int) -> dict[int, Alarm]:
    """Remove ended and acknowledged alarms; beyond the limit, ended ones too: the least severe and
    then the oldest first, so that frequent messages never displace a severe alarm."""
    open_alarms = {
        key: alarm
        for key, alarm in alarms.items()
        if alarm.is_active or alarm.acknowledged_by is None
    }
    ended = sorted(
        (key for key, alarm in open_alarms.items() if not alarm.is_active),
        key=lambda key: (-open_alarms[key].condition.severity.rank, key),
    )
    for key in ended[: max(0, len(open_alarms) - kept)]:
        del open_alarms[key]
    return open_alarms
