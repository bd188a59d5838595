"""A replay's routes, and the one place that refuses everything else in it.

`ReplayOnly` lets requests pass that read, and the transport. What orders or changes anything is
refused before any route sees it; streams only send.
"""

from typing import Protocol

from fastapi import FastAPI
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from recon.api import schema
from recon.api.responses import PROBLEMS, found

TRANSPORT = "/api/replay"
NO_ORDERS = "This is a replay: no orders are possible"
NO_REPLAY = "This station is live: nothing is replayed"
READING = frozenset({"GET", "HEAD"})
CONFLICT = 409


class Replaying(Protocol):
    """A replay as the API sees it."""

    def marks(self) -> schema.ReplayMarksView:
        """Return the alarms and orders of the record, as far as it was read."""

    async def change(self, asked: schema.ReplayTransport) -> schema.ReplayView:
        """Play, pause, change the speed or seek; return when the state is that of the moment."""


class ReplayOnly:
    """ASGI middleware that refuses every request to order or change anything."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it with one sentence."""
        is_request = scope["type"] == "http" and scope["method"] not in READING
        if is_request and scope["path"] != TRANSPORT:
            refused = JSONResponse({"error": NO_ORDERS}, status_code=CONFLICT)
            await refused(scope, receive, send)
            return
        await self.app(scope, receive, send)


def add_replay_routes(app: FastAPI, replay: Replaying | None) -> None:
    """Add all routes of this module; a live station refuses them."""

    @app.get("/api/replay/marks", responses=PROBLEMS)
    async def marks() -> schema.ReplayMarksView:
        """The alarms and orders of the record that is replayed."""
        return found(replay, NO_REPLAY).marks()

    @app.post(TRANSPORT, responses=PROBLEMS)
    async def transport(asked: schema.ReplayTransport) -> schema.ReplayView:
        """Play, pause, change the speed or seek; everything else is refused in a replay."""
        return await found(replay, NO_REPLAY).change(asked)

    if replay is not None:
        app.add_middleware(ReplayOnly)
