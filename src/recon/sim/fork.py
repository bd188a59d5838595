"""Forks of a simulated world: from one moment on, two worlds that never touch each other.

A world is all that one object reaches: driver, sessions, apps, aircraft, random generators. A fork
shares with its original what cannot change, frozen dataclasses and packets above all, and copies
the rest. So it costs milliseconds, however much the station's state remembers.
"""

import pickle
from copy import copy
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from io import BytesIO
from types import CellType, FunctionType, MappingProxyType, ModuleType
from typing import Any, TypeVar

import numpy as np

from recon import wire

WorldT = TypeVar("WorldT")

SHARED = (Enum, type, type(None), np.dtype, MappingProxyType, ModuleType)


def fork(world: WorldT) -> WorldT:
    """Return a copy of a world: the same state to the bit, and nothing that changes in common.

    Whatever the world was about to do, the fork does too. Closures are copied with what they
    captured. Raises `TypeError` for what has no copy: a socket, a file, a lock, a generator.
    """
    data = BytesIO()
    pickler = _Pickler(data)
    pickler.dump(world)
    data.seek(0)
    forked: WorldT = _Unpickler(data, pickler.aside).load()
    return forked


class _Pickler(pickle.Pickler):
    """Takes a world apart, and puts aside what is not."""

    def __init__(self, data: BytesIO) -> None:
        super().__init__(data, pickle.HIGHEST_PROTOCOL)
        self.aside: list[Any] = []
        self._numbers: dict[int, int] = {}

    def persistent_id(self, value: Any) -> int | None:
        """Return the number of a value that is put aside, None for one that is taken apart."""
        if isinstance(value, wire.Deframer):
            return self._put_aside(value, copy(value))
        return self._put_aside(value, value) if _is_shared(value) else None

    def reducer_override(self, value: Any) -> Any:
        """Take closures apart, which pickle does not."""
        if isinstance(value, FunctionType):
            return _with_cells, (_Code(value), value.__closure__)
        if isinstance(value, CellType):
            return CellType, (), (value.cell_contents,), None, None, _fill
        return NotImplemented

    def _put_aside(self, value: Any, in_fork: Any) -> int:
        number = self._numbers.setdefault(id(value), len(self.aside))
        if number == len(self.aside):
            self.aside.append(in_fork)
        return number


class _Unpickler(pickle.Unpickler):
    def __init__(self, data: BytesIO, aside: list[Any]) -> None:
        super().__init__(data)
        self._aside = aside

    def persistent_load(self, number: Any) -> Any:
        return self._aside[number]


@dataclass(frozen=True, slots=True, eq=False)
class _Code:
    """A function whose captured variables are replaced."""

    function: FunctionType


def _with_cells(code: _Code, cells: tuple[CellType, ...]) -> FunctionType:
    old = code.function
    new = FunctionType(old.__code__, old.__globals__, old.__name__, old.__defaults__, cells)
    new.__kwdefaults__ = old.__kwdefaults__
    return new


def _fill(cell: CellType, state: tuple[Any]) -> None:
    (cell.cell_contents,) = state


def _is_shared(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return not value.flags.writeable
    if isinstance(value, FunctionType):
        return value.__closure__ is None
    kind: Any = type(value)
    return _is_frozen(kind) and all(_is_shared(getattr(value, f)) for f in _functions(kind))


@cache
def _functions(kind: Any) -> tuple[str, ...]:
    """Fields of a frozen dataclass that hold a function: what it captured may change."""
    found = fields(kind) if is_dataclass(kind) else ()
    return tuple(each.name for each in found if "Callable" in str(each.type))


@cache
def _is_frozen(kind: type) -> bool:
    """Whether instances of a type never change: packets are frozen, but for the deframer."""
    if issubclass(kind, SHARED):
        return True
    if kind.__module__ == wire.__name__:
        return kind is not wire.Deframer
    return is_dataclass(kind) and kind.__dataclass_params__.frozen  # type: ignore[attr-defined]
