"""When a message was made, however long it lay in a buffer."""

from hypothesis import given
from hypothesis import strategies as st

from recon.client.stream_clock import WINDOW_NS, StreamClock

MS = 1_000_000
RUN = 5


@given(
    st.integers(-(10**18), 10**18),
    st.lists(st.integers(0, 3000), min_size=1, max_size=50),
)
def test_delays_are_known_up_to_the_fastest_message(apart_ns: int, delays_ms: list[int]) -> None:
    """Truth: made every 100 ms, arriving in order after at least 2 ms and the given delay."""
    clock = StreamClock()
    last_ns, fastest_ns = 0, 10**18
    for number, delay_ms in enumerate(delays_ms):
        made_ns = number * 100 * MS
        arrived_ns = last_ns = max(last_ns, made_ns + (2 + delay_ms) * MS)
        fastest_ns = min(fastest_ns, arrived_ns - made_ns)
        found_ns = clock.made_at_ns(made_ns + apart_ns, RUN, arrived_ns)
        assert found_ns <= arrived_ns
        assert found_ns == made_ns + fastest_ns


def test_clocks_that_drift_apart_are_followed() -> None:
    clock = StreamClock()
    for second in range(0, 36_000, 10):
        station_ns = second * 1_000 * MS
        ours_ns = station_ns + station_ns // 20_000
        delay_ns = ours_ns - clock.made_at_ns(station_ns, RUN, ours_ns)
        assert delay_ns <= 3 * WINDOW_NS // 20_000


def test_another_run_of_the_station_has_another_clock() -> None:
    clock = StreamClock()
    assert clock.made_at_ns(1_000, RUN, 50) == 50
    assert clock.made_at_ns(9, RUN + 1, 70) == 70
