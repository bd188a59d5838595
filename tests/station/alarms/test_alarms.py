"""Alarms begin, stay, change, end and are acknowledged; their book is bounded."""

from dataclasses import replace

from tests.fleet.reports import S

from recon.station.state.alarm_book import (
    Alarm,
    AlarmBook,
    Condition,
    Severity,
    acknowledge,
    note,
    update,
)

LOW = Condition("battery:A", Severity.WARNING, "battery", "A", "low", "A")
SERIOUS = replace(LOW, severity=Severity.CRITICAL, text="seriously low")


def only(book: AlarmBook) -> Alarm:
    (alarm,) = book.alarms.values()
    return alarm


def updated(
    book: AlarmBook, *conditions: Condition, at_s: float = 0.0, kept: int = 100
) -> AlarmBook:
    return update(book, conditions, round(at_s * S), kept)


def test_it_begins_stays_and_changes_its_text() -> None:
    book = updated(AlarmBook(), LOW)
    book = updated(book, replace(LOW, text="still low"), at_s=5.0)
    assert only(book).raised_at_ns == 0
    assert only(book).is_active
    assert only(book).condition.text == "still low"


def test_ended_and_not_acknowledged_it_stays_to_be_seen() -> None:
    book = updated(updated(AlarmBook(), LOW), at_s=1.0)
    assert not only(book).is_active
    assert acknowledge(book, only(book).id, "me").alarms == {}


def test_acknowledged_it_stays_while_its_cause_does() -> None:
    book = updated(AlarmBook(), LOW)
    book = updated(acknowledge(book, 1, "me"), LOW, at_s=1.0)
    assert (only(book).is_active, only(book).acknowledged_by) == (True, "me")
    assert updated(book, at_s=2.0).alarms == {}


def test_one_that_gets_worse_must_be_acknowledged_again() -> None:
    book = acknowledge(updated(AlarmBook(), LOW), 1, "me")
    assert only(updated(book, SERIOUS)).acknowledged_by is None


def test_one_that_gets_better_need_not() -> None:
    book = acknowledge(updated(AlarmBook(), SERIOUS), 1, "me")
    assert only(updated(book, LOW)).acknowledged_by == "me"


def test_one_not_acknowledged_comes_back_as_the_same_alarm() -> None:
    book = AlarmBook()
    for second in range(50):
        book = updated(book, *([LOW] if second % 2 == 0 else []), at_s=second)
    assert only(book).id == 1
    assert only(book).raised_at_ns == 0


def test_one_that_was_seen_and_ended_is_a_new_one_when_it_comes_back() -> None:
    book = updated(acknowledge(updated(AlarmBook(), LOW), 1, "me"))
    assert only(updated(book, LOW, at_s=9.0)).id == 2


def test_a_condition_must_last_before_it_is_an_alarm() -> None:
    slow = replace(LOW, after_s=2.0)
    book = updated(AlarmBook(), slow)
    assert updated(book, slow, at_s=1.999).alarms == {}
    assert only(updated(book, slow, at_s=2.0)).is_active
    interrupted = updated(updated(book, at_s=1.0), slow, at_s=1.5)
    assert updated(interrupted, slow, at_s=2.5).alarms == {}


def test_a_note_stays_until_seen_and_is_not_raised_twice() -> None:
    book = note(note(AlarmBook(), LOW, 0, 10), LOW, 5, 10)
    assert len(book.alarms) == 1
    assert acknowledge(book, 1, "me").alarms == {}


def test_chatter_never_displaces_what_is_worse_or_active() -> None:
    book = updated(AlarmBook(), SERIOUS, replace(LOW, key="active"))
    book = updated(book, replace(LOW, key="active"))
    for number in range(500):
        book = note(book, replace(LOW, key=f"app:{number}"), number, 20)
    assert len(book.alarms) == 20
    assert {"battery:A", "active"} <= {a.condition.key for a in book.alarms.values()}


def test_acknowledging_what_is_not_there_changes_nothing() -> None:
    book = updated(AlarmBook(), LOW)
    assert acknowledge(book, 99, "me") is book
