"""An event loop whose time slows down where the machine is busy.

A station, its simulated apps and a client in one process keep deadlines of a second among
themselves. On a machine that gives the process a tenth of a core they miss them, and a test would
fail without a fault. Here all clocks of the process count at most `STEP_S` for whatever happened
between two of their readings: who was not given a core does not notice that time went by.
"""

import asyncio
import selectors
import threading
import time
from collections.abc import Coroutine
from typing import Any, TypeVar
from unittest.mock import patch

T = TypeVar("T")

STEP_S = 0.05
"""Shorter than every deadline of the station; a loop without work reads the clock as often."""


class PatientClock:
    """Monotonic seconds that advance with the loop's thread."""

    def __init__(self) -> None:
        self._monotonic = time.monotonic
        self._thread = threading.get_ident()
        self._read_at_s = self._shown_s = self._monotonic()

    def seconds(self) -> float:
        if threading.get_ident() == self._thread:
            now_s = self._monotonic()
            self._shown_s += min(now_s - self._read_at_s, STEP_S)
            self._read_at_s = now_s
        return self._shown_s

    def nanoseconds(self) -> int:
        return round(self.seconds() * 1e9)


class _WakingSelector(selectors.DefaultSelector):
    """Waits for `STEP_S` at most: idle time is counted in steps that the clock takes whole."""

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        return super().select(STEP_S if timeout is None else min(timeout, STEP_S))


def run_patiently(main: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end, as `asyncio.run`, in time that waits for this process."""
    clock = PatientClock()
    with (
        patch.multiple(time, monotonic=clock.seconds, monotonic_ns=clock.nanoseconds),
        asyncio.Runner(loop_factory=lambda: asyncio.SelectorEventLoop(_WakingSelector())) as runner,
    ):
        return runner.run(main)
