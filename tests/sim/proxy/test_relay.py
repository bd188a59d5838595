"""The proxy on real sockets: every wait is for an event, with a limit."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

import pytest

from recon.sim.errors import SimulationError
from recon.sim.proxy import Damage, ProxyConfig, Towards, run_proxy
from recon.sim.proxy.damage import MOST_HELD_BYTES

LIMIT_S = 120.0
HERE = "127.0.0.1"
Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]


class Bench:
    """A station, a proxy before it, and one app's connection through both."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.port = 0
        self._accepted: asyncio.Queue[Streams] = asyncio.Queue()

    async def accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await self._accepted.put((reader, writer))

    async def connected(self) -> tuple[Streams, Streams]:
        """Return an app's new connection, and the station's end of it."""
        app = await asyncio.open_connection(HERE, self.port)
        return app, await self._accepted.get()


@asynccontextmanager
async def proxied(damage: Damage, **settings: object) -> AsyncIterator[Bench]:
    bench, is_listening = Bench(), asyncio.Event()

    def started(port: int) -> None:
        bench.port = port
        is_listening.set()

    async with asyncio.timeout(LIMIT_S):
        station = await asyncio.start_server(bench.accept, HERE, 0)
        place = (HERE, station.sockets[0].getsockname()[1])
        config = ProxyConfig(listen=(HERE, 0), station=place, damage=damage, **settings)
        passing = asyncio.create_task(run_proxy(config, bench.lines.append, started))
        await is_listening.wait()
        try:
            yield bench
        finally:
            passing.cancel()
            with suppress(asyncio.CancelledError):
                await passing
            station.close()


async def hang_up(*ends: Streams) -> None:
    for _, writer in ends:
        writer.close()
        with suppress(OSError):
            await writer.wait_closed()


def test_a_good_link_passes_both_ways_and_ends_as_it_was_ended() -> None:
    async def scenario() -> None:
        async with proxied(Damage()) as bench:
            app, station = await bench.connected()
            app[1].write(b"telemetry")
            assert await station[0].readexactly(9) == b"telemetry"
            station[1].write(b"command")
            assert await app[0].readexactly(7) == b"command"
            app[1].write_eof()
            assert await station[0].read() == b""
            station[1].write(b"the last word")
            station[1].write_eof()
            assert await app[0].read() == b"the last word"
            await hang_up(app, station)

    asyncio.run(scenario())


def test_a_delay_is_felt_in_the_damaged_direction_alone() -> None:
    async def scenario() -> None:
        damage = Damage(delay_s=0.3)
        async with proxied(damage, towards=Towards.STATION) as bench:
            app, station = await bench.connected()
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            station[1].write(b"at once")
            await app[0].readexactly(7)
            undamaged_s = loop.time() - began_s
            began_s = loop.time()
            app[1].write(b"late")
            await station[0].readexactly(4)
            assert loop.time() - began_s >= 0.3 > undamaged_s
            await hang_up(app, station)

    asyncio.run(scenario())


def test_bytes_are_changed_and_none_is_lost() -> None:
    async def scenario() -> bytes:
        async with proxied(Damage(corrupted_per_mb=10_000.0), seed=3) as bench:
            app, station = await bench.connected()
            app[1].write(bytes(100_000))
            data = await station[0].readexactly(100_000)
            await hang_up(app, station)
            return data

    one, other = asyncio.run(scenario()), asyncio.run(scenario())
    assert 100_000 - one.count(0) == pytest.approx(1_000, rel=0.2)
    # How reads are cut differs from run to run; which bytes change does not.
    assert one == other


def test_a_reset_is_an_error_on_both_sides() -> None:
    async def scenario() -> None:
        async with proxied(Damage(resets_per_min=600.0)) as bench:
            app, station = await bench.connected()
            for reader, _ in (app, station):
                with pytest.raises(ConnectionResetError):
                    await reader.readexactly(1)
            await hang_up(app, station)
            assert any("reset after" in line for line in bench.lines)

    asyncio.run(scenario())


def test_without_a_station_the_app_is_not_kept_waiting() -> None:
    async def scenario() -> None:
        port = asyncio.get_running_loop().create_future()
        lines: list[str] = []
        config = ProxyConfig(listen=(HERE, 0), station=(HERE, 1))
        async with asyncio.timeout(LIMIT_S):
            passing = asyncio.create_task(run_proxy(config, lines.append, port.set_result))
            app = await asyncio.open_connection(HERE, await port)
            with suppress(ConnectionResetError):
                assert await app[0].read() == b""
            passing.cancel()
            with suppress(asyncio.CancelledError):
                await passing
        await hang_up(app)
        assert any("no station" in line for line in lines)

    asyncio.run(scenario())


def test_a_sender_that_is_faster_than_the_link_is_made_to_wait() -> None:
    async def scenario() -> None:
        async with proxied(Damage(rate_bytes_per_s=1_000.0)) as bench:
            app, station = await bench.connected()
            sent = 16 * MOST_HELD_BYTES
            app[1].write(bytes(sent))
            drained = asyncio.ensure_future(app[1].drain())
            await station[0].readexactly(1_400)
            # The first bytes are through, and most of the others still wait at the sender.
            assert not drained.done()
            assert app[1].transport.get_write_buffer_size() > sent // 2
            drained.cancel()
            app[1].transport.abort()
            await hang_up(station)

    asyncio.run(scenario())


def test_its_end_closes_what_is_open() -> None:
    async def scenario() -> None:
        async with proxied(Damage(delay_s=30.0)) as bench:
            app, station = await bench.connected()
            app[1].write(b"never arrives")
            await app[1].drain()
        async with asyncio.timeout(LIMIT_S):
            with suppress(ConnectionResetError):
                assert await app[0].read() == b""
            with suppress(ConnectionResetError):
                assert await station[0].read() == b""
        await hang_up(app, station)

    asyncio.run(scenario())


def test_an_address_in_use_is_reported() -> None:
    async def scenario() -> None:
        async with proxied(Damage()) as bench:
            config = ProxyConfig(listen=(HERE, bench.port), station=(HERE, 1))
            with pytest.raises(SimulationError, match="expected a free address"):
                await run_proxy(config)

    asyncio.run(scenario())
