"""The HTTP application: routes, the stream, the console's files."""

from pathlib import Path
from typing import Annotated, Any

from fastapi import Depends, FastAPI, Query, Request, WebSocket
from fastapi.exceptions import RequestValidationError, WebSocketRequestValidationError
from fastapi.responses import HTMLResponse, JSONResponse
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException as AnyHTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from recon.api import schema
from recon.api.access_routes import add_access_routes
from recon.api.addresses import SharedAddress
from recon.api.console_files import ConsoleFiles
from recon.api.flight_routes import FlightArchive, NoFlights, add_flight_routes
from recon.api.map_routes import MapFolder, NoMaps, add_map_routes
from recon.api.order_routes import add_order_routes
from recon.api.pairing_routes import add_pairing_routes
from recon.api.permissions import require_listed_role
from recon.api.picture_routes import add_picture_routes
from recon.api.port import StationPort, TimelineSubject
from recon.api.replay_routes import Replaying, add_replay_routes
from recon.api.responses import PROBLEMS, found
from recon.api.security import POLICY_VIOLATION, refuse_stream
from recon.api.site_routes import add_site_routes
from recon.api.streams import MAX_ENTRIES, AuditStream, StateStream
from recon.api.survey_routes import add_survey_routes
from recon.api.zone_routes import add_zone_routes

CONSOLE_MISSING = """<!doctype html><title>Recon</title><p>The console is not built.
Run <code>make web</code> in the project's folder, then start the station again.
The API is described at <a href="/openapi.json">/openapi.json</a>."""

SECURITY_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; img-src 'self' blob: data:; worker-src 'self' blob:; "
        "style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; "
        # The guard's port, for an all stop that the station does not answer.
        "connect-src 'self' blob: http://127.0.0.1:*"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


def create_app(
    port: StationPort,
    console: Path | None,
    version: str,
    shared: SharedAddress | None = None,
    flights: FlightArchive | None = None,
    replay: Replaying | None = None,
    maps: MapFolder | None = None,
) -> FastAPI:
    """Return the application around a station, to be put behind an `AccessCheck`.

    `console` is the folder with the built console; without one a page describes how to build it.
    `shared` is the address for other computers; `flights` are the station's records;
    `maps` its base maps; with a `replay` everything is refused that orders or changes anything.
    """
    app = FastAPI(
        title="Recon",
        version=version,
        docs_url=None,
        redoc_url=None,
        dependencies=[Depends(require_listed_role)],
    )
    add_access_routes(app, port, shared)
    _add_state_routes(app, port)
    _add_audit_and_streams(app, port)
    add_order_routes(app, port)
    add_pairing_routes(app, port)
    add_picture_routes(app, port)
    add_site_routes(app, port)
    add_survey_routes(app, port)
    add_flight_routes(app, flights or NoFlights())
    add_map_routes(app, maps or NoMaps())
    add_zone_routes(app, port)
    add_replay_routes(app, replay)
    _add_console(app, console)
    add_errors_and_headers(app)
    return app


def _add_state_routes(app: FastAPI, port: StationPort) -> None:
    @app.get("/api/state")
    async def state() -> schema.StationState:
        """Everything a console shows, as of now; the stream sends the same."""
        return port.state()

    @app.get("/api/vehicles")
    async def vehicles() -> list[schema.VehicleView]:
        """All vehicles with every value's age."""
        return port.state().vehicles

    @app.get("/api/vehicle", responses=PROBLEMS)
    async def vehicle(serial: str) -> schema.VehicleView:
        """One vehicle."""
        known = next((v for v in port.state().vehicles if v.serial == serial), None)
        return found(known, f"No vehicle with serial {serial!r}")

    @app.get("/api/commands")
    async def commands() -> list[schema.CommandView]:
        """The latest commands with their history, the newest first."""
        return port.state().commands

    @app.get("/api/commands/{command_id}", responses=PROBLEMS)
    async def command(command_id: int) -> schema.CommandView:
        """One command with its history."""
        known = next((c for c in port.state().commands if c.id == command_id), None)
        return found(known, f"Command {command_id} is not among the latest")


def _add_audit_and_streams(app: FastAPI, port: StationPort) -> None:
    stream, changes = StateStream(port), AuditStream(port)

    @app.get("/api/audit")
    async def audit(
        after: Annotated[int, Query(ge=0)] = 0,
        at_most: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
    ) -> schema.AuditPage:
        """Audit entries of this run after a number, the oldest first."""
        return port.audit(after, at_most)

    @app.get("/api/timeline")
    async def timeline(
        serial: Annotated[str | None, Query(max_length=64)] = None,
        about: TimelineSubject | None = None,
        before: Annotated[int | None, Query(ge=1)] = None,
        at_most: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
    ) -> schema.TimelineView:
        """What happened in this run, the newest first: of all vehicles or one, before a number.

        Positions and details are left out; the audit has them.
        """
        return port.timeline(serial, about, before, at_most)

    @app.websocket("/api/audit/stream")
    async def audit_stream(socket: WebSocket, after: Annotated[int, Query(ge=0)] = 0) -> None:
        await changes.serve(socket, after)

    @app.websocket("/api/stream")
    async def state_stream(socket: WebSocket) -> None:
        await stream.serve(socket)

    @app.websocket("/{path:path}")
    async def no_stream(socket: WebSocket, path: str) -> None:
        sentence = "No such stream; available: /api/stream, /api/audit/stream"
        await refuse_stream(socket, POLICY_VIOLATION, sentence)


def _add_console(app: FastAPI, console: Path | None) -> None:
    if console is not None and (console / "index.html").is_file():
        app.mount("/", ConsoleFiles(directory=console, html=True), name="console")
        return

    @app.get("/", include_in_schema=False)
    async def missing() -> HTMLResponse:
        return HTMLResponse(CONSOLE_MISSING)


def add_errors_and_headers(app: FastAPI) -> None:
    """Errors as one sentence, and headers that block foreign content."""

    @app.exception_handler(RequestValidationError)
    async def invalid(_request: Request, problem: RequestValidationError) -> JSONResponse:
        return JSONResponse({"error": _sentence(problem.errors()[0])}, status_code=422)

    @app.exception_handler(WebSocketRequestValidationError)
    async def invalid_stream(socket: WebSocket, problem: WebSocketRequestValidationError) -> None:
        await refuse_stream(socket, POLICY_VIOLATION, _sentence(problem.errors()[0]))

    @app.exception_handler(AnyHTTPException)
    async def refused(_request: Request, problem: AnyHTTPException) -> JSONResponse:
        return JSONResponse({"error": str(problem.detail)}, status_code=problem.status_code)

    app.add_middleware(_ResponseHeaders)


class _ResponseHeaders:
    """Adds the headers to every answer.

    Plain ASGI: Starlette's own class for functions as middleware runs each request in tasks of its
    own, and every switch between tasks of a busy event loop delays an all stop.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in SECURITY_HEADERS.items():
                    headers.setdefault(name, value)
                if scope["path"].startswith("/api/"):
                    headers.setdefault("Cache-Control", "no-store")
            await send(message)

        await self._app(scope, receive, send_with_headers)


def _sentence(fault: dict[str, Any]) -> str:
    """Return what is wrong with a request: where, and why."""
    place = ".".join(str(part) for part in fault["loc"] if part not in ("body", "query"))
    return f"{place or 'body'}: {fault['msg']}"
