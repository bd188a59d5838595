"""The order book is bounded and forgets nothing that is alive."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import command

from recon.model.command import Command, Hover, Phase, StopCamera
from recon.model.event import CommandDropped, CommandSent
from recon.station.state.orders import (
    OrderBook,
    OrderRecord,
    PhaseChange,
    SentContext,
    changed,
    on_dropped,
    on_sent,
    put,
)

CONTEXT = SentContext(5, None, True)


def record(number: int, *, phase: Phase = Phase.QUEUED) -> OrderRecord:
    order = Command(number, StopCamera(), "test", 0, 9, serial="A")
    return OrderRecord(order, "A", (PhaseChange(phase, 0, ""),))


def test_the_oldest_finished_ones_are_forgotten_and_no_living_one() -> None:
    book = put(OrderBook(), record(0), kept=5)
    for number in range(1, 20):
        book = put(book, record(number, phase=Phase.DONE), kept=5)
    assert list(book.records) == [0, 16, 17, 18, 19]


def test_the_newest_is_never_the_one_forgotten() -> None:
    book = OrderBook()
    for number in range(10):
        book = put(book, record(number), kept=5)
    book = put(book, record(10, phase=Phase.DONE), kept=5)
    assert 10 in book.records


def test_only_the_first_sending_counts() -> None:
    queued = record(1)
    sent = on_sent(queued, CommandSent(1, 1), CONTEXT)
    again = on_sent(sent, CommandSent(1, 1), SentContext(50, None, True))
    assert (sent.phase, sent.times_sent) == (Phase.SENT, 1)
    assert (again.sent, again.times_sent) == (CONTEXT, 2)
    assert again.history[:-1] == sent.history
    assert (again.phase, again.note) == (Phase.SENT, "sent again, on link 1")


def test_a_repeat_dropped_unsent_changes_nothing() -> None:
    sent = on_sent(record(1), CommandSent(1, 1), CONTEXT)
    assert on_dropped(sent, CommandDropped(1, 1, Phase.FAILED, ""), 9).phase is Phase.SENT


def test_an_ended_order_that_leaves_after_all_does_not_come_to_life() -> None:
    ended = changed(record(1), Phase.SUPERSEDED, 3)
    left = on_sent(ended, CommandSent(1, 1), CONTEXT)
    assert left.phase is Phase.SUPERSEDED
    assert not left.is_tracked
    assert left.times_sent == 1


def test_the_end_of_an_order_is_the_end_of_its_repeats() -> None:
    repeating = OrderRecord(
        command(Hover()), "A", (PhaseChange(Phase.SENT, 0, ""),), next_repeat_ns=7, repeats_left=3
    )
    ended = changed(repeating, Phase.DONE, 1)
    assert (ended.next_repeat_ns, ended.repeats_left) == (None, 0)


@given(st.lists(st.tuples(st.integers(0, 9), st.sampled_from(Phase), st.booleans()), max_size=60))
def test_the_watched_are_those_that_live_or_whose_alarm_does(
    puts: list[tuple[int, Phase, bool]],
) -> None:
    book = OrderBook()
    for number, phase, has_alarm in puts:
        alarm = "x" if has_alarm else None
        book = put(book, replace(record(number, phase=phase), alarm=alarm), kept=5)
        expected = {r.command.id: r for r in book.records.values() if r.is_tracked}
        assert {r.command.id: r for r in book.tracked} == expected
        assert len(book.tracked) == len(expected)
