"""Link bytes with frames taken out: read together they are the bytes that came."""

import random
import sys
from types import FrameType
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from recon import wire
from recon.record.mcap.link_bytes import FrameBytes, LinkStream, PlainBytes

RNG = np.random.default_rng(7)
PACKETS = [
    wire.encode(wire.Image(target_fps_hz=2.0, pixels=RNG.integers(0, 256, (7, 5, 3), np.uint8))),
    wire.encode(wire.CompressedImage(target_fps_hz=float("nan"), jpeg=b"\xff\xd8 a picture")),
    wire.encode(wire.MessageString(type=1, text=b"hello")),
    b"no packet",
    wire.encode(wire.Image(target_fps_hz=2.0, pixels=np.zeros((40, 50, 3), np.uint8)))[:900],
]
MS = 1_000_000


class Fed:
    """A stream that is given each read, and then the packets in it, as a link's session does."""

    def __init__(self) -> None:
        self.stream, self.deframer = LinkStream(), wire.Deframer()
        self.found: list[PlainBytes | FrameBytes] = []
        self.end = 0

    def reads(self, data: bytes, now_ns: int = 0) -> list[PlainBytes | FrameBytes]:
        """Return what can be written now."""
        before = len(self.found)
        self.found += self.stream.take(self.end, data, now_ns)
        self.end += len(data)
        packets = self.deframer.feed(data, now_ns)
        for packet, (start, end) in zip(packets, self.deframer.spans, strict=True):
            if isinstance(packet, wire.Image | wire.CompressedImage):
                self.found += self.stream.image(start, end, now_ns)
            else:
                self.found += self.stream.packet(end)
        return self.found[before:]


def payload(part: FrameBytes) -> bytes:
    packet = part.packet
    return packet.pixels.tobytes() if isinstance(packet, wire.Image) else packet.jpeg


def rebuilt(part: PlainBytes | FrameBytes) -> bytes:
    """What a reader makes of it."""
    if isinstance(part, PlainBytes):
        return part.data
    return (part.around[:-2] + payload(part) + part.around[-2:])[part.skip :]


@given(
    st.lists(st.integers(0, len(PACKETS) - 1), min_size=1, max_size=12),
    st.lists(st.tuples(st.integers(1, 200), st.integers(0, 400)), max_size=60),
    st.booleans(),
)
def test_the_bytes_are_those_that_came(
    numbers: list[int], reads: list[tuple[int, int]], is_flushed: bool
) -> None:
    sent = b"".join(PACKETS[number] for number in numbers)
    fed, at, now_ns = Fed(), 0, 0
    for size, wait_ms in [*reads, (len(sent), 0)]:
        now_ns += wait_ms * MS
        data = sent[at : at + size]
        fed.reads(data, now_ns)
        at += len(data)
        fed.found += fed.stream.overdue(now_ns) if is_flushed else ()
    fed.found += fed.stream.rest()
    assert b"".join(map(rebuilt, fed.found)) == sent
    assert not any(part.lost for part in fed.found)


@given(st.integers(0, 2**32))
def test_a_whole_frame_is_in_the_record_once(seed: int) -> None:
    rng = random.Random(seed)
    sent = b"".join(PACKETS[rng.randrange(3)] for _ in range(6)) + PACKETS[0]
    fed, at = Fed(), 0
    while at < len(sent):
        data = sent[at : at + rng.randint(1, 300)]
        fed.reads(data)
        at += len(data)
    frames = [part for part in fed.found if isinstance(part, FrameBytes)]
    assert sent.count(PACKETS[0]) + sent.count(PACKETS[1]) == len(frames)
    assert all(part.skip == 0 for part in frames)
    written = sum(len(p.data) if isinstance(p, PlainBytes) else len(p.around) for p in fed.found)
    assert written + sum(len(payload(part)) for part in frames) == len(sent)
    assert fed.stream.held_bytes == 0


def test_a_gap_is_stated_and_frames_are_found_behind_it() -> None:
    image, text = PACKETS[0], PACKETS[2]
    fed = Fed()
    fed.reads(text + image[:50])
    lost = len(image) - 50
    fed.end += lost
    found = [*fed.found, *fed.stream.take(fed.end, image + text, 5)]
    start = fed.end
    found += fed.stream.image(start - len(image), start, 5)  # Its beginning is lost.
    found += fed.stream.image(start, start + len(image), 5)
    found += fed.stream.rest()
    assert [rebuilt(part) for part in found] == [text + image[:50], image, text]
    assert [part.lost for part in found] == [0, lost, 0]
    assert [isinstance(part, FrameBytes) for part in found] == [False, True, False]


def test_half_a_frame_does_not_wait_long_for_its_end() -> None:
    image = PACKETS[0]
    fed = Fed()
    assert fed.reads(image[:60]) == []
    assert list(fed.stream.overdue(100 * MS)) == []
    (half,) = fed.stream.overdue(250 * MS)
    assert rebuilt(half) == image[:60]
    (rest,) = fed.reads(image[60:], 300 * MS)
    assert isinstance(rest, FrameBytes)
    assert rest.skip == 60
    assert rebuilt(rest) == image[60:]


def test_the_work_for_a_frame_follows_the_number_of_its_reads() -> None:
    image = PACKETS[0]

    def lines(read_bytes: int) -> int:
        count = 0

        def trace(_frame: FrameType, _event: str, _argument: Any) -> Any:
            nonlocal count
            count += 1
            return trace

        fed = Fed()
        sys.settrace(trace)
        try:
            for at in range(0, len(image), read_bytes):
                fed.reads(image[at : at + read_bytes])
                list(fed.stream.overdue(0))
        finally:
            sys.settrace(None)
        assert len(fed.found) == 1
        return count

    before = sys.gettrace()
    try:
        assert lines(1) < 1.2 * 10 * lines(10)
    finally:
        sys.settrace(before)


def test_what_is_held_can_be_forgotten() -> None:
    image = PACKETS[0]
    fed = Fed()
    fed.reads(image[:60])
    (half,) = fed.stream.forget()
    assert (rebuilt(half), fed.stream.held_bytes) == (image[:60], 0)
    (rest,) = fed.reads(image[60:])
    assert rest == PlainBytes(image[60:], 0)
