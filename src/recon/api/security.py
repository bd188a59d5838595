"""Access to the API: the right host name, no foreign web page, and the person of each request.

A web page open in the operator's browser can send requests to loopback. So requests whose Origin is
another site's, or whose Host is not one of ours (DNS rebinding), are refused before anything else.
Over loopback a request needs no login, and its person is the user of this computer; from other
computers each request carries a token. A token that is given is checked everywhere.
"""

from dataclasses import dataclass, field
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from recon.api.login import NO_TOKEN, Login, RefusedRequest
from recon.model.person import THIS_COMPUTER, Person, Role

PROTOCOL = "recon.v1"
TOKEN_PROTOCOL_PREFIX = "recon.token."
MAX_BODY_BYTES = 1024 * 1024
"""The longest mission takes 20 KiB; a body is held in memory."""
LARGER_BODIES = {"/api/site/import": 16 * 1024 * 1024}
"""A file from a GIS has more attributes than shapes."""

POLICY_VIOLATION = 1008
TRY_AGAIN_LATER = 1013
"""Close codes of refused streams (RFC 6455)."""
LOGIN_NEEDED = 4401
"""Close code (private use) of a stream without a right token, or whose token ended."""
MAX_REASON_BYTES = 123
"""Longest reason of a close frame."""

LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})

LOCAL_PERSON = Person("local-operator", Role.ADMIN, THIS_COMPUTER)
_PERSON = "recon.person"


@dataclass(frozen=True, slots=True)
class Access:
    """Which requests are accepted at one listening address."""

    login: Login = field(default_factory=Login)
    local: Person | None = LOCAL_PERSON
    """The person of requests without a token; None where each needs one."""
    host_names: frozenset[str] | None = LOOPBACK_NAMES
    """The names in a Host header; None accepts any, for a foreign page has no token."""

    @classmethod
    def loopback(cls, login: Login, local: Person, bound_host: str) -> "Access":
        """Return the rules of a loopback address."""
        return cls(login, local, LOOPBACK_NAMES | {bound_host})

    @classmethod
    def network(cls, login: Login) -> "Access":
        """Return the rules of an address that other computers reach."""
        return cls(login, None, None)


class AccessCheck:
    """ASGI middleware that applies `Access` to HTTP and WebSocket alike."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self.app = app
        self.access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its person, or refuse it with one sentence."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refused = self._foreign(headers)
        if refused is not None:
            await _refuse(refused, scope, receive, send)
            return
        if not scope["path"].startswith("/api/"):
            await self._pass_on(None, scope, receive, send, headers)
            return
        admitted = self._admitted(headers, _address_of(scope))
        if isinstance(admitted, RefusedRequest):
            await _refuse(admitted, scope, receive, send)
        else:
            await self._pass_on(admitted, scope, receive, send, headers)

    async def _pass_on(
        self,
        person: Person | None,
        scope: Scope,
        receive: Receive,
        send: Send,
        headers: Headers,
    ) -> None:
        refused = _body_refusal(headers, LARGER_BODIES.get(scope["path"], MAX_BODY_BYTES))
        if refused is not None:
            await _refuse(refused, scope, receive, send)
            return
        token = _token(headers)
        if person is not None and token is not None and scope["type"] == "websocket":
            send = self._ends_with_login(person, token, send)
        await self.app({**scope, _PERSON: person}, receive, send)

    def _ends_with_login(self, person: Person, token: str, send: Send) -> Send:
        """Return `send` that closes a stream once its token is no longer the person's."""

        async def send_while_known(message: Message) -> None:
            if message["type"] == "websocket.send" and not self.access.login.knows(person, token):
                reason = "logged out: the user was removed or changed, or its token renewed"
                await send({"type": "websocket.close", "code": LOGIN_NEEDED, "reason": reason})
                raise WebSocketDisconnect(LOGIN_NEEDED)
            await send(message)

        return send_while_known

    def _foreign(self, headers: Headers) -> RefusedRequest | None:
        host = headers.get("host", "")
        names = self.access.host_names
        if names is not None and _name_of(host) not in names:
            return RefusedRequest(400, f"host name {host!r} is not this station's")
        origin = headers.get("origin")
        if origin is not None and _place_of(origin) != host:
            return RefusedRequest(403, f"requests from web pages of {origin} are refused")
        return None

    def _admitted(self, headers: Headers, address: str) -> Person | RefusedRequest:
        token = _token(headers)
        if token is None:
            return self.access.local or NO_TOKEN
        return self.access.login.person(token, address)


async def _refuse(refused: RefusedRequest, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        code = LOGIN_NEEDED if refused.is_about_login else POLICY_VIOLATION
        await refuse_stream(WebSocket(scope, receive, send), code, refused.sentence)
        return
    response = JSONResponse({"error": refused.sentence}, status_code=refused.status)
    if refused.retry_after_s is not None:
        response.headers["Retry-After"] = str(refused.retry_after_s)
        # The next try pays for another handshake.
        response.headers["Connection"] = "close"
    await response(scope, receive, send)


def _address_of(scope: Scope) -> str:
    client = scope.get("client")
    return "unknown address" if client is None else str(client[0])


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


def _body_refusal(headers: Headers, most: int) -> RefusedRequest | None:
    """Refuse a body that is too long or of unknown length."""
    if "transfer-encoding" in headers:
        return RefusedRequest(411, "a body needs a Content-Length")
    length = headers.get("content-length", "0")
    if not length.isdecimal() or int(length) > most:
        return RefusedRequest(413, f"body must be up to {most} bytes; got {length[:20]}")
    return None


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
        return token.strip() or None
    for offered in headers.get("sec-websocket-protocol", "").split(","):
        if offered.strip().startswith(TOKEN_PROTOCOL_PREFIX):
            return offered.strip()[len(TOKEN_PROTOCOL_PREFIX) :] or None
    return None
