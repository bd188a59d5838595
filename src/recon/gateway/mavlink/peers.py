"""The clients of the gateway: sockets, bytes in and out. Nothing is decided here.

TCP and UDP clients connect to the gateway; to UDP targets it sends on its own. At most `MAX_PEERS`
have a place. A TCP client that does not read loses its connection, a UDP client that is silent
for `SILENT_S` its place. What is not MAVLink, or not signed where it must be, is dropped: it gets
no answer and no place. One read or datagram at a time is taken, so others have their turn.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from recon.gateway.mavlink.frames import MAX_FAULTS, FrameReader, MavlinkFrame
from recon.gateway.mavlink.inputs_outputs import Input, MessageReceived, PeerGone
from recon.gateway.mavlink.signing import Signer
from recon.gateway.mavlink.values import Sender

MAX_PEERS = 16
SILENT_S = 10.0
READ_BYTES = 4096
MAX_WAITING_BYTES = 256 * 1024
"""Of one client: some seconds of 64 vehicles."""
DATAGRAM_BYTES = 1200
"""Fits every network's packets."""
MESSAGES_PER_S = 500.0
"""Of one client; the protocol needs a few dozen. Further ones are dropped."""


@dataclass(slots=True)
class GatewayPeer:
    """One client. `write` takes whole frames."""

    number: int
    write: Callable[[list[bytes]], None]
    reader: FrameReader = field(default_factory=FrameReader)
    heard_s: float = 0.0
    """Monotonic time of its newest accepted message; 0: none."""
    _left: float = MESSAGES_PER_S
    _counted_s: float = 0.0

    def may_say_more(self, now_s: float) -> bool:
        """Return whether another message of it is taken: so many a second, on average."""
        grown = (now_s - self._counted_s) * MESSAGES_PER_S
        self._left, self._counted_s = min(MESSAGES_PER_S, self._left + grown), now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class Peers:
    """All clients. `handle` takes what the step is to know."""

    def __init__(self, handle: Callable[[Input], None], signer: Signer | None = None) -> None:
        self._handle, self._signer = handle, signer
        self._peers: dict[int, GatewayPeer] = {}
        self._numbers = count(1)
        self.dropped = 0
        """Messages that were not signed as they must be, or too many."""

    @property
    def is_full(self) -> bool:
        """Whether there is no place for another client."""
        return len(self._peers) >= MAX_PEERS

    def add(self, write: Callable[[list[bytes]], None]) -> GatewayPeer:
        """Give a client a place."""
        peer = GatewayPeer(next(self._numbers), write)
        self._peers[peer.number] = peer
        return peer

    def remove(self, peer: GatewayPeer) -> None:
        """Take a client's place away."""
        if self._peers.pop(peer.number, None) is not None:
            self._handle(PeerGone(peer.number))

    def send(self, frames: list[bytes], number: int | None) -> None:
        """Send frames to one client, or to all."""
        if number is None:
            for peer in tuple(self._peers.values()):
                peer.write(frames)
        elif (one := self._peers.get(number)) is not None:
            one.write(frames)

    def heard_since(self, now_s: float) -> bool:
        """Return whether any client has said anything within `SILENT_S`."""
        return any(p.heard_s and now_s - p.heard_s < SILENT_S for p in self._peers.values())

    def accepted(self, frames: list[MavlinkFrame]) -> list[MavlinkFrame]:
        """Return the frames that are signed as they must be."""
        if self._signer is None:
            return frames
        now_s = time.time()
        good = [frame for frame in frames if self._signer.accepts(frame, now_s)]
        self.dropped += len(frames) - len(good)
        return good

    def received(self, peer: GatewayPeer, frames: list[MavlinkFrame]) -> None:
        """Take the accepted messages of a client."""
        now_s = time.monotonic()
        for frame in frames:
            if not peer.may_say_more(now_s):
                self.dropped += 1
                continue
            peer.heard_s = now_s
            message = frame.message
            sender = Sender(peer.number, message.get_srcSystem(), message.get_srcComponent())
            self._handle(MessageReceived(sender, message))


class TcpClient(asyncio.BufferedProtocol):
    """One TCP connection."""

    def __init__(self, peers: Peers) -> None:
        self._peers = peers
        self._buffer = bytearray(READ_BYTES)
        self._peer: GatewayPeer | None = None
        self._transport: Any = None

    def connection_made(self, transport: Any) -> None:
        """Give the client a place, or close."""
        self._transport = transport
        if self._peers.is_full:
            transport.abort()
            return
        self._peer = self._peers.add(self._write)

    def get_buffer(self, sizehint: int) -> bytearray:
        """Return where the next bytes are written."""
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Take what was read; close what is no MAVLink."""
        if self._peer is None:
            return
        frames = self._peer.reader.read(bytes(self._buffer[:nbytes]))
        self._peers.received(self._peer, self._peers.accepted(frames))
        if self._peer.reader.faults > MAX_FAULTS:
            self._transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Take the client's place away."""
        if self._peer is not None:
            self._peers.remove(self._peer)
            self._peer = None

    def _write(self, frames: list[bytes]) -> None:
        if self._transport.get_write_buffer_size() > MAX_WAITING_BYTES:
            self._transport.abort()
            return
        self._transport.write(b"".join(frames))


class UdpSocket(asyncio.DatagramProtocol):
    """A UDP socket: with a target one client, which is always sent to; else those that write."""

    def __init__(self, peers: Peers, target: tuple[str, int] | None) -> None:
        self._peers, self._target = peers, target
        self._known: dict[Any, GatewayPeer] = {}
        self._transport: Any = None

    def connection_made(self, transport: Any) -> None:
        """Give the target its place."""
        self._transport = transport
        if self._target is not None:
            self._known[None] = self._peers.add(lambda frames: self._write(frames, None))

    def datagram_received(self, data: bytes, addr: Any) -> None:
        """Take a datagram; its sender gets a place by a message that is accepted."""
        key = None if self._target is not None else addr
        frames = self._peers.accepted(FrameReader().read(data))
        if not frames:
            return
        peer = self._known.get(key)
        if peer is None:
            if self._peers.is_full:
                return
            peer = self._known[key] = self._peers.add(lambda sent: self._write(sent, key))
        self._peers.received(peer, frames)

    def drop_silent(self, now_s: float) -> None:
        """Take the places of clients away that have said nothing for long."""
        for key, peer in tuple(self._known.items()):
            if key is not None and now_s - peer.heard_s > SILENT_S:
                del self._known[key]
                self._peers.remove(peer)

    def error_received(self, exc: Exception) -> None:
        """Ignore that nobody listens at an address; somebody may later."""

    def _write(self, frames: list[bytes], address: Any) -> None:
        if self._transport.get_write_buffer_size() > MAX_WAITING_BYTES:
            return
        datagram = b""
        for frame in frames:
            if datagram and len(datagram) + len(frame) > DATAGRAM_BYTES:
                self._transport.sendto(datagram, address)
                datagram = b""
            datagram += frame
        self._transport.sendto(datagram, address)
