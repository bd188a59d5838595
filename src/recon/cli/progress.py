"""Long work: a progress bar on standard error, and how many cores it may use."""

import os
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import BinaryIO, TypeVar

import rich.progress
from rich.console import Console
from rich.progress import track

from recon.cli.json_lines import report_facts, reported_over, wants_lines
from recon.record.mcap.mcap_read import Opener

Item = TypeVar("Item")


def progress_over(items: Iterable[Item], title: str, count: int) -> Iterator[Item]:
    """Yield the items, showing how many of `count` are done and how long the rest will take."""
    if wants_lines():
        yield from reported_over(items, title, count)
        return
    console = Console(stderr=True)
    yield from track(items, title, count, console=console, disable=not console.is_terminal)


def opener(title: str) -> Opener:
    """Return what opens a file for one pass, showing how much of it is read."""

    def open_shown(path: Path) -> AbstractContextManager[BinaryIO]:
        if wants_lines():
            report_facts(doing=title, share=None)
            return path.open("rb")
        console = Console(stderr=True)
        return rich.progress.open(
            path, "rb", description=title, console=console, disable=not console.is_terminal
        )

    return open_shown


def usable_cores() -> int:
    """Return how many cores this process may use; not all systems restrict them."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1
