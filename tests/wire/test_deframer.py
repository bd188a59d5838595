"""The deframer as Python sees it: reads of any size, time, counters."""

from copy import copy

import hypothesis.strategies as st
from hypothesis import given
from tests.wire.cases import packets

from recon import wire

ACK = wire.Acknowledgment(positive=1, source_pid=253)
ACK_FRAME = wire.encode(ACK)
HOVER = wire.EmergencyCommand(action=0)
SECOND_NS = 1_000_000_000
FALSE_HEADER = bytes.fromhex("daa7017bb01102000000000870 0f00".replace(" ", ""))


@given(
    st.lists(st.tuples(packets, st.binary(max_size=9)), max_size=5),
    st.lists(st.integers(0, 400), max_size=20),
)
def test_reads_of_any_size_give_the_same(
    pieces: list[tuple[wire.Packet, bytes]], reads: list[int]
) -> None:
    stream = b"".join(noise + wire.encode(packet) for packet, noise in pieces)
    whole = wire.Deframer()
    expected = whole.feed(stream) + whole.finish()
    split = wire.Deframer()
    found, start = [], 0
    for read in [*reads, len(stream)]:
        found += split.feed(stream[start : start + read])
        start += read
    found += split.finish()
    assert found == expected
    assert split.counters == whole.counters


def test_counters_tell_what_came() -> None:
    unknown = wire.encode(wire.UnknownPacket(pid=99, payload=b"?"))
    bad_hash = ACK_FRAME[:-1] + b"\x00"
    bad_size = b"\xda\xa7\x00\x00\x00\x05\x03"
    deframer = wire.Deframer()
    stream = b"xyz" + ACK_FRAME + bad_hash + unknown + bad_size + ACK_FRAME + ACK_FRAME[:4]
    assert len(deframer.feed(stream)) == 3
    assert deframer.pending_bytes == 4
    counters = deframer.counters
    assert counters.packets == {3: 2, 99: 1}
    assert (counters.bad_hash, counters.bad_size, counters.unknown_pid) == (1, 1, 1)
    assert (counters.bad_payload, counters.abandoned) == (0, 0)
    assert counters.bytes_skipped == 3 + 11 + 7
    assert deframer.finish() == []
    assert deframer.counters.abandoned == 1
    assert counters.abandoned == 0, "counters are a snapshot"


@given(
    st.lists(st.tuples(packets, st.binary(max_size=9)), max_size=4),
    st.integers(0, 300),
    st.booleans(),
)
def test_a_copy_goes_on_in_the_same_state_and_leaves_the_other_alone(
    pieces: list[tuple[wire.Packet, bytes]], read: int, gives_up: bool
) -> None:
    stream = b"".join(noise + wire.encode(packet) for packet, noise in pieces)
    first = wire.Deframer(wire.Limits(work_per_call=100_000))
    first.feed(stream[:read], 5)
    second = copy(first)
    ends = []
    for deframer in (second, first):
        found = deframer.resume() + deframer.feed(stream[read:], 5 + 3 * SECOND_NS * gives_up)
        arrivals = (deframer.arrivals_ns, deframer.spans, deframer.is_busy, deframer.pending_bytes)
        while deframer.is_busy:
            found += deframer.resume()
        ends.append((found + deframer.finish(), arrivals, deframer.counters, deframer.work_done))
    assert ends[0] == ends[1]


def test_a_stall_gives_up_the_half_packet_and_what_it_hides() -> None:
    deframer = wire.Deframer()
    assert deframer.feed(FALSE_HEADER + ACK_FRAME, 0) == []
    assert deframer.tick(2 * SECOND_NS - 1) == []
    assert deframer.tick(2 * SECOND_NS) == [ACK]
    assert deframer.pending_bytes == 0


def test_patience_is_settable() -> None:
    limits = wire.Limits(stall_timeout_ns=60 * SECOND_NS, age_timeout_ns=3 * SECOND_NS)
    deframer = wire.Deframer(limits)
    assert deframer.feed(FALSE_HEADER + ACK_FRAME, 0) == []
    assert deframer.feed(wire.encode(HOVER), SECOND_NS * 2) == []
    assert deframer.tick(SECOND_NS * 3) == [ACK, HOVER]


def test_a_claim_beyond_the_limits_holds_nothing_up() -> None:
    deframer = wire.Deframer(wire.Limits(max_image_rows=100))
    assert deframer.feed(FALSE_HEADER + ACK_FRAME) == [ACK]


def test_bytearrays_are_taken_too() -> None:
    assert wire.Deframer().feed(bytearray(ACK_FRAME)) == [ACK]


def test_a_withheld_packet_has_the_time_its_bytes_came() -> None:
    deframer = wire.Deframer()
    assert deframer.feed(FALSE_HEADER + ACK_FRAME, 5) == []
    assert deframer.arrivals_ns == []
    assert deframer.tick(5 + 2 * SECOND_NS) == [ACK]
    assert deframer.arrivals_ns == [5]
    assert deframer.feed(ACK_FRAME, 3 * SECOND_NS) == [ACK]
    assert deframer.arrivals_ns == [3 * SECOND_NS]


def test_a_call_ends_at_its_limit_of_work() -> None:
    deframer = wire.Deframer(wire.Limits(work_per_call=4 * 2**20))
    found = deframer.feed(ACK_FRAME * 1000)
    assert len(found) <= 64
    most, done = deframer.work_done, deframer.work_done
    while deframer.is_busy:
        found += deframer.resume()
        most, done = max(most, deframer.work_done - done), deframer.work_done
    assert found == [ACK] * 1000
    assert most < 5 * 2**20


def test_time_in_which_it_was_not_read_is_no_stall() -> None:
    deframer = wire.Deframer()
    deframer.feed(ACK_FRAME[:5], 0)
    deframer.excuse(3 * SECOND_NS)
    assert deframer.feed(ACK_FRAME[5:], 3 * SECOND_NS) == [ACK]
