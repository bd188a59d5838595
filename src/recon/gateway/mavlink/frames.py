"""MAVLink frames in bytes from the network, which may be anything.

Memory is bounded by one frame and one read. A length is believed only until its checksum fails;
then the search goes on at the next byte. Bytes that are no MAVLink at all end the connection after
`MAX_FAULTS`, before their search costs others time.
"""

from dataclasses import dataclass, field
from typing import Any

from recon.gateway.mavlink.dialect import mavlink

V1, V2 = 0xFE, 0xFD
_AROUND_V1, _AROUND_V2 = 8, 12
"""Bytes of a frame beside its payload: header and checksum."""
SIGNATURE_BYTES = 13
SIGNED = 0x01
MAX_FAULTS = 64
"""Frames with a wrong checksum in one read, before the rest is dropped."""


@dataclass(frozen=True, slots=True)
class MavlinkFrame:
    """One intact frame: its bytes as they came, and the message in it."""

    data: bytes
    message: Any

    @property
    def is_signed(self) -> bool:
        """Whether it bears a signature; that it is right is checked elsewhere."""
        return self.data[0] == V2 and bool(self.data[2] & SIGNED)


@dataclass(slots=True)
class FrameReader:
    """Finds the frames in one peer's bytes."""

    faults: int = 0
    """Wrong checksums in the newest read."""
    _kept: bytes = b""
    # Without a key and without a file: it only unpacks.
    _unpacking: Any = field(default_factory=lambda: mavlink.MAVLink(None))

    def read(self, data: bytes) -> list[MavlinkFrame]:
        """Return the frames that are complete with these bytes."""
        data, at, frames = self._kept + data, 0, list[MavlinkFrame]()
        self.faults = 0
        while (at := _next_marker(data, at)) < len(data):
            size = _size(data, at)
            if size is None or at + size > len(data):
                break
            frame = self._frame(data[at : at + size])
            if frame is not None:
                frames.append(frame)
            at += size if frame is not None else 1
            if self.faults > MAX_FAULTS:
                at = len(data)
        self._kept = data[at:]
        return frames

    def _frame(self, data: bytes) -> MavlinkFrame | None:
        if data[0] == V2 and data[2] & ~SIGNED:
            return None
        number = data[5] if data[0] == V1 else int.from_bytes(data[7:10], "little")
        if number not in mavlink.mavlink_map:
            return None
        try:
            return MavlinkFrame(data, self._unpacking.decode(bytearray(data)))
        except (mavlink.MAVError, ValueError, TypeError, OverflowError):
            self.faults += 1
            return None


def _next_marker(data: bytes, at: int) -> int:
    """Return where the next frame may begin; the end if nowhere."""
    while at < len(data) and data[at] not in (V1, V2):
        at += 1
    return at


def _size(data: bytes, at: int) -> int | None:
    """Return the bytes of the frame that would begin here; None while that is not known."""
    if at + 3 > len(data):
        return None
    if data[at] == V1:
        return data[at + 1] + _AROUND_V1
    return data[at + 1] + _AROUND_V2 + (SIGNATURE_BYTES if data[at + 2] & SIGNED else 0)
