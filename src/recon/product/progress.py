"""How long work shows its progress, without knowing where."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

Item = TypeVar("Item")
Over = Callable[[Iterable[Any], str, int], Iterator[Any]]
"""Shows progress over items: items, title, how many."""


def plainly(items: Iterable[Item], _title: str, _count: int) -> Iterator[Item]:
    """Yield the items without showing progress."""
    yield from items
