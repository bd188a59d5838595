"""What the station hands to the process that writes its record, and what that reports.

One item is a head (`HEAD`: kind, bytes that follow) and its content.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import msgspec

HEAD = struct.Struct("<BI")
LINK_HEAD = struct.Struct("<IBqQ")
"""Link, whether from the app, time, and bytes from the app before these."""
STEP_HEAD = struct.Struct("<QqH")
"""Number, time, bytes of the vehicle's name, which follow; then the step."""

COMPRESSION = 1
"""Zstandard's level: fast, because frames are most of a record."""
BULK_BYTES = 16 * 1024
"""Size of a read from which its bytes are part of an image."""


class ItemKind(IntEnum):
    """What an item is."""

    BEGIN = 0
    """A new file; its `Beginning`."""
    FLOWN = 1
    """A vehicle has taken off: the file is a flight's."""
    LINK = 2
    STEP = 3
    SHADE = 4
    SUN = 5
    KEYFRAME = 6
    """The station's state, with a step's head."""


class Beginning(msgspec.Struct, frozen=True):
    """The beginning of a file."""

    at_ns: int
    start: bytes
    about: bytes


class TimedValue(msgspec.Struct, frozen=True):
    """A value of a topic by the codec."""

    at_ns: int
    value: Any


@dataclass(frozen=True, slots=True)
class Item:
    """One item as it came."""

    kind: ItemKind
    content: bytes


def packed(kind: ItemKind, *parts: bytes) -> tuple[bytes, ...]:
    """Return an item as the bytes to be sent."""
    return HEAD.pack(kind, sum(map(len, parts))), *parts


class Status(msgspec.Struct, frozen=True):
    """What the station learns of the process."""

    path: str | None = None
    """The file that is being written."""
    problem: str | None = None
    """What is not recorded, and why; None while everything is."""
    cpu_s: float = 0.0
    repaired: tuple[str, ...] = ()
    """Files of earlier runs that were finished at the start."""
