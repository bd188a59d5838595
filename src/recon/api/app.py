"""The HTTP application: routes, the stream, the console's files."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Annotated, Literal

from fastapi import FastAPI, HTTPException, Query, Request, Response, WebSocket
from fastapi import Path as InPath
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, JSONResponse
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException as AnyHTTPException

from recon.api import pictures, schema
from recon.api.answering import PNG, PROBLEMS, found, who
from recon.api.audit_stream import MOST_ON_A_PAGE, AuditStream
from recon.api.orders import to_body
from recon.api.port import StationPort
from recon.api.security import Access, Doorman
from recon.api.stream import StateStream
from recon.api.sun_routes import add_sun_routes
from recon.api.survey_routes import add_survey_routes
from recon.model.authority import AuthorityHolder

CONSOLE_MISSING = """<!doctype html><title>Recon</title><p>The console is not built.
Run <code>make web</code> in the project's folder, then start the station again.
The API is described at <a href="/openapi.json">/openapi.json</a>."""

SECURITY_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; img-src 'self' blob: data:; worker-src 'self' blob:; "
        "style-src 'self' 'unsafe-inline'; connect-src 'self' blob:; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


def create_app(port: StationPort, access: Access, console: Path | None, version: str) -> FastAPI:
    """Return the application around a station.

    `console` is the folder with the built console; without one a page says how to build it.
    """
    app = FastAPI(title="Recon", version=version, docs_url=None, redoc_url=None)
    _add_state_routes(app, port)
    _add_audit_and_streams(app, port)
    _add_order_routes(app, port)
    _add_hazard_routes(app, port)
    _add_readiness_routes(app, port)
    _add_picture_routes(app, port)
    add_sun_routes(app, port)
    add_survey_routes(app, port)
    _add_console(app, console)
    _add_manners(app)
    app.add_middleware(Doorman, access=access)
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

    @app.get("/api/vehicles/{serial}", responses=PROBLEMS)
    async def vehicle(serial: str) -> schema.VehicleView:
        """One vehicle."""
        known = next((v for v in port.state().vehicles if v.serial == serial), None)
        return found(known, f"no vehicle has the serial {serial!r}")

    @app.get("/api/commands")
    async def commands() -> list[schema.CommandView]:
        """The latest commands and their lives, the newest first."""
        return port.state().commands

    @app.get("/api/commands/{command_id}", responses=PROBLEMS)
    async def command(command_id: int) -> schema.CommandView:
        """One command and its life."""
        known = next((c for c in port.state().commands if c.id == command_id), None)
        return found(known, f"no command {command_id} is among the latest")


def _add_audit_and_streams(app: FastAPI, port: StationPort) -> None:
    stream, changes = StateStream(port), AuditStream(port)

    @app.get("/api/audit")
    async def audit(
        after: Annotated[int, Query(ge=0)] = 0,
        at_most: Annotated[int, Query(ge=1, le=MOST_ON_A_PAGE)] = MOST_ON_A_PAGE,
    ) -> schema.AuditPage:
        """Entries of this run's audit after a number, the oldest first."""
        return port.audit(after, at_most)

    @app.websocket("/api/audit/stream")
    async def audit_stream(socket: WebSocket, after: Annotated[int, Query(ge=0)] = 0) -> None:
        await changes.serve(socket, after)

    @app.websocket("/api/stream")
    async def state_stream(socket: WebSocket) -> None:
        await stream.serve(socket)

    @app.websocket("/{path:path}")
    async def no_stream(socket: WebSocket, path: str) -> None:
        await socket.close(1008, "the only stream is /api/stream")


def _add_order_routes(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/orders")
    async def order(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Give one order to each named vehicle; refusals are among the results."""
        return port.order(
            asked.serials,
            to_body(asked.order),
            takeoff=asked.takeoff,
            issued_by=who(request),
            owner=asked.owner,
        )

    @app.post("/api/orders/check")
    async def check(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Tell what the gate would say to an order now. Nothing is sent; each number is 0."""
        return port.check(
            asked.serials,
            to_body(asked.order),
            takeoff=asked.takeoff,
            issued_by=who(request),
            owner=asked.owner,
        )

    @app.post("/api/all-stop")
    async def all_stop(request: Request) -> schema.OrderResponse:
        """Hold everything that flies, identified or not. Never cuts motors."""
        return port.all_stop(who(request))

    @app.post("/api/fleet-return")
    async def fleet_return(
        asked: schema.FleetReturnRequest, request: Request
    ) -> schema.OrderResponse:
        """Call vehicles home as landing missions, each at a height of its own.

        Each result is the hold it begins with; `fleet_return` of the state tells the rest.
        """
        return port.fleet_return(asked.serials, who(request))


def _add_hazard_routes(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/vehicles/{serial}/hazard/dismiss", responses=PROBLEMS, status_code=204)
    async def dismiss_hazard(serial: str, request: Request) -> None:
        """Say that somebody knows where a vehicle is that is not heard: it is a hazard no more.

        A vehicle without a serial is named as its hazard area's `dismissed_as` says.
        """
        if not port.dismiss_hazard(serial, who(request)):
            raise HTTPException(
                404, f"No hazard area for {serial!r}: it is connected, landed or unknown"
            )

    @app.post("/api/separation-hold/{switch}", status_code=204)
    async def separation_hold(switch: Literal["on", "off"], request: Request) -> None:
        """Switch on or off that the watchdogs hold vehicles; off, an alarm says so all the time."""
        port.switch_separation_hold(switch == "on", who(request))

    @app.post("/api/alarms/{alarm_id}/acknowledge", responses=PROBLEMS, status_code=204)
    async def acknowledge(alarm_id: int, request: Request) -> None:
        """Mark an alarm as seen by a person; it stays until its cause ends."""
        if not port.acknowledge(alarm_id, who(request)):
            raise HTTPException(404, f"there is no alarm {alarm_id}")


def _add_readiness_routes(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/vehicles/{serial}/authority")
    async def authority(
        serial: str, asked: schema.AuthorityRequest, request: Request
    ) -> schema.WordResponse:
        """Take a vehicle over, or give it away: from now on only `holder` sets it in motion."""
        return port.take_authority(serial, AuthorityHolder(asked.holder), who(request))

    @app.get("/api/vehicles/{serial}/preflight", responses=PROBLEMS)
    async def preflight(serial: str) -> schema.PreflightView:
        """A vehicle's checklist, worked out now from what the station knows."""
        return found(port.preflight(serial), f"no vehicle has the serial {serial!r}")

    @app.post("/api/vehicles/{serial}/preflight/override")
    async def override_preflight(
        serial: str, asked: schema.PreflightOverrideRequest, request: Request
    ) -> schema.WordResponse:
        """Let a vehicle fly missions although its checklist is not passed; ends with its landing.

        The reason is kept in the audit, with who gave it.
        """
        return port.override_preflight(serial, asked.reason, who(request))


def _add_picture_routes(app: FastAPI, port: StationPort) -> None:
    serial_path = Annotated[str, InPath(max_length=2048)]
    jpeg: dict[int | str, dict[str, object]] = {200: {"content": {"image/jpeg": {}}}}
    tiff: dict[int | str, dict[str, object]] = {200: {"content": {"image/tiff": {}}}}

    @app.get("/api/vehicles/{serial}/frame.jpg", response_class=Response, responses=PROBLEMS | jpeg)
    async def frame(serial: serial_path) -> Response:
        """A vehicle's newest camera frame, as it came."""
        newest = found(port.frame(serial), f"{serial!r} has sent no frame")
        data = await asyncio.to_thread(pictures.frame_jpeg, newest)
        return Response(data, media_type="image/jpeg", headers={"X-Frame-Id": str(newest.id)})

    @app.get("/api/ground-image.png", response_class=Response, responses=PROBLEMS | PNG)
    async def ground_png() -> Response:
        """The newest ground image; its corners are in the state."""
        newest = found(port.ground_image(), "no frame has been laid on the ground yet")
        data = await asyncio.to_thread(pictures.ground_png, newest)
        headers = {"X-Frame-Id": str(newest.frame_id)}
        return Response(data, media_type="image/png", headers=headers)

    @app.get("/api/ground-image.tif", response_class=Response, responses=PROBLEMS | tiff)
    async def ground_tiff() -> Response:
        """The newest ground image as a GeoTIFF file."""
        newest = found(port.ground_image(), "no frame has been laid on the ground yet")
        data = await asyncio.to_thread(port.geotiff, newest)
        name = f'attachment; filename="recon-ground-{newest.frame_id}.tif"'
        return Response(data, media_type="image/tiff", headers={"Content-Disposition": name})


def _add_console(app: FastAPI, console: Path | None) -> None:
    if console is not None and (console / "index.html").is_file():
        app.mount("/", StaticFiles(directory=console, html=True), name="console")
        return

    @app.get("/", include_in_schema=False)
    async def missing() -> HTMLResponse:
        return HTMLResponse(CONSOLE_MISSING)


def _add_manners(app: FastAPI) -> None:
    """Errors as one sentence, and headers that keep foreign content out."""

    @app.exception_handler(RequestValidationError)
    async def invalid(_request: Request, problem: RequestValidationError) -> JSONResponse:
        first = problem.errors()[0]
        place = ".".join(str(part) for part in first["loc"] if part != "body")
        return JSONResponse({"error": f"{place or 'body'}: {first['msg']}"}, status_code=422)

    @app.exception_handler(AnyHTTPException)
    async def refused(_request: Request, problem: AnyHTTPException) -> JSONResponse:
        return JSONResponse({"error": str(problem.detail)}, status_code=problem.status_code)

    @app.middleware("http")
    async def add_headers(
        request: Request, call_next: Callable[[Request], Awaitable[Response]]
    ) -> Response:
        response = await call_next(request)
        for name, value in SECURITY_HEADERS.items():
            response.headers.setdefault(name, value)
        if request.url.path.startswith("/api/"):
            response.headers.setdefault("Cache-Control", "no-store")
        return response
