"""Frames in bytes that may be anything, and their signatures."""

from hashlib import sha256
from pathlib import Path

from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink
from tests.gateway.drawn import given_examples

from recon.gateway.mavlink.encoder import Encoder
from recon.gateway.mavlink.frames import MAX_FAULTS, FrameReader, MavlinkFrame
from recon.gateway.mavlink.signing import BEGAN_UNIX_S, Signer, read_key

KEY = b"k" * 32
NOW_S = BEGAN_UNIX_S + 3.5e8
LONGEST_FRAME = 280


def beat(mode: int = 0) -> mavlink.MAVLink_heartbeat_message:
    return mavlink.MAVLink_heartbeat_message(6, 8, 0, mode, 4, 3)


def frame(signer: Signer | None = None, now_s: float = NOW_S, mode: int = 0) -> bytes:
    return Encoder(signer).encode(255, [beat(mode)], now_s)[0]


def read(data: bytes) -> list[MavlinkFrame]:
    return FrameReader().read(data)


@given_examples(st.binary(max_size=60), st.lists(st.integers(1, 40), max_size=8))
def test_frames_are_found_between_any_bytes_and_however_they_are_cut(
    noise: bytes, cuts: list[int]
) -> None:
    # A length inside the noise may swallow what follows, until more bytes come.
    data = noise + frame(mode=7) + bytes(LONGEST_FRAME) + frame(mode=8) + bytes(LONGEST_FRAME)
    reader, found, at = FrameReader(), list[MavlinkFrame](), 0
    for cut in (*cuts, len(data)):
        found += reader.read(data[at : at + cut])
        at += cut
    assert [f.message.custom_mode for f in found if f.message.get_type() == "HEARTBEAT"][-2:] == [
        7,
        8,
    ]


@given_examples(st.lists(st.binary(max_size=2000), max_size=5))
def test_any_bytes_cost_bounded_memory_and_no_error(reads: list[bytes]) -> None:
    reader = FrameReader()
    for data in reads:
        reader.read(data)
        assert len(reader._kept) <= LONGEST_FRAME


def test_bytes_that_only_look_like_frames_are_given_up_soon() -> None:
    reader = FrameReader()
    # A heartbeat's header at each step, each with a wrong checksum.
    reader.read(bytes((0xFE, 9, 0, 1, 1, 0)) * 2000)
    assert reader.faults == MAX_FAULTS + 1


def test_mavlink_1_is_read() -> None:
    data = beat(5).pack(mavlink.MAVLink(None, 255, 190), force_mavlink1=True)
    assert [f.message.custom_mode for f in read(data)] == [5]


def test_pymavlink_takes_the_signature() -> None:
    client = mavlink.MAVLink(None)
    client.signing.secret_key = KEY
    client.signing.timestamp = round((NOW_S - BEGAN_UNIX_S) * 1e5)
    assert client.decode(bytearray(frame(Signer(KEY)))).get_signed()


def test_a_client_that_joins_an_hour_later_takes_it_too() -> None:
    signer = Signer(KEY)
    frame(signer)
    client = mavlink.MAVLink(None)
    client.signing.secret_key = KEY
    client.signing.timestamp = round((NOW_S + 3600.0 - BEGAN_UNIX_S) * 1e5)
    assert client.decode(bytearray(frame(signer, NOW_S + 3600.0))).get_signed()


def test_only_a_right_signature_is_accepted() -> None:
    (good,) = read(frame(Signer(KEY)))
    (unsigned,) = read(frame())
    (foreign,) = read(frame(Signer(b"x" * 32)))
    assert Signer(KEY).accepts(good, NOW_S)
    assert not Signer(KEY).accepts(unsigned, NOW_S)
    assert not Signer(KEY).accepts(foreign, NOW_S)
    assert not Signer(KEY).accepts(MavlinkFrame(good.data[:-1] + b"\0", good.message), NOW_S)


def test_no_message_is_taken_twice() -> None:
    signer = Signer(KEY)
    (good,) = read(frame(Signer(KEY)))
    assert signer.accepts(good, NOW_S)
    assert not signer.accepts(good, NOW_S)


def test_a_stream_begins_at_most_a_minute_late() -> None:
    (good,) = read(frame(Signer(KEY)))
    assert Signer(KEY).accepts(good, NOW_S + 59.0)
    assert not Signer(KEY).accepts(good, NOW_S + 61.0)


def test_a_stranger_cannot_move_the_time_of_a_stream() -> None:
    signer = Signer(KEY)
    (future,) = read(frame(Signer(b"x" * 32), NOW_S + 1e6))
    assert not signer.accepts(future, NOW_S)
    (good,) = read(frame(Signer(KEY)))
    assert signer.accepts(good, NOW_S)


def test_a_key_is_hexadecimal_digits_or_a_passphrase(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_text("ab" * 32 + "\n")
    assert read_key(file) == bytes.fromhex("ab" * 32)
    file.write_text("a passphrase")
    # As MAVProxy makes it.
    assert read_key(file) == sha256(b"a passphrase").digest()
