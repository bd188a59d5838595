"""NaN and infinity never leave the station (NaN only as the wire's "no action")."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from math import isfinite
from numbers import Real
from typing import Any

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def finite_numbers(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command containing NaN or infinity."""
    for name, value in _numbers(command.body, ""):
        if not _is_finite(value):
            return Refusal(
                "finite_numbers",
                f"{name} must be a finite number; got {value}",
                parameters={"field": name, "value": str(value)},
            )
    return None


def _is_finite(value: Real | float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:  # an integer no float can hold
        return False


def _numbers(value: object, name: str) -> Iterator[tuple[str, Real | float]]:
    """Every number in a body, with the path to it."""
    if isinstance(value, (float, int, Real)):  # in this order: the abstract check is slow
        yield name, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value, start=1):
            yield from _numbers(item, f"{name} {index}")
    elif is_dataclass(value):
        for field in _field_names(value.__class__):
            yield from _numbers(getattr(value, field), f"{name} {field}".strip())


@cache
def _field_names(kind: type[Any]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))
