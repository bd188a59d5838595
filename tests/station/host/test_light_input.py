"""Loggers on real sockets and files: what they send becomes events, and nothing else does."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack, suppress
from pathlib import Path

import pytest

from recon.model.event import Event
from recon.model.geo import LatLon
from recon.model.light import LightRead, LightReading
from recon.station.host import light_input
from recon.station.host.http_servers import StartError
from recon.station.host.light_input import MOST_LOGGERS, start_light_input

WITHIN_S = 10.0
HEAD = "time,gate\nlat,41.9\nlon,-93.6\n"


def listening(where: str, work: Callable[[str, list[LightRead]], Awaitable[None]]) -> None:
    """Run a test beside the input of a station."""

    async def run() -> None:
        events: list[LightRead] = []
        OPEN.clear()

        def handle(event: Event) -> None:
            assert isinstance(event, LightRead)
            events.append(event)

        async with AsyncExitStack() as stack:
            address = await start_light_input(where, None, handle, stack)
            await asyncio.wait_for(work(address, events), WITHIN_S)
            for writer in OPEN:
                writer.transport.abort()
                with suppress(OSError):
                    await writer.wait_closed()
            OPEN.clear()

    asyncio.run(run())


async def until(is_so: Callable[[], bool]) -> None:
    while not is_so():
        await asyncio.sleep(0.005)


def values(events: list[LightRead]) -> list[float]:
    return [reading.value for each in events for reading in each.readings]


OPEN: list[asyncio.StreamWriter] = []


async def connected(address: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    host, port = address.removeprefix("tcp://").rsplit(":", 1)
    reader, writer = await asyncio.open_connection(host, int(port))
    OPEN.append(writer)
    return reader, writer


def test_a_logger_by_tcp_is_read_and_a_bad_line_of_it_answered() -> None:
    async def work(address: str, events: list[LightRead]) -> None:
        reader, writer = await connected(address)
        writer.write(HEAD.encode() + b"1750000000,800\nnonsense,1\n1750000001,790\n")
        answer = await reader.readline()
        assert answer.startswith(b"line 5: expected a time in ISO 8601 or Unix seconds")
        await until(lambda: len(values(events)) == 2)
        place = LatLon(41.9, -93.6)
        assert events[0].readings[0] == LightReading("gate", 1_750_000_000 * 10**9, 800.0, place)
        assert events[0].source == "127.0.0.1"

    listening("tcp://127.0.0.1:0", work)


def test_a_flood_of_one_logger_does_not_keep_another_from_being_heard() -> None:
    async def work(address: str, events: list[LightRead]) -> None:
        _reader, flood = await connected(address)
        flood.write(b"x" * 2_000_000 + b"\n,\n" * 100_000)
        _reader, writer = await connected(address)
        writer.write(HEAD.encode() + b"1750000000,800\n")
        await until(lambda: values(events) == [800.0])

    listening("tcp://127.0.0.1:0", work)


def test_one_logger_too_many_is_answered_unless_one_is_idle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def work(address: str, events: list[LightRead]) -> None:
        open_ones = [await connected(address) for _ in range(MOST_LOGGERS)]
        reader, _writer = await connected(address)
        assert b"no more fit" in await reader.readline()
        monkeypatch.setattr(light_input, "IDLE_S", 0.0)
        _reader, writer = await connected(address)
        writer.write(HEAD.encode() + b"1750000000,800\n")
        await until(lambda: values(events) == [800.0])
        with suppress(ConnectionResetError):
            assert await open_ones[0][0].readline() == b""

    listening("tcp://127.0.0.1:0", work)


def test_a_file_is_followed_from_its_end_with_the_places_of_its_head(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(light_input, "FILE_EVERY_S", 0.01)
    path = tmp_path / "logger.csv"
    path.write_text(HEAD + "1750000000,1\n" * 3_000)

    async def work(address: str, events: list[LightRead]) -> None:
        assert address == str(path)
        number = 0
        while not events:  # written after the station has seen the file for the first time
            number += 1
            with path.open("a") as file:
                file.write(f"175000{number:04},{800 + number}\n")
            await asyncio.sleep(0.05)
        assert min(values(events)) > 800.0
        assert events[0].readings[0].place == LatLon(41.9, -93.6)
        path.write_text("time,oak\n1750000009,5\n")
        await until(lambda: values(events)[-1] == 5.0)

    listening(str(path), work)


@pytest.mark.parametrize("where", ["tcp://4002", "tcp://host", "tcp://h:x", "tcp://h:4002/a"])
def test_an_address_that_is_none_is_one_sentence(where: str) -> None:
    async def work(_address: str, _events: list[LightRead]) -> None:
        raise AssertionError

    with pytest.raises(StartError, match="expected a CSV file or an address to listen on"):
        listening(where, work)


@pytest.mark.parametrize("where", ["udp://0.0.0.0:4002", "tcp:4002", ".", "/no/such/folder/a.csv"])
def test_what_no_logger_can_append_to_is_one_sentence_and_not_waited_for(where: str) -> None:
    async def work(_address: str, _events: list[LightRead]) -> None:
        raise AssertionError

    with pytest.raises(StartError, match="expected a CSV file in a folder that exists, or tcp://"):
        listening(where, work)
