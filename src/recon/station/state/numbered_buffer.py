"""The newest of many items, numbered, so that those already processed can be dropped later."""

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class NumberedBuffer(Generic[T]):
    """`items` are those kept; the first of them has the number `first` of all that ever came."""

    items: tuple[T, ...] = ()
    first: int = 0

    @property
    def end(self) -> int:
        """The number of the next item."""
        return self.first + len(self.items)

    def with_one(self, item: T, kept: int) -> "NumberedBuffer[T]":
        """Return it with one more; beyond `kept` items the oldest are dropped."""
        items = (*self.items, item)
        dropped = max(0, len(items) - kept)
        return NumberedBuffer(items[dropped:], self.first + dropped)

    def from_number(self, number: int) -> "NumberedBuffer[T]":
        """Return it without the items before a number."""
        dropped = min(max(0, number - self.first), len(self.items))
        return NumberedBuffer(self.items[dropped:], self.first + dropped)
