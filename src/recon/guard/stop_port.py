"""The guard's port: a person's all stop when the station does not answer. HTTP on loopback.

    POST /all-stop   {"by": name}   -> {"held": [names], "refused": [names]}
    POST /give-way                  -> {"interventions": [...]}; only after the station's death

A web page of another origin than the console's is refused, as at the station's own port. One
request a connection; a connection that sends half of one is closed.
"""

import asyncio
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, Protocol, cast
from urllib.parse import urlsplit

import h11

from recon.guard.watch import Intervention
from recon.model.person import is_name

PATIENCE_S = 2.0
MOST_BYTES = 4096
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")
UNNAMED = "a person at the guard's port"


class Stops(Protocol):
    """What the port asks for."""

    def stop_all(self, by: str) -> Intervention:
        """Hold every vehicle that may fly."""
        ...

    def yield_to_next(self) -> tuple[Intervention, ...]:
        """End, for the next station."""
        ...

    @property
    def is_orphan(self) -> bool:
        """Whether the station has ended."""
        ...


class StopPort(asyncio.Protocol):
    """One connection."""

    def __init__(self, guard: Stops, console_origin: str) -> None:
        self._guard = guard
        self._console_origin = console_origin
        self._http = h11.Connection(h11.SERVER, max_incomplete_event_size=MOST_BYTES)
        self._request: h11.Request | None = None
        self._body = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for a request, not for long."""
        self._transport = cast(asyncio.Transport, transport)
        self._timer = asyncio.get_running_loop().call_later(PATIENCE_S, self._transport.abort)

    def connection_lost(self, exc: Exception | None) -> None:
        """The request was answered, or the client has gone."""
        self._timer.cancel()

    def data_received(self, data: bytes) -> None:
        """Read one request and answer it."""
        try:
            self._http.receive_data(data)
            while True:
                event = self._http.next_event()
                if isinstance(event, h11.Request):
                    self._request = event
                elif isinstance(event, h11.Data):
                    self._body += event.data
                elif isinstance(event, h11.EndOfMessage):
                    self._reply(*self._answer())
                    return
                if len(self._body) > MOST_BYTES or not isinstance(event, h11.Request | h11.Data):
                    break
        except h11.RemoteProtocolError as problem:
            self._reply(400, {"error": f"expected an HTTP request; got {problem}"})
            return
        if len(self._body) > MOST_BYTES:
            self._transport.abort()

    def _answer(self) -> tuple[int, Mapping[str, Any]]:
        assert self._request is not None
        headers = {name: value.decode("latin-1") for name, value in self._request.headers}
        if _host_name(headers.get(b"host", "")) not in LOOPBACK_NAMES:
            return 400, {"error": "expected a loopback host name"}
        origin = headers.get(b"origin")
        if origin is not None and origin != self._console_origin:
            return 403, {"error": f"requests from web pages of {origin} are refused"}
        asked = self._request.method, self._request.target
        if asked == (b"OPTIONS", b"/all-stop"):
            return 200, {}
        if asked == (b"POST", b"/all-stop"):
            intervention = self._guard.stop_all(_name_in(self._body))
            return 200, {"held": intervention.names, "refused": intervention.refused}
        if asked == (b"POST", b"/give-way"):
            if not self._guard.is_orphan:
                return 409, {"error": "the station of this guard runs; stop that one first"}
            return 200, {
                "interventions": [
                    asdict(intervention) for intervention in self._guard.yield_to_next()
                ]
            }
        return 404, {"error": "expected POST /all-stop"}

    def _reply(self, status: int, answer: Mapping[str, Any]) -> None:
        body = json.dumps(answer).encode()
        headers = [
            ("content-type", "application/json"),
            ("content-length", str(len(body))),
            ("connection", "close"),
            ("access-control-allow-origin", self._console_origin),
            ("access-control-allow-headers", "content-type"),
        ]
        for event in (
            h11.Response(status_code=status, headers=headers),
            h11.Data(data=body),
            h11.EndOfMessage(),
        ):
            self._transport.write(self._http.send(event) or b"")
        self._transport.close()


def _host_name(host: str) -> str | None:
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None


def _name_in(body: bytes) -> str:
    """Return the person a request names, or that it names none: no stop fails for a name."""
    try:
        name = json.loads(body)["by"]
    except (ValueError, KeyError, TypeError):
        return UNNAMED
    return name if isinstance(name, str) and is_name(name) else UNNAMED
