"""A gateway between a real station with simulated apps and real clients, on loopback sockets."""

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import common as mavlink
from tests.client.running_station import background, running_station

from recon.client import Station
from recon.gateway.mavlink.run import Endpoints, MavlinkGateway
from recon.gateway.mavlink.signing import Signer
from recon.gateway.mavlink.values import GatewaySettings

PATIENCE_S = 30.0
GCS, GCS_COMPONENT = 255, 190


@dataclass(slots=True)
class RunningGateway:
    """A gateway, its station, and where clients connect."""

    gateway: MavlinkGateway
    station: Station
    port: int
    """TCP."""
    udp_port: int


@asynccontextmanager
async def running_gateway(
    settings: GatewaySettings | None = None,
    *,
    key: bytes | None = None,
    udp_to: tuple[tuple[str, int], ...] = (),
    url: str | None = None,
    token: str | None = None,
    **station: Any,
) -> AsyncIterator[RunningGateway]:
    """Run a gateway of a station of its own, or of one at an address."""
    if url is None:
        async with (
            running_station(token=token, **station) as address,
            running_gateway(settings, key=key, udp_to=udp_to, url=address, token=token) as running,
        ):
            yield running
        return
    async with Station(url, token, is_operator=False) as client:
        signer = None if key is None else Signer(key)
        gateway = MavlinkGateway(client, settings or GatewaySettings(), signer)
        endpoints = Endpoints((("127.0.0.1", 0),), (("127.0.0.1", 0),), udp_to)
        async with gateway.listening(endpoints), background(gateway.run()):
            (_host, port), (_host, udp_port) = gateway.places
            yield RunningGateway(gateway, client, port, udp_port)


class Client:
    """A ground station of pymavlink's codec on asyncio, for the tests of this process."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer
        self.mav = mavlink.MAVLink(None, srcSystem=GCS, srcComponent=GCS_COMPONENT)
        self.mav.robust_parsing = True
        self.received: list[Any] = []
        """Every message that was looked at since the client connected."""
        self._waiting: deque[Any] = deque()

    def send(self, message: Any) -> None:
        """Send one message."""
        self._writer.write(message.pack(self.mav))
        self.mav.seq = (self.mav.seq + 1) % 256

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self._writer.write(data)

    async def until(self, *names: str, of: int = 1, where: Callable[[Any], bool] = bool) -> Any:
        """Return the next message of these names from a vehicle."""
        async with asyncio.timeout(PATIENCE_S):
            while True:
                while self._waiting:
                    message = self._waiting.popleft()
                    self.received.append(message)
                    mine = message.get_type() in names and message.get_srcSystem() == of
                    if mine and where(message):
                        return message
                data = await self._reader.read(4096)
                if not data:
                    raise ConnectionError("the gateway has closed the connection")
                self._waiting += self.mav.parse_buffer(data) or ()

    async def command(self, number: int, *params: float, target: int = 1) -> tuple[int, str]:
        """Send a COMMAND_LONG; return the result and the sentence that came with it."""
        full = (*params, *(0.0,) * (7 - len(params)))
        self.send(mavlink.MAVLink_command_long_message(target, 1, number, 0, *full))
        return await self.answer("COMMAND_ACK", target)

    async def answer(self, name: str, target: int = 1) -> tuple[int, str]:
        """Return the result of the next answer, and the sentence before it."""
        begun = len(self.received)
        ack = await self.until(name, of=target)
        texts = [m for m in self.received[begun:] if m.get_type() == "STATUSTEXT"]
        sentence = "".join(text.text.rstrip("\0") for text in texts)
        return (ack.result if name == "COMMAND_ACK" else ack.type), sentence

    async def close(self) -> None:
        """Close the connection."""
        self._writer.close()


@asynccontextmanager
async def connected(running: RunningGateway) -> AsyncIterator[Client]:
    """Connect a client by TCP."""
    client = Client(*await asyncio.open_connection("127.0.0.1", running.port))
    try:
        yield client
    finally:
        await client.close()
