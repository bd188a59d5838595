"""A station's address, parsed from what the user types or pastes."""

import re
import string
from dataclasses import dataclass, field
from urllib.parse import SplitResult, parse_qs, urlsplit

from recon.client.errors import AddressError

TOKEN_LETTERS = frozenset(string.ascii_letters + string.digits + "-._~")
_FINGERPRINT = re.compile(r"[0-9a-f]{64}")
_STREAM_SCHEMES = {"http": "ws", "https": "wss"}


@dataclass(frozen=True, slots=True)
class Address:
    """A station's base URLs, without a trailing slash, and its token."""

    http: str
    stream: str
    token: str | None = field(default=None, repr=False)
    fingerprint: str | None = None
    """SHA-256 of the station's certificate in 64 lower-case digits; None: not pinned."""

    @property
    def is_secure(self) -> bool:
        """Return whether connections use TLS."""
        return self.http.startswith("https:")

    @property
    def headers(self) -> dict[str, str]:
        """Authorization headers for HTTP and WebSocket."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}


def parse_address(url: str, token: str | None = None, fingerprint: str | None = None) -> Address:
    """Return the address of a station; raises `AddressError`.

    Accepts the addresses that a station and `recon user` print, with `#token=...` and
    `fingerprint=...` at the end; the arguments take precedence.
    """
    parts = _split(url)
    named = parse_qs(parts.fragment, keep_blank_values=True)
    token = token if token is not None else named.get("token", [None])[0]
    fingerprint = fingerprint or named.get("fingerprint", [None])[0]
    if token is not None and (not token or not TOKEN_LETTERS.issuperset(token)):
        # Without the token itself: error texts are printed and logged.
        raise AddressError("token: expected letters, digits and -._~ only")
    place = parts.netloc
    stream = f"{_STREAM_SCHEMES[parts.scheme]}://{place}/api/stream"
    return Address(f"{parts.scheme}://{place}", stream, token, _digits(fingerprint))


def _digits(fingerprint: str | None) -> str | None:
    if not fingerprint:
        return None
    digits = fingerprint.replace(":", "").lower()
    if _FINGERPRINT.fullmatch(digits) is None:
        raise AddressError(
            "fingerprint: expected the 64 hexadecimal digits that the station prints as "
            f"certificate SHA-256, got {fingerprint[:100]!r}"
        )
    return digits


def _split(url: str) -> SplitResult:
    try:
        parts = urlsplit(url)
        is_good = (
            parts.scheme in _STREAM_SCHEMES
            and bool(parts.hostname)
            and parts.port != 0
            and "@" not in parts.netloc
            and parts.path in ("", "/")
            and not parts.query
            and parts.netloc.isascii()
            and parts.netloc.isprintable()
            and " " not in parts.netloc
        )
    except ValueError:
        is_good = False
    if not is_good:
        shown = url.partition("#")[0][:100]
        raise AddressError(f"expected an address like http://127.0.0.1:8080, got {shown!r}")
    return parts
