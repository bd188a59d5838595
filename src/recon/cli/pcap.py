"""TCP streams of a network capture, pcap or pcapng: what tcpdump, Wireshark or a router wrote.

Hostile as any file: nothing is allocated by a size that it states, streams and what waits for a
missing segment are bounded. After a gap that is never filled, the stream goes on behind it.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from ipaddress import ip_address
from typing import BinaryIO, NamedTuple

PCAPNG = b"\x0a\x0d\x0d\x0a"
MOST_PACKET_BYTES = 256 * 1024
"""What tcpdump takes of one packet by default."""
MOST_STREAMS = 4096
MOST_WAITING_BYTES = 4 * 1024 * 1024

ETHERNET, NULL, SLL, SLL2 = 1, 0, 113, 276
RAW = (12, 14, 101, 228, 229)
_VLAN, _IPV4, _IPV6, _TCP = (0x8100, 0x88A8), 0x0800, 0x86DD, 6
_SYN = 0x02
_MAGIC = {
    b"\xd4\xc3\xb2\xa1": ("<", 1000),
    b"\xa1\xb2\xc3\xd4": (">", 1000),
    b"\x4d\x3c\xb2\xa1": ("<", 1),
    b"\xa1\xb2\x3c\x4d": (">", 1),
}


class PcapError(Exception):
    """The file is no capture, or damaged: what was expected and what came."""


class TcpSegment(NamedTuple):
    """Bytes of one TCP stream in their order."""

    stream: str
    """From which address to which."""
    time_ns: int
    data: bytes


class _Packet(NamedTuple):
    link_type: int
    time_ns: int
    data: bytes


@dataclass(slots=True)
class _Stream:
    """What of a stream was seen: the next byte's number, and what waits behind a gap."""

    next: int | None = None
    waiting: dict[int, bytes] = field(default_factory=dict)

    def take(self, seq: int, is_syn: bool, data: bytes) -> bytes:
        """Return what follows in order now."""
        if is_syn:
            self.next, self.waiting = (seq + 1) % 2**32, {}
            return b""
        if not data:
            return b""
        if self.next is None:
            self.next = seq
        self.waiting[seq] = max(self.waiting.get(seq, b""), data, key=len)
        ready = self._ready()
        if sum(map(len, self.waiting.values())) > MOST_WAITING_BYTES:
            ready += self.skip_gap()
        return ready

    def skip_gap(self) -> bytes:
        """Return what waits, the first gap left out."""
        if not self.waiting or self.next is None:
            return b""
        here = self.next
        self.next = min(self.waiting, key=lambda seq: (seq - here) % 2**32)
        return self._ready()

    def _ready(self) -> bytes:
        parts = []
        progress = True
        while progress and self.next is not None:
            progress = False
            for seq in sorted(self.waiting, key=self._ahead):
                ahead = self._ahead(seq)
                if ahead > 0:
                    break
                new = self.waiting.pop(seq)[-ahead:]
                if new:
                    parts.append(new)
                    self.next = (self.next + len(new)) % 2**32
                    progress = True
        return b"".join(parts)

    def _ahead(self, seq: int) -> int:
        """How many bytes after the next one a number is; negative for what was seen."""
        assert self.next is not None
        return (seq - self.next + 2**31) % 2**32 - 2**31


def is_pcap(start: bytes) -> bool:
    """Return whether a file that begins so is a network capture."""
    return start[:4] in _MAGIC or start[:4] == PCAPNG


def tcp_segments(file: BinaryIO, start: bytes) -> Iterator[TcpSegment]:
    """Yield the bytes of every TCP stream; `start` are the 4 bytes read already.

    Raises `PcapError` for a damaged file, after what came before.
    """
    streams: dict[str, _Stream] = {}
    time_ns = 0
    packets = _pcapng(file) if start == PCAPNG else _pcap(file, *_MAGIC[start])
    for packet in packets:
        time_ns = packet.time_ns
        found = _tcp(packet)
        if found is None:
            continue
        name, seq, is_syn, data = found
        if name not in streams and len(streams) >= MOST_STREAMS:
            continue
        ready = streams.setdefault(name, _Stream()).take(seq, is_syn, data)
        if ready:
            yield TcpSegment(name, time_ns, ready)
    for name, stream in streams.items():
        while left := stream.skip_gap():
            yield TcpSegment(name, time_ns, left)


def _pcap(file: BinaryIO, order: str, unit_ns: int) -> Iterator[_Packet]:
    header = file.read(20)
    if len(header) < 20:
        raise PcapError("the capture ends inside its header")
    link_type = struct.unpack(f"{order}16xI", header)[0] & 0xFFFF
    while len(head := file.read(16)) == 16:
        seconds, fraction, length, _original = struct.unpack(f"{order}4I", head)
        if length > MOST_PACKET_BYTES:
            raise PcapError(f"expected a packet of up to {MOST_PACKET_BYTES} bytes, got {length}")
        time_ns = seconds * 1_000_000_000 + fraction * unit_ns
        yield _Packet(link_type, time_ns, file.read(length))


def _pcapng(file: BinaryIO) -> Iterator[_Packet]:
    order, interfaces = "<", list[tuple[int, int]]()
    kind_bytes = PCAPNG
    while len(kind_bytes) == 4:
        size_bytes = file.read(4)
        if kind_bytes == PCAPNG:
            magic = file.read(4)
            order = "<" if magic == b"\x4d\x3c\x2b\x1a" else ">"
            interfaces, already = [], 12
        else:
            already = 8
        if len(size_bytes) < 4:
            return
        (size,) = struct.unpack(f"{order}I", size_bytes)
        if not already + 4 <= size <= MOST_PACKET_BYTES + 1024:
            raise PcapError(f"expected a block of up to {MOST_PACKET_BYTES} bytes, got {size}")
        body = file.read(size - already)[:-4]
        (kind,) = struct.unpack(f"{order}I", kind_bytes)
        if kind == 1 and len(body) >= 2:
            link_type = struct.unpack_from(f"{order}H", body)[0]
            interfaces.append((link_type, _units_per_s(body[8:], order)))
        elif kind == 6 and len(body) >= 20:
            interface, high, low, length = struct.unpack_from(f"{order}4I", body)
            if interface < len(interfaces):
                link_type, units_per_s = interfaces[interface]
                time_ns = (high << 32 | low) * 1_000_000_000 // units_per_s
                yield _Packet(link_type, time_ns, body[20 : 20 + length])
        kind_bytes = file.read(4)


def _units_per_s(options: bytes, order: str) -> int:
    """Return the unit of an interface's times, by its option 9; microseconds without it."""
    at = 0
    while at + 4 <= len(options):
        code, length = struct.unpack_from(f"{order}HH", options, at)
        if code == 9 and length == 1 and at + 4 < len(options):
            exponent = options[at + 4]
            return int(2 ** (exponent & 127) if exponent & 128 else 10 ** min(exponent, 18))
        at += 4 + (length + 3) // 4 * 4
    return 1_000_000


def _tcp(packet: _Packet) -> tuple[str, int, bool, bytes] | None:
    """Return a TCP packet's stream, sequence number, whether it opens it, and its bytes."""
    try:
        ip = _ip(packet.link_type, packet.data)
        if ip is None:
            return None
        source, target, tcp = ip
        from_port, to_port, seq, _ack, offset, flags = struct.unpack_from(">HHIIBB", tcp)
    except (struct.error, IndexError, ValueError):
        return None
    data = tcp[(offset >> 4) * 4 :]
    return f"{source}:{from_port} > {target}:{to_port}", seq, bool(flags & _SYN), data


def _ip(link_type: int, data: bytes) -> tuple[str, str, bytes] | None:
    """Return a packet's addresses and its TCP part; None for anything else."""
    if link_type == ETHERNET:
        at = 12
        while (ether := struct.unpack_from(">H", data, at)[0]) in _VLAN:
            at += 4
        data = data[at + 2 :]
        if ether not in (_IPV4, _IPV6):
            return None
    elif link_type in (SLL, SLL2, NULL):
        data = data[{SLL: 16, SLL2: 20, NULL: 4}[link_type] :]
    elif link_type not in RAW:
        return None
    if data[0] >> 4 == 4 and data[9] == _TCP:
        length, header = struct.unpack_from(">H", data, 2)[0], (data[0] & 15) * 4
        # A length of 0: the network card was to fill it in.
        whole = data[: length or len(data)]
        return str(ip_address(data[12:16])), str(ip_address(data[16:20])), whole[header:]
    if data[0] >> 4 == 6 and data[6] == _TCP:
        length = struct.unpack_from(">H", data, 4)[0]
        source, target = ip_address(data[8:24]), ip_address(data[24:40])
        return f"[{source}]", f"[{target}]", data[40 : 40 + length]
    return None
