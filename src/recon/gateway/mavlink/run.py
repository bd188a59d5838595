"""The shell around the step: a station's client on one side, sockets on the other.

The connection to the station counts as an operator's only while a client is there that may order:
when the last one has been silent for `SILENT_S`, steered orders end and their vehicles hold, and
the station's *operator gone* may act.
"""

import asyncio
import errno
import socket
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass

from recon.client import ClientError, RequestRefusedError, Station
from recon.gateway.contact import StationContact
from recon.gateway.endpoints import Endpoint, shown_endpoint
from recon.gateway.errors import GatewayError
from recon.gateway.mavlink.encoder import Encoder
from recon.gateway.mavlink.fence import FenceTooLongError, fence_items
from recon.gateway.mavlink.inputs_outputs import (
    CheckMission,
    FenceRead,
    Input,
    Output,
    PlaceOrder,
    ReadFence,
    Send,
    StationAnswered,
    StationSeen,
    TimePassed,
)
from recon.gateway.mavlink.peers import Peers, TcpClient, UdpSocket
from recon.gateway.mavlink.signing import Signer
from recon.gateway.mavlink.step import step
from recon.gateway.mavlink.values import GatewaySettings, GatewayState
from recon.model.command import GoTo, Refusal

STATE_WITHIN_S = 0.25
OPENS_WITHIN_S = 2.0
VEHICLES_AT_ONCE = 8


@dataclass(frozen=True, slots=True)
class Endpoints:
    """Where the gateway listens, and where it sends on its own."""

    tcp: Sequence[Endpoint] = ()
    udp: Sequence[Endpoint] = ()
    udp_to: Sequence[Endpoint] = ()


@contextmanager
def _opening(option: str, place: Endpoint) -> Iterator[None]:
    """Raise `GatewayError`, with what to do, where a socket cannot be opened."""
    try:
        yield
    except (OSError, OverflowError) as problem:
        reason: object = problem
        if isinstance(problem, OSError):
            is_taken = problem.errno == errno.EADDRINUSE
            reason = "in use, perhaps by another gateway" if is_taken else problem.strerror
        raise GatewayError(
            f"cannot open {shown_endpoint(place)} ({reason}); choose another with {option}"
        ) from problem


async def _udp_socket(local: Endpoint | None, remote: Endpoint | None) -> socket.socket:
    """Return a socket bound to one place or sending to the other; raises `OSError`.

    Opened here: uvloop's own error does not say why, and leaves its socket open.
    """
    place = local or remote
    assert place is not None
    loop, kind = asyncio.get_running_loop(), socket.SOCK_DGRAM
    family, *_, address = (await loop.getaddrinfo(*place, type=kind))[0]
    opened = socket.socket(family, kind)
    opened.setblocking(False)
    try:
        if local is None:
            opened.connect(address)
        else:
            opened.bind(address)
    except OSError:
        opened.close()
        raise
    return opened


class MavlinkGateway:
    """A running gateway of one station; `station` is connected and no operator yet."""

    def __init__(
        self,
        station: Station,
        settings: GatewaySettings,
        signer: Signer | None = None,
        say: Callable[[str], None] = lambda line: None,
    ) -> None:
        """`say` takes a line whenever the station has become unreachable, or is back."""
        self._station = station
        self._say = say
        self._state = GatewayState(settings)
        self._encoder = Encoder(signer)
        self.peers = Peers(self.handle, signer)
        self._sockets: list[UdpSocket] = []
        self._asked: set[asyncio.Task[None]] = set()
        self._is_operator = False
        self.places: list[Endpoint] = []
        """Where clients connect, with the ports that were picked."""

    @asynccontextmanager
    async def listening(self, at: Endpoints) -> AsyncIterator[None]:
        """Open the sockets; raises `GatewayError`."""
        async with AsyncExitStack() as stack:
            for place in at.tcp:
                with _opening("--tcp", place):
                    await self._open_tcp(stack, place)
            for place in at.udp:
                with _opening("--udp", place):
                    await self._open_udp(stack, local=place)
            for place in at.udp_to:
                with _opening("--udp-to", place):
                    await self._open_udp(stack, remote=place)
            yield

    async def _open_tcp(self, stack: AsyncExitStack, place: Endpoint) -> None:
        loop = asyncio.get_running_loop()
        server = await loop.create_server(lambda: TcpClient(self.peers), *place)
        stack.callback(server.close)
        self.places.append(server.sockets[0].getsockname()[:2])

    async def _open_udp(
        self, stack: AsyncExitStack, local: Endpoint | None = None, remote: Endpoint | None = None
    ) -> None:
        opened = await _udp_socket(local, remote)
        transport, udp = await asyncio.get_running_loop().create_datagram_endpoint(
            lambda: UdpSocket(self.peers, remote), sock=opened
        )
        stack.callback(transport.close)
        self._sockets.append(udp)
        if local is not None:
            self.places.append(transport.get_extra_info("sockname")[:2])

    async def run(self) -> None:
        """Pass states on until cancelled; raises the `ClientError` that ends the stream."""
        number, contact, newest_s = 0, StationContact(), time.monotonic()
        while True:
            seen = await self._station.next_state(number, STATE_WITHIN_S)
            if seen is None:
                self.handle(TimePassed())
            else:
                state, age_s = seen
                number, newest_s = state.number, time.monotonic() - age_s
                await self._show(StationSeen(state.message, age_s))
            line = contact.change(newest_s, time.monotonic())
            if line is not None:
                self._say(line)
            for udp in self._sockets:
                udp.drop_silent(time.monotonic())
            await self._count_as_operator()

    async def _show(self, seen: StationSeen) -> None:
        """Step, and send a few vehicles at a time: a client's order waits for no fleet."""
        self._state, outputs = step(self._state, seen, time.monotonic_ns())
        for number, output in enumerate(outputs, start=1):
            self._carry_out(output)
            if number % VEHICLES_AT_ONCE == 0:
                await asyncio.sleep(0)

    def handle(self, given: Input) -> None:
        """Step, and carry out what comes of it."""
        self._state, outputs = step(self._state, given, time.monotonic_ns())
        for output in outputs:
            self._carry_out(output)

    def _carry_out(self, output: Output) -> None:
        match output:
            case Send(system_id, messages, peer):
                frames = self._encoder.encode(system_id, messages, time.time())
                self.peers.send(frames, peer)
            case PlaceOrder(token):
                self._ask(token, lambda: self._order(output))
            case CheckMission(token):
                self._ask(token, lambda: self._check(output))
            case ReadFence(token):
                self._ask(token, lambda: self._fence(token))

    def _ask(self, token: int, work: Callable[[], Awaitable[Input]]) -> None:
        """Ask the station beside the loop; its answer, or what went wrong, is an input."""

        async def asking() -> None:
            try:
                self.handle(await work())
            except RequestRefusedError as problem:
                # Not carried out: the person's role is too low, or the login has ended.
                self.handle(StationAnswered(token, Refusal("login", str(problem))))
            except ClientError as problem:
                self.handle(StationAnswered(token, problem=str(problem)))

        task = asyncio.create_task(asking())
        self._asked.add(task)
        task.add_done_callback(self._asked.discard)

    async def _order(self, placed: PlaceOrder) -> Input:
        if isinstance(placed.body, GoTo):
            await self._until_operator()
        answer = await self._station.order(placed.serial, placed.body, takeoff=placed.takeoff)
        if isinstance(answer, Refusal):
            return StationAnswered(placed.token, answer)
        return StationAnswered(placed.token, command_id=answer.command_id)

    async def _check(self, asked: CheckMission) -> Input:
        # May it take off? Asked as if: whether it may is a question of its start.
        vehicle = self._station.known(asked.serial)
        return StationAnswered(asked.token, await vehicle.would_fly(asked.mission, takeoff=True))

    async def _fence(self, token: int) -> Input:
        try:
            drawing = await self._station.site.drawing()
            zones = await self._station.zones.in_force()
            return FenceRead(token, fence_items(drawing.features, zones))
        except (ClientError, FenceTooLongError) as problem:
            return FenceRead(token, problem=f"Fence not read: {problem}")

    async def _count_as_operator(self) -> None:
        allowed = self._state.settings.allow_orders
        is_operator = allowed and self.peers.heard_since(time.monotonic())
        if is_operator != self._is_operator:
            self._is_operator = is_operator
            await self._station.act_as_operator(is_operator)

    async def _until_operator(self) -> None:
        """Wait a little until steered orders can depend on this connection."""
        given_up_s = time.monotonic() + OPENS_WITHIN_S
        while not self._station.takes_steered_orders and time.monotonic() < given_up_s:
            await asyncio.sleep(0.02)
