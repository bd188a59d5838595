"""The cadence of sticks: even, whatever comes late, and spread over the period."""

from hypothesis import given
from hypothesis import strategies as st

from recon.station.state.setpoint_stream import StreamSettings, first_due_ns, following_due_ns

MS = 1_000_000
SETTINGS = StreamSettings()
PERIOD_NS = 100 * MS


@given(st.integers(0, 10**18), st.integers(0, 10 * PERIOD_NS))
def test_a_late_step_does_not_shift_the_beat(due_ns: int, late_ns: int) -> None:
    following_ns = following_due_ns(due_ns, due_ns + late_ns, SETTINGS)
    assert following_ns > due_ns + late_ns
    assert following_ns <= due_ns + late_ns + PERIOD_NS
    assert (following_ns - due_ns) % PERIOD_NS == 0


@given(st.integers(0, 10**18))
def test_the_first_gap_is_most_of_a_period_and_no_more_than_two(now_ns: int) -> None:
    gap_ns = first_due_ns((), now_ns, SETTINGS) - now_ns
    assert 80 * MS <= gap_ns < 180 * MS


@given(st.lists(st.integers(0, 10**10), min_size=1, max_size=64))
def test_streams_are_spread_over_the_period(begun_ns: list[int]) -> None:
    due: tuple[int, ...] = ()
    for now_ns in begun_ns:
        due = (*due, first_due_ns(due, now_ns, SETTINGS))
    slots = [due_ns % PERIOD_NS // (10 * MS) for due_ns in due]
    counts = [slots.count(slot) for slot in range(10)]
    assert max(counts) - min(counts) <= 1
    assert all(due_ns % (10 * MS) == 0 for due_ns in due)
