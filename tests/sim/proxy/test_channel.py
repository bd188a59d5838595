"""A channel delays bytes, keeps their order, changes the configured share, and loses none."""

from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.units import NS_PER_S
from recon.sim.errors import SimulationError
from recon.sim.proxy.damage import MOST_HELD_BYTES, Channel, Damage


def came(channel: Channel, step_ns: int = 1_000_000) -> list[tuple[int, bytes]]:
    """Return when each piece came out, to the step, until nothing is left."""
    now_ns, pieces = 0, []
    while channel.next_due_ns is not None:
        now_ns += step_ns
        pieces += [(now_ns, piece) for piece in channel.pop_due(now_ns)]
    return pieces


def test_a_good_link_passes_reads_as_they_are() -> None:
    channel = Channel(Damage(), "s", 0)
    reads = [b"one", b"t" * 5_000, b"three"]
    for number, data in enumerate(reads):
        channel.push(data, number)
    assert channel.pop_due(len(reads)) == reads
    assert channel.next_due_ns is None


def test_a_delay_is_as_long_as_configured() -> None:
    channel = Channel(Damage(delay_s=0.25), "s", 0)
    channel.push(b"late", 1_000)
    assert channel.pop_due(250_000_999) == []
    assert channel.next_due_ns == 250_001_000
    assert channel.pop_due(250_001_000) == [b"late"]


def test_a_rate_takes_bytes_over_rate_and_queues_what_follows() -> None:
    channel = Channel(Damage(rate_bytes_per_s=10_000.0), "s", 0)
    channel.push(bytes(20_000), 0)
    channel.push(bytes(5_000), 0)
    last_ns, _ = came(channel)[-1]
    assert last_ns / NS_PER_S == pytest.approx(2.5, abs=0.002)


def test_stalls_take_their_share_of_the_time() -> None:
    damage = Damage(stalls_per_min=10.0, stall_s=2.0)
    channel, waits_s, waited = Channel(damage, "s", 0), 0.0, 0
    for tenth in range(36_000):
        now_ns = tenth * NS_PER_S // 10
        channel.push(b"x", now_ns)
        late_ns = channel.next_due_ns - now_ns
        channel.pop_due(channel.next_due_ns)
        waits_s += late_ns / NS_PER_S
        waited += late_ns > 0
    # A gap of 6 s on average, then 2 s: a quarter of the time, 1 s on average.
    assert waited / 36_000 == pytest.approx(0.25, abs=0.03)
    assert waits_s / waited == pytest.approx(1.0, abs=0.06)


@pytest.mark.parametrize("per_mb", [100.0, 20_000.0, 1_000_000.0])
def test_the_configured_share_of_bytes_is_changed(per_mb: float) -> None:
    channel, size = Channel(Damage(corrupted_per_mb=per_mb), "s", 0), 1_000_000
    for _ in range(size // 1_000):
        channel.push(bytes(1_000), 0)
    changed = size - b"".join(channel.pop_due(0)).count(0)
    assert changed == pytest.approx(per_mb, rel=0.3)


damages = st.builds(
    Damage,
    delay_s=st.floats(0.0, 2.0),
    jitter_s=st.floats(0.0, 1.0),
    rate_bytes_per_s=st.just(inf) | st.floats(100.0, 1e6),
    stalls_per_min=st.floats(0.0, 60.0),
    stall_s=st.floats(0.0, 5.0),
    corrupted_per_mb=st.floats(0.0, 1e6),
)
reads = st.lists(st.tuples(st.binary(max_size=4_000), st.integers(0, NS_PER_S)), max_size=20)


@given(damages, reads, st.integers())
def test_nothing_is_lost_and_the_same_seed_does_the_same(damage, pushed, seed) -> None:
    channels = [Channel(damage, f"{seed}", 0) for _ in range(2)]
    for channel in channels:
        now_ns = 0
        for data, later_ns in pushed:
            now_ns += later_ns
            channel.push(data, now_ns)
    one, other = (channel.pop_due(10**15) for channel in channels)
    assert one == other
    assert len(b"".join(one)) == sum(len(data) for data, _ in pushed)


@given(damages.filter(lambda d: d.corrupted_per_mb == 0.0) | st.just(Damage(jitter_s=1.0)), reads)
def test_order_is_kept_and_nothing_comes_early(damage, pushed) -> None:
    channel, now_ns, dues = Channel(damage, "s", 0), 0, []
    for number, (_, later_ns) in enumerate(pushed):
        now_ns += later_ns
        channel.push(bytes([number]), now_ns)
        assert channel.next_due_ns >= damage.delay_s * NS_PER_S - 1
    while channel.next_due_ns is not None:
        dues.append(channel.next_due_ns)
        assert channel.pop_due(dues[-1] - 1) == []
        dues += [dues[-1]] * (len(channel.pop_due(dues[-1])) - 1)
    assert dues == sorted(dues)


def test_a_full_channel_has_no_room_until_something_came_out() -> None:
    channel = Channel(Damage(delay_s=1.0), "s", 0)
    channel.push(bytes(MOST_HELD_BYTES), 0)
    assert not channel.has_room
    channel.pop_due(NS_PER_S)
    assert channel.has_room


@pytest.mark.parametrize(
    "wrong",
    [
        {"delay_s": -1.0},
        {"jitter_s": float("nan")},
        {"rate_bytes_per_s": 0.0},
        {"stalls_per_min": 1e9},
        {"corrupted_per_mb": 2e6},
    ],
)
def test_impossible_damage_is_refused_in_words(wrong: dict[str, float]) -> None:
    with pytest.raises(SimulationError, match=r"expected .* got"):
        Damage(**wrong)
