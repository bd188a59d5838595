"""Ctrl+C and SIGTERM reach the loop, also where it takes no signals itself."""

import asyncio
import signal
from collections.abc import Iterator

import pytest

from recon.api.stop_signals import on_stop

BOTH = (signal.SIGINT, signal.SIGTERM)


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    before = [signal.getsignal(number) for number in BOTH]
    yield
    for number, handler in zip(BOTH, before, strict=True):
        signal.signal(number, handler)


@pytest.mark.parametrize("number", BOTH)
@pytest.mark.parametrize("loop_takes_signals", [True, False])
def test_it_is_called_in_the_loop(number: signal.Signals, loop_takes_signals: bool) -> None:
    async def stopped() -> None:
        loop, is_stopped = asyncio.get_running_loop(), asyncio.Event()
        if not loop_takes_signals:
            loop.add_signal_handler = refuse  # type: ignore[method-assign]
        on_stop(is_stopped.set)
        signal.raise_signal(number)
        await asyncio.wait_for(is_stopped.wait(), 60.0)

    asyncio.run(stopped())


def refuse(*_: object) -> None:
    raise NotImplementedError
