"""Foxglove clients on real sockets: they come and go, are slow or hostile; the station leaves."""

import asyncio
import fcntl
import json
import os
import socket
import termios
import time
from array import array
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import pytest
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from foxglove_schemas_protobuf.Log_pb2 import Log
from tests.client.running_station import HOME, running_station
from tests.gateway.foxglove_client import (
    PATIENCE_S,
    FoxgloveClient,
    foxglove_client,
    running_foxglove,
)
from tests.patient_loop import run_patiently
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.typing import Subprotocol

from recon.client import Staleness, Station, TemporaryZoneStatus
from recon.gateway.errors import GatewayError
from recon.gateway.foxglove.live_message import LOG, LiveMessage
from recon.gateway.foxglove.live_topics import BACKLOG, LiveTopics
from recon.gateway.foxglove.run import FoxgloveGateway
from recon.model.geo import LatLon
from recon.model.temporary_zone import Circle, TemporaryZoneKind

KINDS = ["boundary", "pad", "pad", "temporary_zone"]
SENT = 4 * BACKLOG
FIRST, SECOND = "/vehicles/SIM-1/location", "/vehicles/SIM-2/location"


def test_clients_come_and_go_and_may_do_nothing() -> None:
    async def main() -> None:
        async with (
            running_station() as url,
            running_foxglove(url) as running,
            foxglove_client(running.port) as stays,
        ):
            await stays.until(FIRST, 2)
            assert stays.info["capabilities"] == []
            async with foxglove_client(running.port, "/state") as comes:
                (message,) = (await comes.until("/vehicles/SIM-2/state"))[:1]
                state = json.loads(message.data)
                assert (state["name"], state["is_flying"]) == ("SIM-2", True)
                assert comes.schema("/vehicles/SIM-2/state")[1] == "recon.VehicleState"
                assert set(comes.received) == {"/vehicles/SIM-1/state", "/vehicles/SIM-2/state"}
            # A late one is shown what it cannot have seen.
            circle = Circle(LatLon(HOME.latitude_deg, HOME.longitude_deg + 0.01), 20.0)
            drawn = await running.station.zones.draw(TemporaryZoneKind.PERSON, circle, "a fence")
            assert isinstance(drawn, TemporaryZoneStatus)
            async with foxglove_client(running.port, "/site") as late:
                shapes: list[Any] = []
                while [each["properties"]["kind"] for each in shapes] != KINDS:
                    found = await late.until("/site", len(late.received["/site"]) + 1)
                    shapes = json.loads(GeoJSON.FromString(found[-1].data).geojson)["features"]
                ring = [list(each) for each in drawn.ring]
                assert shapes[-1]["geometry"] == {"type": "Polygon", "coordinates": [ring]}
            await refused(stays)
            await stays.until(FIRST, len(stays.received[FIRST]) + 2)
            assert not await running.station.commands()

    run_patiently(main())


async def refused(client: FoxgloveClient) -> None:
    """Ask for all that the protocol knows besides reading."""
    channel = {"id": 1, "topic": "/x", "encoding": "json", "schemaName": ""}
    await client.send(op="advertise", channels=[channel])
    await client.send(op="setParameters", parameters=[{"name": "x", "value": 1}])
    await client.send(op="subscribeConnectionGraph")
    await client.send(op="fetchAsset", uri="file:///etc/passwd", requestId=1)
    async with asyncio.timeout(PATIENCE_S):
        while len(client.statuses) < 4:
            await client.read()
    assert all("does not support" in each for each in client.statuses)


def test_hostile_and_slow_clients_disturb_no_other() -> None:
    async def main() -> None:
        async with (
            running_station(vehicles=1) as url,
            running_foxglove(url) as running,
            foxglove_client(running.port) as good,
            # It subscribes, then reads no more.
            foxglove_client(running.port, max_queue=1) as slow,
        ):
            await slow.until(FIRST)
            slow.socket.transport.pause_reading()
            await garbage(running.port)
            await closed(running.port, b"x" * (17 << 20))
            many = [{"id": n, "channelId": 100 + n} for n in range(1000)]
            await closed(running.port, json.dumps({"op": "subscribe", "subscriptions": many}))
            with pytest.raises(InvalidStatus):
                async with connect(
                    f"ws://127.0.0.1:{running.port}", subprotocols=[Subprotocol("other")]
                ):
                    pass
            begun = len(good.received[FIRST])
            await good.until(FIRST, begun + 5)
            slow.socket.transport.abort()

    run_patiently(main())


async def garbage(port: int) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(os.urandom(5000))
    with suppress(ConnectionError):
        assert b"101 Switching" not in await reader.read()
    writer.close()


async def closed(port: int, message: str | bytes) -> None:
    """Send a message to which the server closes the connection."""
    async with foxglove_client(port, "nothing") as client:
        with pytest.raises(ConnectionClosed):
            await sent_until_closed(client, message)


async def sent_until_closed(client: FoxgloveClient, message: str | bytes) -> None:
    await client.socket.send(message)
    async with asyncio.timeout(PATIENCE_S):
        while True:
            await client.read()


@asynccontextmanager
async def slow_client() -> AsyncIterator[tuple[LiveTopics, int, FoxgloveClient]]:
    """Topics, their port, and a client that is subscribed to the log and no longer reads."""
    topics = LiveTopics()
    _host, port = topics.start(("127.0.0.1", 0))
    topics.wants("/log", LOG)
    async with foxglove_client(port, max_queue=1) as slow:
        while not topics.wants("/log", LOG):
            with suppress(TimeoutError):
                async with asyncio.timeout(0.05):
                    await slow.read()
        slow.socket.transport.pause_reading()
        yield topics, port, slow
        slow.socket.transport.abort()


def flood(topics: LiveTopics, count: int, size: int) -> None:
    for number in range(count):
        topics.publish(LiveMessage("/log", LOG, number, b"\0" * size))


def test_the_newest_messages_wait_for_a_client_that_does_not_read() -> None:
    async def main() -> None:
        async with slow_client() as (topics, _port, slow):
            flood(topics, SENT, 50_000)
            slow.socket.transport.resume_reading()
            received = slow.received["/log"]
            async with asyncio.timeout(PATIENCE_S):
                while not received or received[-1].at_ns < SENT - 1:
                    await slow.read()
            await topics.stop()
            assert len(received) < SENT
            newest = [each.at_ns for each in received[-BACKLOG:]]
            assert newest == list(range(SENT - BACKLOG, SENT))

    asyncio.run(main())


def test_a_client_that_does_not_read_does_not_delay_the_end() -> None:
    async def main() -> None:
        async with slow_client() as (topics, port, slow):
            flood(topics, 64, 1_000_000)
            connection = slow.socket.transport.get_extra_info("socket")
            waiting = [-1, 0]
            # Until its socket takes no more.
            while waiting[-1] != waiting[-2]:
                waiting.append(await asyncio.to_thread(_bytes_waiting, connection.fileno()))
            async with asyncio.timeout(PATIENCE_S):
                await topics.stop()
            with pytest.raises(OSError, match="Connect call failed"):
                await asyncio.open_connection("127.0.0.1", port)

    asyncio.run(main())


def _bytes_waiting(descriptor: int) -> int:
    time.sleep(0.1)
    return int(array("i", fcntl.ioctl(descriptor, termios.FIONREAD, b"\0" * 4))[0])


def test_a_lost_vehicles_topics_stop() -> None:
    async def main() -> None:
        faults = ("telemetry-dropout:SIM-1:1:60",)
        async with (
            running_station(faults=faults) as url,
            running_foxglove(url) as running,
            foxglove_client(running.port, "/location", "/state") as client,
        ):
            await client.until(FIRST)
            gone = Staleness.LOST, Staleness.SILENT
            while not any(v.staleness in gone for v in running.station.vehicles()):
                await client.read()
            begun = {topic: len(each) for topic, each in client.received.items()}
            await client.until(SECOND, begun[SECOND] + 5)
            assert len(client.received[FIRST]) == begun[FIRST]
            state = "/vehicles/SIM-1/state"
            assert len(client.received[state]) == begun[state]

    run_patiently(main())


@dataclass(slots=True)
class Cable:
    """What can be pulled between the gateway and its station."""

    port: int
    is_plugged: bool = True
    _writers: list[asyncio.StreamWriter] = field(default_factory=list)

    def pull(self) -> None:
        self.is_plugged = False
        for writer in self._writers:
            writer.transport.abort()

    async def carry(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if not self.is_plugged:
            writer.transport.abort()
            return
        there_reader, there = await asyncio.open_connection("127.0.0.1", self.port)
        self._writers += [writer, there]
        await asyncio.gather(_copy(reader, there), _copy(there_reader, writer))


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with suppress(ConnectionError):
        while data := await reader.read(65_536):
            writer.write(data)
        writer.close()


@asynccontextmanager
async def cable(url: str) -> AsyncIterator[tuple[Cable, str]]:
    """Carry connections to a station; yield the cable and the address at its other end."""
    between = Cable(int(url.rpartition(":")[2]))
    server = await asyncio.start_server(between.carry, "127.0.0.1", 0)
    yield between, f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    between.pull()
    server.close()


def test_topics_stop_while_the_station_is_gone_and_it_is_said() -> None:
    async def main() -> None:
        async with (
            running_station(vehicles=1) as direct,
            cable(direct) as (between, url),
            running_foxglove(url) as running,
            foxglove_client(running.port) as client,
        ):
            await client.until(FIRST, 2)
            between.pull()
            await client.until("/log", len(client.received["/log"]) + 1)
            (line,) = running.lines
            assert line.startswith("station unreachable since ")
            gone = {topic: len(each) for topic, each in client.received.items()}
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(0.5):
                    await client.read()
            assert {topic: len(each) for topic, each in client.received.items()} == gone
            between.is_plugged = True
            await client.until(FIRST, gone[FIRST] + 2)
            assert running.lines[1].startswith("station connected again at ")
            lines = [Log.FromString(each.data) for each in client.received["/log"]]
            assert [each.message for each in lines if each.name == "gateway"] == running.lines

    run_patiently(main())


def test_a_taken_port_is_one_sentence() -> None:
    async def main() -> None:
        gateway = FoxgloveGateway(Station("http://127.0.0.1:1"), print)
        with socket.create_server(("127.0.0.1", 0)) as other:
            place = other.getsockname()
            with pytest.raises(GatewayError) as refused:
                async with gateway.listening(place):
                    pass
        assert str(refused.value) == (
            f"cannot open 127.0.0.1:{place[1]} (in use, perhaps by another gateway); "
            "choose another with --listen"
        )

    asyncio.run(main())
