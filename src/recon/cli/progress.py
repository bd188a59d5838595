"""Long work: a progress bar on standard error, and how many cores it may use."""

import os
from collections.abc import Iterable, Iterator
from typing import TypeVar

from rich.console import Console
from rich.progress import track

Item = TypeVar("Item")


def progress_over(items: Iterable[Item], title: str, count: int) -> Iterator[Item]:
    """Yield the items, showing how many of `count` are done and how long the rest will take."""
    console = Console(stderr=True)
    yield from track(items, title, count, console=console, disable=not console.is_terminal)


def usable_cores() -> int:
    """Return how many cores this process may use; not all systems restrict them."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1
