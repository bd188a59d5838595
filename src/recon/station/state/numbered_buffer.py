"""The newest of many things, numbered, so that what somebody has taken can be dropped later."""

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Tail(Generic[T]):
    """`items` are the kept ones; the first of them is number `first` of all that ever came."""

    items: tuple[T, ...] = ()
    first: int = 0

    @property
    def end(self) -> int:
        """The number of the next one to come."""
        return self.first + len(self.items)

    def with_one(self, item: T, kept: int) -> "Tail[T]":
        """Return it with one more; more than `kept` drop the oldest."""
        items = (*self.items, item)
        dropped = max(0, len(items) - kept)
        return Tail(items[dropped:], self.first + dropped)

    def from_number(self, number: int) -> "Tail[T]":
        """Return it without those before a number."""
        dropped = min(max(0, number - self.first), len(self.items))
        return Tail(self.items[dropped:], self.first + dropped)
