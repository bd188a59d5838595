"""A station's address, parsed from what the user types or pastes."""

import string
from dataclasses import dataclass, field
from urllib.parse import SplitResult, urlsplit

from recon.client.errors import AddressError

TOKEN_MARK = "token="
TOKEN_LETTERS = frozenset(string.ascii_letters + string.digits + "-._~")
_STREAM_SCHEMES = {"http": "ws", "https": "wss"}


@dataclass(frozen=True, slots=True)
class Address:
    """A station's base URLs, without a trailing slash, and its token."""

    http: str
    stream: str
    token: str | None = field(default=None, repr=False)

    @property
    def headers(self) -> dict[str, str]:
        """Authorization headers for HTTP and WebSocket."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}


def parse_address(url: str, token: str | None = None) -> Address:
    """Return the address of a station; raises `AddressError`.

    Accepts the address a station prints at start, with `#token=...` at its end; the `token`
    argument takes precedence.
    """
    parts = _split(url)
    if token is None and parts.fragment.startswith(TOKEN_MARK):
        token = parts.fragment.removeprefix(TOKEN_MARK)
    if token is not None and (not token or not TOKEN_LETTERS.issuperset(token)):
        # Without the token itself: error texts are printed and logged.
        raise AddressError("token: expected letters, digits and -._~ only")
    place = parts.netloc
    stream = f"{_STREAM_SCHEMES[parts.scheme]}://{place}/api/stream"
    return Address(f"{parts.scheme}://{place}", stream, token)


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
