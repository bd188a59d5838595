"""Link bytes with frames taken out: read together they are the bytes that came."""

import random

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from recon import wire
from recon.record.link_bytes import FrameBytes, LinkStream, PlainBytes

RNG = np.random.default_rng(7)
PACKETS = [
    wire.encode(wire.Image(target_fps_hz=2.0, pixels=RNG.integers(0, 256, (7, 5, 3), np.uint8))),
    wire.encode(wire.CompressedImage(target_fps_hz=float("nan"), jpeg=b"\xff\xd8 a picture")),
    wire.encode(wire.MessageString(type=1, text=b"hello")),
    b"no packet",
    wire.encode(wire.Image(target_fps_hz=2.0, pixels=np.zeros((40, 50, 3), np.uint8)))[:900],
]
MS = 1_000_000


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
    stream, found, at, now_ns = LinkStream(), [], 0, 0
    for size, wait_ms in [*reads, (len(sent), 0)]:
        now_ns += wait_ms * MS
        data = sent[at : at + size]
        found += stream.take(at, data, now_ns) if data else ()
        at += len(data)
        found += stream.overdue(now_ns) if is_flushed else ()
    found += stream.rest()
    assert b"".join(map(rebuilt, found)) == sent
    assert not any(isinstance(part, PlainBytes) and part.lost for part in found)


@given(st.integers(0, 2**32))
def test_a_whole_frame_is_in_the_record_once(seed: int) -> None:
    rng = random.Random(seed)
    sent = b"".join(PACKETS[rng.randrange(3)] for _ in range(6)) + PACKETS[0]
    stream, found, at = LinkStream(), [], 0
    while at < len(sent):
        data = sent[at : at + rng.randint(1, 300)]
        found += stream.take(at, data, 0)
        at += len(data)
    frames = [part for part in found if isinstance(part, FrameBytes)]
    assert sent.count(PACKETS[0]) + sent.count(PACKETS[1]) == len(frames)
    assert all(part.skip == 0 for part in frames)
    assert [sent[part.start : part.end] for part in frames] == [rebuilt(part) for part in frames]
    written = sum(len(p.data) if isinstance(p, PlainBytes) else len(p.around) for p in found)
    assert written + sum(len(payload(part)) for part in frames) == len(sent)


def test_a_gap_is_stated_and_frames_are_found_behind_it() -> None:
    image, text = PACKETS[0], PACKETS[2]
    stream = LinkStream()
    found = list(stream.take(0, text + image[:50], 0))
    found += stream.take(len(text) + len(image), text + image, 5)
    found += stream.rest()
    assert [rebuilt(part) for part in found] == [text, image[:50], text, image]
    assert isinstance(found[2], PlainBytes)
    assert found[2].lost == len(image) - 50
    assert isinstance(found[3], FrameBytes)
    assert found[3].end == 2 * (len(text) + len(image))


def test_half_a_frame_does_not_wait_long_for_its_end() -> None:
    image = PACKETS[0]
    stream = LinkStream()
    assert list(stream.take(0, image[:60], 0)) == []
    assert list(stream.overdue(100 * MS)) == []
    (half,) = stream.overdue(250 * MS)
    assert rebuilt(half) == image[:60]
    (rest,) = stream.take(60, image[60:], 300 * MS)
    assert isinstance(rest, FrameBytes)
    assert rest.skip == 60
    assert rebuilt(rest) == image[60:]
