"""A digest of any frozen value: two values have the same one when they are the same to the bit."""

import dataclasses
from collections.abc import Callable, Mapping, Set
from enum import Enum
from hashlib import blake2b
from typing import Any
from zlib import crc32

import numpy as np

DIGEST_BYTES = 16
LARGE_BYTES = 4096
"""From here on an array enters by its CRC: four times faster, and accidents do not forge one."""


def digest(value: Any) -> bytes:
    """Return the digest of a value of dataclasses, collections, arrays, numbers and text.

    Of other objects only the type counts: they hold prepared forms of what stands beside them.
    """
    state = blake2b(digest_size=DIGEST_BYTES)
    _feed(value, state.update)
    return state.digest()


def _feed(value: Any, update: Callable[[Any], None]) -> None:
    kind = type(value)
    if isinstance(value, np.generic):
        # The codec reads a number back as Python's own.
        update(f"{value.item()!r};".encode())
    elif value is None or kind in (bool, int, float, str):
        update(f"{value!r};".encode())
    elif isinstance(value, np.ndarray):
        update(f"{value.dtype.str}{value.shape};".encode())
        data = np.ascontiguousarray(value).data
        update(data if value.nbytes < LARGE_BYTES else b"%d;" % crc32(data))
    elif kind is bytes:
        update(b"%d;" % len(value))
        update(value)
    elif isinstance(value, Enum):
        update(f"{kind.__name__}.{value.name};".encode())
    elif isinstance(value, Mapping):
        update(b"{%d;" % len(value))
        for key, part in value.items():
            _feed(key, update)
            _feed(part, update)
    elif isinstance(value, tuple | list):
        update(b"[%d;" % len(value))
        for part in value:
            _feed(part, update)
    elif isinstance(value, Set):
        for part in sorted(repr(each) for each in value):
            update(part.encode())
    else:
        update(f"{kind.__name__};".encode())
        if dataclasses.is_dataclass(kind):
            for each in dataclasses.fields(kind):
                _feed(getattr(value, each.name), update)
