"""What asks a process to stop: Ctrl+C and SIGTERM."""

import asyncio
import signal
from collections.abc import Callable


def on_stop(act: Callable[[], object]) -> None:
    """Call `act` in the running event loop at each Ctrl+C or SIGTERM from now on."""
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        try:
            loop.add_signal_handler(number, act)
        except NotImplementedError:  # Windows
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(act))
