"""Asks an application directly, without a socket."""

import asyncio
from dataclasses import dataclass, field
from typing import Any

import httpx
from starlette.types import ASGIApp, Message

BASE = "http://127.0.0.1:8080"


@dataclass(frozen=True)
class Client:
    """HTTP requests one at a time, and one WebSocket handshake."""

    app: ASGIApp

    def get(self, path: str, **more: Any) -> httpx.Response:
        return self.ask("GET", path, **more)

    def post(self, path: str, **more: Any) -> httpx.Response:
        return self.ask("POST", path, **more)

    def ask(self, method: str, path: str, **more: Any) -> httpx.Response:
        async def asked() -> httpx.Response:
            transport = httpx.ASGITransport(self.app)
            async with httpx.AsyncClient(transport=transport, base_url=BASE) as client:
                return await client.request(method, path, **more)

        return asyncio.run(asked())

    def open_stream(
        self, path: str, *, protocols: tuple[str, ...] = (), origin: str | None = None
    ) -> "Opened":
        """Open a WebSocket, take its first message if there is one, and go."""
        headers = [(b"host", b"127.0.0.1:8080")]
        if protocols:
            headers.append((b"sec-websocket-protocol", ", ".join(protocols).encode()))
        if origin is not None:
            headers.append((b"origin", origin.encode()))
        scope = {
            "type": "websocket",
            "asgi": {"version": "3.0"},
            "scheme": "ws",
            "path": path,
            "raw_path": path.encode(),
            "query_string": b"",
            "headers": headers,
            "client": ("127.0.0.1", 5),
            "server": ("127.0.0.1", 8080),
            "subprotocols": list(protocols),
        }
        return asyncio.run(_open(self.app, scope))


@dataclass
class Opened:
    """The messages that a server sent to a WebSocket."""

    sent: list[Message] = field(default_factory=list)

    @property
    def is_served(self) -> bool:
        return any(message["type"] == "websocket.send" for message in self.sent)

    @property
    def subprotocol(self) -> str | None:
        return next(m["subprotocol"] for m in self.sent if m["type"] == "websocket.accept")

    @property
    def close_code(self) -> int | None:
        return next((m["code"] for m in self.sent if m["type"] == "websocket.close"), None)

    @property
    def close_reason(self) -> str:
        return next((m["reason"] for m in self.sent if m["type"] == "websocket.close"), "")

    @property
    def first_text(self) -> str:
        return str(next(m["text"] for m in self.sent if m["type"] == "websocket.send"))


async def _open(app: ASGIApp, scope: dict[str, Any]) -> Opened:
    opened = Opened()
    has_text = asyncio.Event()
    arriving = iter([{"type": "websocket.connect"}])

    async def receive() -> Message:
        for message in arriving:
            return message
        await has_text.wait()
        return {"type": "websocket.disconnect", "code": 1000}

    async def send(message: Message) -> None:
        opened.sent.append(message)
        if message["type"] == "websocket.send":
            has_text.set()

    async with asyncio.timeout(120.0):
        await app(scope, receive, send)
    return opened
