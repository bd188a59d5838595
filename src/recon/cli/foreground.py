"""Commands that run in the foreground until Ctrl+C or SIGTERM."""

import asyncio
import contextlib
from collections.abc import Coroutine
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeVar

from recon.api.stop_signals import on_stop

T = TypeVar("T")


def run_in_loop(work: Coroutine[Any, Any, T]) -> T:
    """Run to the end in a new event loop: uvloop's, or asyncio's where it is missing (Windows)."""
    if find_spec("uvloop") is None:
        return asyncio.run(work)
    result: T = import_module("uvloop").run(work)
    return result


async def until_stopped(work: Coroutine[Any, Any, None], last_line: str) -> None:
    """Run `work` until it ends or a signal cancels it, then print the last line."""
    working = asyncio.ensure_future(work)
    on_stop(working.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        await working
    print_now(last_line)


def print_now(line: str) -> None:
    """Print a line without buffering, also into a pipe."""
    print(line, flush=True)
