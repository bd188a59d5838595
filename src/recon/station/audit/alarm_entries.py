"""Alarms in the audit: raised, worse, acknowledged, ended.

An alarm that begins and ends many times a second is written every five seconds at most; a rise in
severity or an acknowledgment is written at once.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.model.units import seconds_to_ns
from recon.record.audit.audit import AuditEntry
from recon.station.state.alarm_book import Alarm, AlarmBook

AGAIN_AFTER_S = 5.0


@dataclass(frozen=True, slots=True)
class AlarmLogged:
    """An alarm as last written."""

    alarm: Alarm
    at_ns: int


@dataclass(frozen=True, slots=True)
class AlarmsLogged:
    """All alarms as last written, by id."""

    written: Mapping[int, AlarmLogged] = field(default_factory=dict)


def alarm_entries(
    memory: AlarmsLogged, book: AlarmBook, now_ns: int
) -> tuple[AlarmsLogged, tuple[AuditEntry, ...]]:
    """Return the changes of the alarms since they were last written."""
    entries: list[AuditEntry] = []
    written = dict(memory.written)
    for number, alarm in book.alarms.items():
        new = _change(written.get(number), alarm, now_ns)
        if new is not None:
            entries.append(new)
            written[number] = AlarmLogged(alarm, now_ns)
    for number in memory.written.keys() - book.alarms.keys():
        entries += _forgotten(written.pop(number).alarm)
    return (AlarmsLogged(written), tuple(entries)) if entries else (memory, ())


def acknowledged_entry(alarm: Alarm, by: str) -> AuditEntry:
    """Return the entry of an acknowledged alarm."""
    return _entry("alarm.acknowledged", "alarm acknowledged", alarm, by)


def _change(last: AlarmLogged | None, alarm: Alarm, now_ns: int) -> AuditEntry | None:
    if last is None:
        return _entry("alarm.raised", "alarm", alarm)
    was = last.alarm
    if alarm.condition.severity.is_worse_than(was.condition.severity):
        return _entry("alarm.worse", "alarm is worse", alarm)
    if alarm.is_active is was.is_active or now_ns - last.at_ns < seconds_to_ns(AGAIN_AFTER_S):
        return None
    if alarm.is_active:
        return _entry("alarm.raised", "alarm again", alarm)
    return _entry("alarm.ended", "alarm ended", alarm)


def _forgotten(alarm: Alarm) -> list[AuditEntry]:
    """An alarm leaves the book when it is acknowledged and has ended."""
    return [_entry("alarm.ended", "alarm ended", alarm)] if alarm.is_active else []


def _entry(kind: str, word: str, alarm: Alarm, by: str = "station") -> AuditEntry:
    condition = alarm.condition
    details = {
        "id": alarm.id,
        "rule": condition.rule,
        "severity": condition.severity.value,
        "is_active": alarm.is_active,
    }
    if condition.link_id is not None:
        details["link_id"] = condition.link_id
    text = f"{word}: {condition.text}"
    return AuditEntry(kind, text, by, condition.serial, condition.vehicle_name, details)
