"""All bytes of every link, in both directions, for the flight record."""

from collections.abc import Callable
from enum import IntEnum


class Direction(IntEnum):
    """Which way bytes went."""

    FROM_APP = 0
    TO_APP = 1


Tap = Callable[[int, Direction, bytes, int], None]
"""Called with the link, the direction, the bytes and the time in ns; must not wait."""
