"""A client of the Foxglove WebSocket protocol as its specification has it, and a gateway for it."""

import asyncio
import base64
import json
import struct
from collections import defaultdict
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

from tests.client.running_station import background
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from recon.client import Station
from recon.gateway.foxglove.run import FoxgloveGateway

SUBPROTOCOL = Subprotocol("foxglove.sdk.v1")
PATIENCE_S = 30.0
MESSAGE_HEAD = struct.Struct("<BIQ")
MESSAGE_DATA = 1


@dataclass(slots=True)
class Received:
    """A message: its time and its bytes."""

    at_ns: int
    data: bytes


@dataclass(slots=True)
class FoxgloveClient:
    """One connection; it subscribes to what it is told to, and keeps all that comes."""

    socket: ClientConnection
    wanted: frozenset[str]
    """Topics, or ends of topics."""
    info: dict[str, Any] = field(default_factory=dict)
    channels: dict[str, dict[str, Any]] = field(default_factory=dict)
    received: dict[str, list[Received]] = field(default_factory=lambda: defaultdict(list))
    statuses: list[str] = field(default_factory=list)
    _topics: dict[int, str] = field(default_factory=dict)

    async def until(self, topic: str, count: int = 1) -> list[Received]:
        """Return a topic's messages once there are so many."""
        async with asyncio.timeout(PATIENCE_S):
            while len(self.received[topic]) < count:
                await self.read()
        return self.received[topic]

    async def read(self) -> None:
        """Take one message of the server."""
        data = await self.socket.recv()
        if isinstance(data, bytes):
            kind, subscription, at_ns = MESSAGE_HEAD.unpack_from(data)
            assert kind == MESSAGE_DATA
            self.received[self._topics[subscription]].append(Received(at_ns, data[13:]))
            return
        message = json.loads(data)
        match message["op"]:
            case "serverInfo":
                self.info = message
            case "advertise":
                for channel in message["channels"]:
                    self.channels[channel["topic"]] = channel
                    await self._subscribe(channel)
            case "status":
                self.statuses.append(message["message"])
            case other:
                raise AssertionError(other)

    async def send(self, **message: Any) -> None:
        """Send a JSON message."""
        await self.socket.send(json.dumps(message))

    def schema(self, topic: str) -> tuple[str, str, bytes]:
        """Encoding, name and bytes of a topic's schema."""
        channel = self.channels[topic]
        data = channel["schema"]
        is_binary = channel["schemaEncoding"] == "protobuf"
        content = base64.b64decode(data) if is_binary else data.encode()
        return channel["encoding"], channel["schemaName"], content

    async def _subscribe(self, channel: dict[str, Any]) -> None:
        if any(channel["topic"].endswith(end) for end in self.wanted):
            self._topics[channel["id"]] = channel["topic"]
            one = {"id": channel["id"], "channelId": channel["id"]}
            await self.send(op="subscribe", subscriptions=[one])


@asynccontextmanager
async def foxglove_client(port: int, *wanted: str, **options: Any) -> AsyncIterator[FoxgloveClient]:
    """Connect a client that wants topics with these ends; none: all."""
    url = f"ws://127.0.0.1:{port}"
    options = {"max_size": None, "compression": None} | options
    async with connect(url, subprotocols=[SUBPROTOCOL], **options) as socket:
        yield FoxgloveClient(socket, frozenset(wanted or {""}))


@dataclass(slots=True)
class RunningFoxglove:
    """A gateway, its station's client, its port, and the lines it has printed."""

    station: Station
    port: int
    lines: list[str]


@asynccontextmanager
async def running_foxglove(url: str) -> AsyncIterator[RunningFoxglove]:
    """Run a gateway of a station at an address."""
    lines: list[str] = []
    async with Station(url, is_operator=False) as station:
        gateway = FoxgloveGateway(station, lines.append)
        async with gateway.listening(("127.0.0.1", 0)) as (_host, port), background(gateway.run()):
            yield RunningFoxglove(station, port, lines)
