"""The stream on a real server: fresh for a fast reader, bounded towards one that does not read."""

import asyncio
import contextlib

import pytest
import websockets
from tests.api.fake_station import FakeStation
from tests.api.serving import PATIENCE_S, BigStation, connected, streaming
from tests.patient_loop import run_patiently

from recon.api import streams as stream_module
from recon.api.schema import StationState
from recon.api.security import PROTOCOL


def test_a_fast_reader_gets_one_state_after_another() -> None:
    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), streaming(FakeStation()) as address:
            url = f"{address}/api/stream"
            async with websockets.connect(url, subprotocols=[PROTOCOL]) as reader:
                for _ in range(5):
                    StationState.model_validate_json(await reader.recv())

    run_patiently(main())


def test_states_are_made_once_for_all_readers() -> None:
    async def main() -> None:
        station = FakeStation()
        async with (
            asyncio.timeout(PATIENCE_S),
            streaming(station) as address,
            contextlib.AsyncExitStack() as stack,
        ):
            url = f"{address}/api/stream"
            readers = [await stack.enter_async_context(websockets.connect(url)) for _ in range(8)]
            for _ in range(10):
                for reader in readers:
                    await reader.recv()
            assert station.states_made < 8 * 10 / 2

    run_patiently(main())


def test_a_reader_that_does_not_read_is_sent_the_present_not_the_past() -> None:
    """What waits for it is bounded; when it reads again it skips what it missed."""

    async def main() -> None:
        station = BigStation()
        async with asyncio.timeout(PATIENCE_S), streaming(station) as address:
            url = f"{address}/api/stream"
            async with (
                websockets.connect(
                    url, sock=await connected(url), max_queue=1, compression=None, max_size=None
                ) as slow,
                websockets.connect(url, max_size=None) as fast,
            ):
                made_first = StationState.model_validate_json(await fast.recv()).time_ns
                for _ in range(40):
                    newest = StationState.model_validate_json(await fast.recv()).time_ns
                assert newest - made_first >= 30
                waiting = [StationState.model_validate_json(await slow.recv()).time_ns]
                while waiting[-1] < newest:
                    waiting.append(StationState.model_validate_json(await slow.recv()).time_ns)
                # Three that the client holds, one that the server was sending, and the present.
                assert len(waiting) <= 5

    run_patiently(main())


def test_readers_beyond_the_limit_are_refused_and_places_come_free() -> None:
    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), streaming(FakeStation()) as address:
            url = f"{address}/api/stream"
            async with contextlib.AsyncExitStack() as stack:
                for _ in range(stream_module.MAX_STATE_READERS):
                    reader = await stack.enter_async_context(websockets.connect(url))
                    await reader.recv()
                async with websockets.connect(url) as refused:
                    with pytest.raises(websockets.ConnectionClosed) as closed:
                        await refused.recv()
                assert closed.value.rcvd is not None
                assert closed.value.rcvd.code == 1013
                assert closed.value.rcvd.reason == "32 readers are connected: limit reached"
            while True:
                try:
                    async with websockets.connect(url) as reader:
                        await reader.recv()
                    return
                except websockets.ConnectionClosed:
                    continue

    run_patiently(main())
