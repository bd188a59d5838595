"""A progress bar on standard error; none where that is no terminal."""

from collections.abc import Iterable, Iterator
from typing import TypeVar

from rich.console import Console
from rich.progress import track

Item = TypeVar("Item")


def progress_over(items: Iterable[Item], title: str, count: int) -> Iterator[Item]:
    """Yield the items, showing how many of `count` are done and how long the rest will take."""
    console = Console(stderr=True)
    yield from track(items, title, count, console=console, disable=not console.is_terminal)
