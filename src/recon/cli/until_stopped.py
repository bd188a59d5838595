"""Commands that go on until Ctrl+C or a polite kill."""

import asyncio
import contextlib
import signal
from collections.abc import Coroutine
from typing import Any


async def until_stopped(work: Coroutine[Any, Any, None], at_the_end: str) -> None:
    """Run `work` until it ends or the process is told to; both end with closed connections."""
    working = asyncio.ensure_future(work)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, working.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        await working
    say_at_once(at_the_end)


def say_at_once(line: str) -> None:
    """Print a line now, also into a pipe."""
    print(line, flush=True)
