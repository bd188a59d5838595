"""Readers of the values of a JSON object that a stranger wrote: strict types and bounds.

A reader takes a decoded value and returns the model's value, or raises WrongValueError with what it
expected. A boolean is no number, and a number no text: nothing is converted.
"""

from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any

Reader = Callable[[Any], Any]


class WrongValueError(ValueError):
    """What was expected of a value, and what came."""


def number(least: float, most: float) -> Reader:
    """Return a reader of a finite number of these bounds, as a float."""

    def read(value: Any) -> float:
        # A NaN is within no bounds, and a whole number of 4,000 digits is compared exactly.
        if _is_number(value) and least <= value <= most:
            return float(value)
        raise WrongValueError(f"a number from {least:g} to {most:g}")

    return read


def integer(least: int, most: int) -> Reader:
    """Return a reader of a whole number of these bounds; 3.0 is none."""

    def read(value: Any) -> int:
        if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
            return value
        raise WrongValueError(f"a whole number from {least} to {most}")

    return read


def flag(value: Any) -> bool:
    """Read a boolean."""
    if isinstance(value, bool):
        return value
    raise WrongValueError("true or false")


def text(longest: int, cleaned: Callable[[bytes, int], str]) -> Reader:
    """Return a reader of a text of at most `longest` characters, sanitised by `cleaned`."""

    def read(value: Any) -> str:
        if isinstance(value, str) and len(value) <= longest:
            return cleaned(value.encode("utf-8", "backslashreplace"), 4 * longest)
        raise WrongValueError(f"a text of at most {longest} characters")

    return read


def word(*words: str) -> Reader:
    """Return a reader of one of these words."""

    def read(value: Any) -> str:
        if isinstance(value, str) and value in words:
            return value
        raise WrongValueError(f"one of {', '.join(words)}")

    return read


def member(kind: type[Enum]) -> Reader:
    """Return a reader of the member whose value is the text."""
    read_word = word(*(each.value for each in kind))
    return lambda value: kind(read_word(value))


def many(each: Reader, least: int, most: int) -> Reader:
    """Return a reader of a list of `least` to `most` values."""

    def read(value: Any) -> tuple[Any, ...]:
        if isinstance(value, list) and least <= len(value) <= most:
            return tuple(map(each, value))
        raise WrongValueError(f"a list of {least} to {most} values")

    return read


def known(kind: type[Enum], most: int) -> Reader:
    """Return a reader of a list of words that skips those of a newer app."""
    texts = many(text(32, lambda raw, _limit: raw.decode("utf-8")), 0, most)
    members = {each.value: each for each in kind}
    return lambda value: tuple(members[name] for name in texts(value) if name in members)


def fields(
    found: Any, readers: Mapping[str, Reader], required: frozenset[str] = frozenset()
) -> dict[str, Any]:
    """Return the values of the keys that `readers` names; other keys are ignored.

    A key without a value, or with null, is left out; WrongValueError is raised for a required one
    and for the first value that its reader refuses.
    """
    if not isinstance(found, dict):
        raise WrongValueError("an object")
    values = {}
    for name, read in readers.items():
        value = found.get(name)
        if value is None:
            if name in required:
                raise WrongValueError(f"`{name}`, which is required")
            continue
        try:
            values[name] = read(value)
        except WrongValueError as wrong:
            raise WrongValueError(f"`{name}` to be {wrong}") from None
    return values


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
