"""The clock of a replay: speeds, pauses, seeks, the end."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.units import seconds_to_ns
from recon.station.recording.transport import FASTEST, SLOWEST, Transport

BEGIN, END = seconds_to_ns(100.0), seconds_to_ns(260.0)
AT_BEGIN = Transport(BEGIN, END, BEGIN)


@pytest.mark.parametrize("speed", [0.1, 1.0, 50.0])
def test_it_plays_at_its_speed_and_stands_while_paused(speed: float) -> None:
    playing = AT_BEGIN.at_speed(speed, 5.0).played(5.0)
    assert playing.position_ns(6.0) == BEGIN + seconds_to_ns(speed)
    paused = playing.paused(6.0)
    assert paused.position_ns(99.0) == playing.position_ns(6.0)
    assert paused.played(99.0).position_ns(99.5) == BEGIN + seconds_to_ns(1.5 * speed)


def test_a_new_speed_counts_from_now_on() -> None:
    playing = AT_BEGIN.played(0.0).at_speed(10.0, 2.0)
    assert playing.position_ns(3.0) == BEGIN + seconds_to_ns(2.0 + 10.0)


@pytest.mark.parametrize("speed", [0.0, -1.0, SLOWEST - 0.01, FASTEST + 0.1, float("nan")])
def test_other_speeds_are_refused(speed: float) -> None:
    with pytest.raises(ValueError, match=r"speed must be 0\.1 to 50; got"):
        AT_BEGIN.at_speed(speed, 0.0)


def test_it_pauses_at_the_end_and_plays_again_from_the_beginning() -> None:
    ended = AT_BEGIN.played(0.0).as_of(1000.0)
    assert (ended.at_ns, ended.is_playing) == (END, False)
    assert ended.played(1000.0).position_ns(1001.0) == BEGIN + seconds_to_ns(1.0)


def test_a_seek_goes_on_as_before() -> None:
    sought = AT_BEGIN.played(0.0).sought(BEGIN + seconds_to_ns(30.0), 7.0)
    assert sought.is_playing
    assert sought.position_ns(8.0) == BEGIN + seconds_to_ns(31.0)
    assert not AT_BEGIN.sought(END, 7.0).is_playing


def test_a_record_of_one_moment_never_plays() -> None:
    assert not Transport(BEGIN, BEGIN, BEGIN).played(0.0).is_playing


CHANGES = st.one_of(
    st.tuples(st.just("played")),
    st.tuples(st.just("paused")),
    st.tuples(st.just("as_of")),
    st.tuples(st.just("at_speed"), st.floats(SLOWEST, FASTEST)),
    st.tuples(st.just("sought"), st.integers(-(2**60), 2**60)),
)


@given(st.lists(st.tuples(CHANGES, st.floats(0.0, 100.0)), max_size=20))
def test_whatever_is_done_it_stays_within_the_record(
    steps: list[tuple[tuple[str, float], float]],
) -> None:
    transport, now_s = AT_BEGIN, 0.0
    for (name, *values), later_s in steps:
        before_ns = transport.position_ns(now_s)
        now_s += later_s
        assert before_ns <= transport.position_ns(now_s)
        transport = getattr(transport, name)(*values, now_s)
        assert BEGIN <= transport.position_ns(now_s) <= END
