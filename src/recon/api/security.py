"""Access to the API: the right host name, no foreign web page, and a token if one is set.

A web page open in the operator's browser can send requests to loopback. So requests whose Origin is
another site's, or whose Host is not one of ours (DNS rebinding), are refused before anything else.
"""

import hmac
from dataclasses import dataclass
from hashlib import sha256
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.model.person import THIS_COMPUTER, Person, Role

PROTOCOL = "recon.v1"
TOKEN_PROTOCOL_PREFIX = "recon.token."
MAX_BODY_BYTES = 1024 * 1024
"""The longest mission takes 20 KiB; a body is held in memory."""

POLICY_VIOLATION = 1008
TRY_AGAIN_LATER = 1013
"""Close codes of refused streams (RFC 6455)."""
MAX_REASON_BYTES = 123
"""Of a close frame."""

LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})

LOCAL_PERSON = Person("local-operator", Role.ADMIN, THIS_COMPUTER)
_PERSON = "recon.person"


@dataclass(frozen=True, slots=True)
class Access:
    """Which requests are accepted. Only the token's SHA-256 is kept."""

    host_names: frozenset[str] = LOOPBACK_NAMES
    token_sha256: bytes | None = None
    local: Person = LOCAL_PERSON
    """The person of every request; requests over loopback need no login."""

    @classmethod
    def make(cls, bound_host: str, token: str | None, local: Person = LOCAL_PERSON) -> "Access":
        """Return the access rules for an address; with a token any host name is accepted."""
        names = LOOPBACK_NAMES | {bound_host}
        return cls(names, None if token is None else sha256(token.encode()).digest(), local)

    def is_token(self, token: str | None) -> bool:
        """Return whether a token is right; none is needed when none is set."""
        if self.token_sha256 is None:
            return True
        given = sha256((token or "").encode()).digest()
        return hmac.compare_digest(given, self.token_sha256)


class AccessCheck:
    """ASGI middleware that applies `Access` to HTTP and WebSocket alike."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self.app = app
        self.access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it with one sentence."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        status, sentence = self._refusal(scope)
        if sentence is None:
            await self.app({**scope, _PERSON: self.access.local}, receive, send)
        elif scope["type"] == "websocket":
            await refuse_stream(WebSocket(scope, receive, send), POLICY_VIOLATION, sentence)
        else:
            await JSONResponse({"error": sentence}, status_code=status)(scope, receive, send)

    def _refusal(self, scope: Scope) -> tuple[int, str | None]:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._is_our_host(host):
            return 400, f"host name {host!r} is not this station's"
        origin = headers.get("origin")
        if origin is not None and _place_of(origin) != host:
            return 403, f"requests from web pages of {origin} are refused"
        if scope["path"].startswith("/api/") and not self.access.is_token(_token(headers)):
            return (
                401,
                "token missing or wrong: open the address that the station printed at its start",
            )
        return _body_refusal(headers)

    def _is_our_host(self, host: str) -> bool:
        if self.access.token_sha256 is not None:
            return True
        return _name_of(host) in self.access.host_names


def person_of(connection: HTTPConnection) -> Person:
    """Return the authenticated person of a request or stream that `AccessCheck` let in."""
    person = connection.scope[_PERSON]
    assert isinstance(person, Person)
    return person


async def accept_stream(socket: WebSocket) -> None:
    """Accept a WebSocket with the station's subprotocol, if it was offered."""
    offered = socket.scope.get("subprotocols", [])
    await socket.accept(subprotocol=PROTOCOL if PROTOCOL in offered else None)


async def refuse_stream(socket: WebSocket, code: int, sentence: str) -> None:
    """Refuse a WebSocket with a code and a sentence.

    It is accepted first: of a refused handshake a browser shows neither.
    """
    reason = sentence.encode()[:MAX_REASON_BYTES].decode(errors="ignore")
    try:
        await accept_stream(socket)
        await socket.close(code, reason)
    except (WebSocketDisconnect, RuntimeError):
        return


def _body_refusal(headers: Headers) -> tuple[int, str | None]:
    """Refuse a body that is too long or of unknown length."""
    if "transfer-encoding" in headers:
        return 411, "a body needs a Content-Length"
    length = headers.get("content-length", "0")
    if not length.isdecimal() or int(length) > MAX_BODY_BYTES:
        return 413, f"body must be up to {MAX_BODY_BYTES} bytes; got {length[:20]}"
    return 200, None


def _place_of(origin: str) -> str | None:
    """Return host and port of an Origin header; None when it is malformed."""
    try:
        return urlsplit(origin).netloc or None
    except ValueError:
        return None


def _name_of(host: str) -> str | None:
    """Return the name or address in a Host header, without its port; None when it is malformed."""
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None


def _token(headers: Headers) -> str | None:
    """Return the token of an Authorization header, or of a WebSocket's subprotocols."""
    scheme, _, token = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer":
        return token.strip()
    for offered in headers.get("sec-websocket-protocol", "").split(","):
        if offered.strip().startswith(TOKEN_PROTOCOL_PREFIX):
            return offered.strip()[len(TOKEN_PROTOCOL_PREFIX) :]
    return None
