"""The raw bytes of the links in a flight record, each frame in it once.

A frame's pixels, or its JPEG, are in the topic of its images; the bytes of its link refer to them
and hold what is around them. Read together they are the link's bytes exactly.

`LinkStream` holds the bytes of one app until the step of their packet comes: it states where the
packet begins and ends, and whether it is an image. Bytes that have waited `HALF_FRAME_S` are
written as they are, so that a power cut does not cost them; the rest of that frame refers to the
image.
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
from recon.record.mcap.mcap_read import McapReading, RecordMessage

LINKS_TOPIC = "/recon/link_bytes"
HALF_FRAME_S = 0.25

TRAILER_BYTES = 2

ImagePacket = wire.Image | wire.CompressedImage
Picture = RawImage | CompressedImage


class LinkMessage(msgspec.Struct, frozen=True, omit_defaults=True):
    """A message of that topic: what came by one read, or left by one write.

    With a `frame`, `data` is around that image's payload, the last two bytes behind it, and the
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
    size_bytes: int
    """Size of the whole packet."""
    at_ns: int
    lost: int = 0
    """Bytes before these that never came here."""


@dataclass(frozen=True, slots=True)
class PlainBytes:
    """Bytes that are recorded as they are; `lost` ones before them never came here."""

    data: bytes
    at_ns: int
    lost: int = 0


class LinkStream:
    """The bytes from one app, in the order they came; what was written is kept for its image."""

    def __init__(self) -> None:
        self._held = bytearray()
        self._start = self._written = self._lost = 0
        self._reads: deque[tuple[int, int]] = deque()
        """End and time of each read that is not wholly written."""

    @property
    def held_bytes(self) -> int:
        """Memory taken."""
        return len(self._held)

    @property
    def _end(self) -> int:
        return self._start + len(self._held)

    def take(self, start: int, data: bytes, at_ns: int) -> Iterator[PlainBytes]:
        """Take one read that begins at byte `start` of the link; yield what is before a gap."""
        if start != self._end:
            yield from self.rest()
            self._lost += max(0, start - self._end)
            self._held.clear()
            self._start = self._written = start
        self._held += data
        self._reads.append((self._end, at_ns))

    def packet(self, end: int) -> Iterator[PlainBytes]:
        """Yield the reads that are over with a packet that is no image."""
        while self._reads and self._reads[0][0] <= end:
            yield from self._written_up_to(self._reads[0][0])
        self._forget_before(end)

    def image(self, start: int, end: int, at_ns: int) -> Iterator[PlainBytes | FrameBytes]:
        """Yield an image packet and what is before it; no frame where some of it never came."""
        packet = self._image(start, end)
        if packet is None:
            yield from self.packet(end)
            return
        yield from self._written_up_to(start)
        tail = end - self._start
        head = tail - TRAILER_BYTES - _payload_bytes(packet)
        around = self._held[start - self._start : head] + self._held[tail - TRAILER_BYTES : tail]
        skip = max(0, self._written - start)
        lost, self._lost = self._lost, 0
        self._written = max(self._written, end)
        while self._reads and self._reads[0][0] <= end:
            self._reads.popleft()
        self._forget_before(end)
        yield FrameBytes(packet, bytes(around), skip, end - start, at_ns, lost)

    def overdue(self, now_ns: int) -> Iterator[PlainBytes]:
        """Yield bytes that have waited too long for the end of their packet."""
        if self._reads and now_ns - self._reads[0][1] >= seconds_to_ns(HALF_FRAME_S):
            yield from self.rest()

    def rest(self) -> Iterator[PlainBytes]:
        """Yield what is held: the link has ended, or the file."""
        yield from self._written_up_to(self._end)

    def forget(self) -> Iterator[PlainBytes]:
        """Yield what is held and keep nothing: its memory is needed."""
        yield from self.rest()
        self._forget_before(self._end)

    def _image(self, start: int, end: int) -> ImagePacket | None:
        if not self._start <= start <= end <= self._end:
            return None
        try:
            packet = wire.decode(bytes(self._held[start - self._start : end - self._start]))
        except wire.WireError:
            return None
        return packet if isinstance(packet, ImagePacket) else None

    def _written_up_to(self, end: int) -> Iterator[PlainBytes]:
        while self._written < end:
            read_end, at_ns = self._reads[0]
            first, last = self._written - self._start, min(read_end, end) - self._start
            part = PlainBytes(bytes(self._held[first:last]), at_ns, self._lost)
            self._written, self._lost = self._start + last, 0
            if self._written == read_end:
                self._reads.popleft()
            yield part

    def _forget_before(self, end: int) -> None:
        count = max(0, min(end, self._written) - self._start)
        del self._held[:count]
        self._start += count


def _payload_bytes(packet: ImagePacket) -> int:
    return packet.pixels.nbytes if isinstance(packet, wire.Image) else len(packet.jpeg)


_PICTURES: dict[str, type[RawImage] | type[CompressedImage]] = {
    RawImage.DESCRIPTOR.full_name: RawImage,
    CompressedImage.DESCRIPTOR.full_name: CompressedImage,
}


class Pictures:
    """The newest frame of a record: its bytes and its step are right behind it."""

    def __init__(self) -> None:
        self._newest: RecordMessage | None = None

    def take(self, item: RecordMessage) -> bool:
        """Take a message if it is a frame; return whether it is."""
        if item.schema not in _PICTURES:
            return False
        self._newest = item
        return True

    def get(self, number: int) -> Picture | None:
        """Return the frame of a number, None without one; raises `RecordError` for damage."""
        item = self._newest
        if item is None or item.sequence != number:
            return None
        try:
            picture: Picture = _PICTURES[item.schema].FromString(item.data)
        except DecodeError as problem:
            raise RecordError(f"frame {number} is damaged: {problem}") from problem
        return picture


def link_bytes(file: BinaryIO) -> Iterator[LinkBytes]:
    """Yield the bytes of every link; the file is positioned behind MCAP's first 8 bytes.

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
