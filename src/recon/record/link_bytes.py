"""The raw bytes of the links in a flight record."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import msgspec
from mcap.writer import MCAP0_MAGIC

from recon.model.errors import RecordError
from recon.record.mcap_read import McapReading, RecordMessage

LINKS_TOPIC = "/recon/link_bytes"


class LinkMessage(msgspec.Struct, frozen=True):
    """A message of that topic: what came by one read, or left by one write."""

    link: int
    from_app: bool
    data: bytes


@dataclass(frozen=True, slots=True)
class LinkBytes:
    """Bytes of one link, and when they came or left."""

    link_id: int
    is_from_app: bool
    data: bytes
    at_ns: int


def link_bytes(file: BinaryIO) -> Iterator[LinkBytes]:
    """Yield the bytes of every link; the file stands behind MCAP's first 8 bytes.

    Raises `RecordError` where the file ends early or is damaged, after what came before.
    """
    reading = McapReading(file, MCAP0_MAGIC)
    for item in reading.items():
        if isinstance(item, RecordMessage) and item.topic == LINKS_TOPIC:
            try:
                found = msgspec.msgpack.decode(item.data, type=LinkMessage)
            except msgspec.MsgspecError as problem:
                raise RecordError(f"damaged bytes of a link: {problem}") from problem
            yield LinkBytes(found.link, found.from_app, found.data, item.log_ns)
    if reading.trouble:
        raise RecordError(reading.trouble)
