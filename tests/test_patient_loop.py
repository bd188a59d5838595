"""Time that waits for the process: idle time counts whole, stolen time does not."""

import asyncio
import time
from time import perf_counter

from tests.patient_loop import STEP_S, run_patiently


def test_idle_time_counts() -> None:
    async def main() -> float:
        begin_s = time.monotonic()
        await asyncio.sleep(0.3)
        return time.monotonic() - begin_s

    begin_s = perf_counter()
    slept_s = run_patiently(main())
    assert slept_s >= 0.3
    assert perf_counter() - begin_s >= slept_s - 1e-3


def test_a_deadline_is_not_missed_while_the_process_has_no_core() -> None:
    async def main() -> str:
        async with asyncio.timeout(0.2):
            blocked_until_s = perf_counter() + 0.5
            while perf_counter() < blocked_until_s:
                pass
            await asyncio.sleep(0)
        return "in time"

    assert run_patiently(main()) == "in time"


def test_both_clocks_are_one() -> None:
    async def main() -> float:
        seconds, nanoseconds = time.monotonic(), time.monotonic_ns()
        return nanoseconds / 1e9 - seconds

    assert 0.0 <= run_patiently(main()) <= STEP_S
    assert abs(time.monotonic() - time.monotonic_ns() / 1e9) < 60.0
