"""Damaged frames and streams, and what must come of them."""

import struct
from collections.abc import Iterator
from typing import NamedTuple

from document import CORE, EXTENDED, SYNC, frame, pack, pattern, row, string


class Bad(NamedTuple):
    """A damaged stream and what must come of it."""

    stream: bytes
    decode: str | None = None
    frames: tuple[bytes, ...] = ()
    counters: dict[str, int] = {}  # noqa: RUF012 - a NamedTuple, never changed


def bad_frames() -> Iterator[tuple[str, Bad]]:
    """One frame each, whose decoding fails as named."""
    core = frame(0, pack(CORE, row(CORE, 1, *[1.5] * 10)))
    extended = pack(EXTENDED, row(EXTENDED, 1, 1, 0, 0, 80, 0, 0, 0, 3, 0))
    fps = struct.pack(">f", 1.0)
    once = {"bad_size": 1, "bad_hash": 0, "abandoned": 0}
    damaged = {"bad_size": 0, "bad_hash": 1, "abandoned": 0}
    half = {"bad_size": 0, "bad_hash": 0, "abandoned": 1}
    yield "hash_a", Bad(core[:-2] + bytes([core[-2] ^ 1]) + core[-1:], "hash", counters=damaged)
    yield "hash_b", Bad(core[:-1] + bytes([core[-1] ^ 0x80]), "hash", counters=damaged)
    yield "one_bit", Bad(core[:20] + bytes([core[20] ^ 4]) + core[21:], "hash", counters=damaged)
    yield "no_sync", Bad(b"\x00" + core[1:], "sync", counters={"bad_size": 0, "bad_hash": 0})
    yield "empty", Bad(b"", "short", counters={"abandoned": 0})
    yield "half_header", Bad(core[:6], "short", counters=half)
    yield "half_packet", Bad(core[:40], "short", counters=half)
    yield "size_0", Bad(frame(0, core[7:-2], 0), "size", counters=once)
    yield "size_5", Bad(frame(0, core[7:-2], 5), "size", counters=once)
    yield "size_plus_one", Bad(frame(0, core[7:-2] + b"\x00"), "size", counters=once)
    yield "size_4_gigabytes", Bad(frame(0, core[7:-2], 0xFFFFFFFF), "size", counters=once)
    yield "payload_shorter_than_its_fields", Bad(frame(0, core[7:27]), "size", counters=once)
    yield (
        "serial_longer_than_packet",
        Bad(frame(1, extended + struct.pack(">I", 9) + b"short"), "size", counters=once),
    )
    yield (
        "serial_shorter_than_packet",
        Bad(frame(1, extended + struct.pack(">I", 2) + b"long"), "size", counters=once),
    )
    yield (
        "serial_length_wraps",
        Bad(frame(1, extended + struct.pack(">I", 0xFFFFFFFF)), "size", counters=once),
    )
    yield "serial_too_long", Bad(frame(1, extended + string(b"S" * 257)), "size", counters=once)
    yield (
        "image_size_wraps",
        Bad(
            frame(2, fps + struct.pack(">HH", 43691, 32768) + b"\x00" * 32768),
            "size",
            counters=once,
        ),
    )
    yield (
        "image_short_of_a_pixel",
        Bad(frame(2, fps + struct.pack(">HH", 2, 2) + b"\x00" * 11), "size", counters=once),
    )
    yield (
        "image_too_wide",
        Bad(frame(2, fps + struct.pack(">HH", 1, 3841) + b"\x00" * 11523), "size", counters=once),
    )
    yield (
        "message_longer_than_packet",
        Bad(frame(4, b"\x01" + struct.pack(">I", 100) + b"short"), "size", counters=once),
    )
    yield "file_without_fps", Bad(frame(5, b"\x00\x00\x00"), "size", counters=once)
    yield "mission_without_waypoint", Bad(frame(253, b"\x00\x00"), "size", counters=once)
    yield (
        "mission_of_half_a_waypoint",
        Bad(frame(253, b"\x00\x00" + b"\x00" * 60), "size", counters=once),
    )
    yield (
        "mission_of_100_waypoints",
        Bad(frame(253, b"\x00\x00" + b"\x00" * 4000), "size", counters=once),
    )
    yield "unknown_too_long", Bad(frame(77, b"\x00" * 65537), "size", counters=once)


def bad_streams() -> Iterator[tuple[str, Bad]]:
    """Damaged streams of which every intact packet must be found."""
    core = frame(0, pack(CORE, row(CORE, 1, *[1.5] * 10)))
    ack, hover = frame(3, b"\x01\xfd"), frame(255, b"\x00")
    pixels = bytearray(pattern(64 * 64 * 3))
    fake = struct.pack(">HIBfHH", SYNC, 17 + 3 * 2160 * 3840, 2, 1.0, 2160, 3840)
    pixels[5000 : 5000 + len(fake)] = fake
    pixels[9000 : 9000 + len(ack)] = ack
    image_payload = struct.pack(">fHH", 1.0, 64, 64) + bytes(pixels)
    picture = frame(2, image_payload)
    jpeg = frame(5, struct.pack(">f", 1.0) + bytes(pixels))
    yield "garbage_first", Bad(bytes(range(200)) + core + ack, None, (core, ack))
    yield (
        "stray_da_between",
        Bad(
            b"\xda" + core + b"\xda\xda" + ack + b"\xda" + hover + b"\xda", None, (core, ack, hover)
        ),
    )
    for text, size in (("5", 5), ("2100000000", 2_100_000_000)):
        yield (
            f"size_changed_to_{text}",
            Bad(core[:2] + struct.pack(">I", size) + core[6:] + ack + hover, None, (ack, hover)),
        )
    for more in (512, 1024):
        changed = jpeg[:2] + struct.pack(">I", len(jpeg) + more) + jpeg[6:]
        yield (
            f"size_plus_{more}",
            Bad(changed + core * 20 + ack, None, (ack,) + (core,) * 20 + (ack,)),
        )
    yield (
        "truncated_then_whole",
        Bad(core[:50] + core + picture[:9000] + core + ack, None, (core, core, ack)),
    )
    yield (
        "sync_in_payload",
        Bad(
            frame(200, b"\xda\xa7" * 30) + ack,
            None,
            (frame(200, b"\xda\xa7" * 30), ack),
            {"bad_size": 0, "bad_hash": 0},
        ),
    )
    yield (
        "fake_header_in_image",
        Bad(picture + ack, None, (picture, ack), {"bad_size": 0, "bad_hash": 0}),
    )
    broken = picture[:-1] + bytes([picture[-1] ^ 1])
    yield "packet_in_damaged_image", Bad(broken + hover, None, (ack, hover))
    yield "false_header_of_25_megabytes", Bad(fake + core * 3 + ack, None, (core,) * 3 + (ack,))
    yield (
        "unknown_pid",
        Bad(
            ack + frame(99, b"?") + hover,
            None,
            (ack, frame(99, b"?"), hover),
            {"unknown_pid": 1, "bytes_skipped": 0},
        ),
    )
