"""One number for all that a run in virtual time was: every event, and the station at its end."""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import fields, is_dataclass
from enum import Enum
from hashlib import sha256

import numpy as np

from recon.station.kernel.virtual import VirtualDriver
from recon.station.state.steps import StepTaken


class RunDigest:
    """Listens to a driver; to be put there before anything happens."""

    def __init__(self, driver: VirtualDriver) -> None:
        self._driver = driver
        self._hash = sha256()
        self.events = 0
        driver.observe = self._take

    def value(self) -> str:
        """Return the number so far, the present state included."""
        whole = self._hash.copy()
        for part in parts_of(self._driver.station):
            whole.update(part)
        return whole.hexdigest()[:32]

    def _take(self, step: StepTaken) -> None:
        self.events += 1
        self._hash.update(str(self._driver.now_ns).encode())
        for part in parts_of(step.event):
            self._hash.update(part)


def parts_of(value: object) -> Iterator[bytes]:
    """Yield everything a value is made of, to the last bit of its numbers and pictures.

    What a dataclass excludes from its `repr` is excluded; sets are sorted. Raises TypeError
    for what it has no rule for: nothing is passed over in silence.
    """
    match value:
        case None | bool() | int() | float() | str() | bytes() | Enum():
            yield repr(value).encode()
        case np.ndarray():
            yield f"{value.dtype}{value.shape}".encode()
            yield np.ascontiguousarray(value).tobytes()
        case np.generic():
            yield repr(value.item()).encode()
        case Mapping():
            for key, one in value.items():
                yield from parts_of(key)
                yield from parts_of(one)
        case Set():
            yield from sorted(b"".join(parts_of(one)) for one in value)
        case Sequence():
            yield f"{type(value).__name__}{len(value)}".encode()
            for one in value:
                yield from parts_of(one)
        case _ if is_dataclass(value):
            yield type(value).__name__.encode()
            for field in fields(value):
                if field.repr:
                    yield from parts_of(getattr(value, field.name))
        case _:
            raise TypeError(f"expected a value made of plain parts, got {type(value)}")
