"""The raw bytes of the links in a flight record, each frame in it once.

A frame's pixels, or its JPEG, stand in the topic of its images; the bytes of its link refer to them
and hold what stands around them. Read together they are the link's bytes exactly.

`LinkStream` cuts the bytes of one app where its frames begin and end. Bytes of a frame that has not
ended within `HALF_FRAME_S` are written as they are, so that a power cut does not cost them; the
rest of that frame refers to the image.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import msgspec
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from google.protobuf.message import DecodeError
from mcap.writer import MCAP0_MAGIC

from recon import wire
from recon.model.errors import RecordError
from recon.model.units import seconds_to_ns
from recon.record.mcap_read import McapReading, RecordMessage

LINKS_TOPIC = "/recon/link_bytes"
HALF_FRAME_S = 0.25
FRAMES_KEPT = 16
"""Frames read that no bytes and no event have named yet; each stands right before its own."""

TRAILER_BYTES = 2
IMAGE_HEAD_BYTES = 15
"""Before the pixels: sync, size, PID, fps, rows and columns."""
JPEG_HEAD_BYTES = 11

ImagePacket = wire.Image | wire.CompressedImage
Picture = RawImage | CompressedImage


class LinkMessage(msgspec.Struct, frozen=True, omit_defaults=True):
    """A message of that topic: what came by one read, or left by one write.

    With a `frame`, `data` stands around that image's payload, the last two bytes behind it, and the
    message is for all of that from byte `skip` on. `lost` bytes before it are not in the record.
    """

    link: int
    from_app: bool
    data: bytes
    frame: int = 0
    skip: int = 0
    lost: int = 0


@dataclass(frozen=True, slots=True)
class LinkBytes:
    """Bytes of one link, and when they came or left."""

    link_id: int
    is_from_app: bool
    data: bytes
    at_ns: int


@dataclass(frozen=True, slots=True, eq=False)
class FrameBytes:
    """The bytes of one image packet: around its payload, from byte `skip` on."""

    packet: ImagePacket
    around: bytes
    skip: int
    start: int
    end: int
    """Of the packet, in the stream of its link."""
    at_ns: int


@dataclass(frozen=True, slots=True)
class PlainBytes:
    """Bytes that are recorded as they are; `lost` ones before them never came here."""

    data: bytes
    at_ns: int
    lost: int = 0


class LinkStream:
    """The bytes from one app, in the order they came."""

    def __init__(self) -> None:
        self._deframer = wire.Deframer()
        self._base = self._end = self._written = 0
        self._lost = 0
        self._held: deque[tuple[int, bytes, int]] = deque()

    def take(self, start: int, data: bytes, at_ns: int) -> Iterator[PlainBytes | FrameBytes]:
        """Take one read that begins at byte `start` of the link; yield what can be written."""
        if start != self._end:
            yield from self._written_up_to(self._end)
            self._restart_at(start)
        self._held.append((start, data, at_ns))
        self._end = start + len(data)
        frames = self._frames(self._deframer.feed(data, at_ns))
        while self._deframer.is_busy:
            frames += self._frames(self._deframer.resume())
        for packet, end in frames:
            yield from self._frame(packet, end, at_ns)
        yield from self._written_up_to(self._end - self._deframer.pending_bytes)
        self._forget()

    def overdue(self, now_ns: int) -> Iterator[PlainBytes | FrameBytes]:
        """Yield bytes that have waited too long for the end of their frame."""
        since_ns = next((at for start, d, at in self._held if start + len(d) > self._written), None)
        if since_ns is not None and now_ns - since_ns >= seconds_to_ns(HALF_FRAME_S):
            yield from self._written_up_to(self._end)

    def rest(self) -> Iterator[PlainBytes | FrameBytes]:
        """Yield what is held: the link has ended, or the file."""
        yield from self._written_up_to(self._end)

    def _restart_at(self, start: int) -> None:
        self._lost = max(0, start - self._end)
        self._deframer, self._base = wire.Deframer(), start
        self._held.clear()
        self._written = start

    def _frames(self, packets: list[wire.Packet]) -> list[tuple[ImagePacket, int]]:
        ends = zip(packets, self._deframer.ends, strict=True)
        return [(p, self._base + end) for p, end in ends if isinstance(p, ImagePacket)]

    def _frame(
        self, packet: ImagePacket, end: int, at_ns: int
    ) -> Iterator[PlainBytes | FrameBytes]:
        head_bytes, payload_bytes = (
            (IMAGE_HEAD_BYTES, packet.pixels.nbytes)
            if isinstance(packet, wire.Image)
            else (JPEG_HEAD_BYTES, len(packet.jpeg))
        )
        start = end - head_bytes - payload_bytes - TRAILER_BYTES
        yield from self._written_up_to(start)
        around = self._bytes(start, start + head_bytes) + self._bytes(end - TRAILER_BYTES, end)
        skip = max(0, self._written - start)
        self._written = max(self._written, end)
        yield FrameBytes(packet, around, skip, start, end, at_ns)

    def _written_up_to(self, end: int) -> Iterator[PlainBytes]:
        for start, data, at_ns in self._held:
            first, last = max(start, self._written), min(start + len(data), end)
            if first < last:
                part = data if last - first == len(data) else data[first - start : last - start]
                yield PlainBytes(part, at_ns, self._lost)
                self._lost = 0
        self._written = max(self._written, end)

    def _bytes(self, first: int, last: int) -> bytes:
        return b"".join(
            data[max(0, first - start) : max(0, last - start)]
            for start, data, _ in self._held
            if start < last and start + len(data) > first
        )

    def _forget(self) -> None:
        needed_from = self._end - self._deframer.pending_bytes
        while self._held and self._held[0][0] + len(self._held[0][1]) <= needed_from:
            self._held.popleft()


_PICTURES: dict[str, type[RawImage] | type[CompressedImage]] = {
    RawImage.DESCRIPTOR.full_name: RawImage,
    CompressedImage.DESCRIPTOR.full_name: CompressedImage,
}


class Pictures:
    """The frames of a record, as they come, until they are named."""

    def __init__(self) -> None:
        self._kept: dict[int, RecordMessage] = {}

    def take(self, item: RecordMessage) -> bool:
        """Take a message if it is a frame; return whether it is."""
        if item.schema not in _PICTURES:
            return False
        self._kept[item.sequence] = item
        while len(self._kept) > FRAMES_KEPT:
            del self._kept[next(iter(self._kept))]
        return True

    def get(self, number: int) -> Picture | None:
        """Return the frame of a number, None without one; raises `RecordError` for damage."""
        item = self._kept.get(number)
        if item is None:
            return None
        try:
            picture: Picture = _PICTURES[item.schema].FromString(item.data)
        except DecodeError as problem:
            raise RecordError(f"frame {number} is damaged: {problem}") from problem
        return picture


def link_bytes(file: BinaryIO) -> Iterator[LinkBytes]:
    """Yield the bytes of every link; the file stands behind MCAP's first 8 bytes.

    Raises `RecordError` where the file ends early or is damaged, after what came before.
    """
    reading, pictures = McapReading(file, MCAP0_MAGIC), Pictures()
    for item in reading.items():
        if not isinstance(item, RecordMessage) or pictures.take(item):
            continue
        if item.topic == LINKS_TOPIC:
            yield _link_bytes(item, pictures)
    if reading.trouble:
        raise RecordError(reading.trouble)


def _link_bytes(item: RecordMessage, pictures: Pictures) -> LinkBytes:
    try:
        found = msgspec.msgpack.decode(item.data, type=LinkMessage)
    except msgspec.MsgspecError as problem:
        raise RecordError(f"damaged bytes of a link: {problem}") from problem
    data = found.data
    if found.frame:
        picture = pictures.get(found.frame)
        if picture is None:
            raise RecordError(f"bytes of link {found.link}: frame {found.frame} is missing")
        whole = b"".join((data[:-TRAILER_BYTES], picture.data, data[-TRAILER_BYTES:]))
        data = whole[max(0, found.skip) :]
    return LinkBytes(found.link, found.from_app, data, item.log_ns)
