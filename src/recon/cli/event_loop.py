"""Which event loop runs the station: uvloop, and asyncio's own where there is none (Windows)."""

import asyncio
from collections.abc import Coroutine
from importlib import import_module
from importlib.util import find_spec
from typing import Any


def run_in_loop(work: Coroutine[Any, Any, None]) -> None:
    """Run to the end in a fresh event loop."""
    if find_spec("uvloop") is None:
        asyncio.run(work)
    else:
        import_module("uvloop").run(work)
