"""Messages to bytes: one sequence for each vehicle, signed if there is a key."""

from collections import defaultdict
from collections.abc import Iterable
from typing import Any

from recon.gateway.mavlink.dialect import COMPONENT, mavlink
from recon.gateway.mavlink.frames import SIGNED
from recon.gateway.mavlink.signing import Signer


class Encoder:
    """Encodes the messages of all vehicles."""

    def __init__(self, signer: Signer | None = None) -> None:
        self._signer = signer
        self._numbered: dict[int, Any] = defaultdict(lambda: mavlink.MAVLink(None))

    def encode(self, system_id: int, messages: Iterable[Any], unix_s: float) -> list[bytes]:
        """Return the frames of a vehicle's messages, in order."""
        numbered = self._numbered[system_id]
        numbered.srcSystem, numbered.srcComponent = system_id, COMPONENT
        frames: list[bytes] = []
        for message in messages:
            # Signed here and not by pymavlink, whose time does not follow the clock.
            frame = message.pack(numbered)
            frames.append(frame if self._signer is None else self._signed(message, frame, unix_s))
            numbered.seq = (numbered.seq + 1) % 256
        return frames

    def _signed(self, message: Any, frame: bytes, unix_s: float) -> bytes:
        assert self._signer is not None
        unsigned = frame[:2] + bytes((SIGNED,)) + frame[3:-2]
        checksum: int = mavlink.x25crc(unsigned[1:] + bytes((message.crc_extra,))).crc
        unsigned += checksum.to_bytes(2, "little")
        return unsigned + self._signer.signature(unsigned, unix_s)
