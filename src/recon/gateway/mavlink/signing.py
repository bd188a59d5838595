"""Signatures of MAVLink 2: every message is signed with one key, and none is taken twice.

A signature is a number of the link, a time in units of 10 us since 2015 and the first six bytes of
SHA-256 over the key and the message. It shows that the sender has the key and hides nothing. The
time of each stream (link number, system, component) must grow; a stream begins at most a minute
behind now. Times are remembered only of messages that were signed rightly: a stranger can neither
use up memory nor move a stream's time.
"""

import hmac
import re
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from recon.gateway.errors import GatewayError
from recon.gateway.mavlink.frames import SIGNATURE_BYTES, MavlinkFrame

BEGAN_UNIX_S = 1_420_070_400
UNITS_PER_S = 100_000
LATE_UNITS = 60 * UNITS_PER_S
KEY_BYTES = 32
OWN_LINK = 1
_TIME_BYTES, _DIGEST_BYTES = 6, 6
LONGEST_FILE_BYTES = 1024
_HEX_KEY = re.compile(r"[0-9a-fA-F]{64}")


@dataclass(slots=True)
class Signer:
    """Signs and checks messages with one key, for all peers together."""

    key: bytes
    _last_units: int = 0
    _streams: dict[tuple[int, int, int], int] = field(default_factory=dict)

    def signature(self, unsigned: bytes, unix_s: float) -> bytes:
        """Return the signature of a frame whose flag is set; its times grow with the clock.

        A receiver that joins later refuses a stream that is a minute behind.
        """
        self._last_units = max(self._last_units + 1, _units(unix_s))
        stamp = bytes((OWN_LINK,)) + self._last_units.to_bytes(_TIME_BYTES, "little")
        return stamp + self._digest(unsigned + stamp)

    def accepts(self, frame: MavlinkFrame, unix_s: float) -> bool:
        """Return whether a frame is signed with the key and newer than its stream."""
        if not frame.is_signed:
            return False
        data = frame.data
        if not hmac.compare_digest(self._digest(data[:-_DIGEST_BYTES]), data[-_DIGEST_BYTES:]):
            return False
        stream = (data[-SIGNATURE_BYTES], data[5], data[6])
        stamp = data[1 - SIGNATURE_BYTES : -_DIGEST_BYTES]
        units = int.from_bytes(stamp, "little")
        if units <= self._streams.get(stream, _units(unix_s) - LATE_UNITS):
            return False
        self._streams[stream] = units
        return True

    def _digest(self, data: bytes) -> bytes:
        return sha256(self.key + data).digest()[:_DIGEST_BYTES]


def _units(unix_s: float) -> int:
    return round((unix_s - BEGAN_UNIX_S) * UNITS_PER_S)


def read_key(path: Path) -> bytes:
    """Return the key in a file: 64 hexadecimal digits, or a passphrase as ground stations take it.

    Of a passphrase the key is its SHA-256. Raises `GatewayError`.
    """
    try:
        with path.open("rb") as file:
            text = file.read(LONGEST_FILE_BYTES + 1).decode("utf-8").strip()
    except (OSError, UnicodeDecodeError) as problem:
        raise GatewayError(f"cannot read the signing key in {path}: {problem}") from problem
    if not text or len(text) > LONGEST_FILE_BYTES:
        raise GatewayError(
            f"{path}: expected a signing key of 64 hexadecimal digits, or a passphrase of 1 to "
            f"{LONGEST_FILE_BYTES} bytes"
        )
    return bytes.fromhex(text) if _HEX_KEY.fullmatch(text) else sha256(text.encode()).digest()
