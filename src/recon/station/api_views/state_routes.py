"""Routes for the state, what happened, and the streams of both."""

from typing import Annotated

from fastapi import FastAPI, Query
from starlette.websockets import WebSocket

from recon.api import schema
from recon.api.responses import PROBLEMS, found
from recon.api.schema.orders import TimelineSubject
from recon.api.security import POLICY_VIOLATION, refuse_stream
from recon.api.streams import MAX_ENTRIES, AuditStream, StateStream
from recon.station.api_views.audit_service import audit_page
from recon.station.api_views.audit_service import timeline as timeline_of
from recon.station.api_views.service import Service


def add_state_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_state(app, service)
    _add_audit(app, service)
    _add_streams(app, service)


def _add_state(app: FastAPI, service: Service) -> None:
    @app.get("/api/state")
    async def state() -> schema.StationState:
        """Everything a console shows, as of now; the stream sends the same."""
        return service.state()

    @app.get("/api/vehicles")
    async def vehicles() -> list[schema.VehicleView]:
        """All vehicles with every value's age."""
        return service.state().vehicles

    @app.get("/api/vehicle", responses=PROBLEMS)
    async def vehicle(serial: str) -> schema.VehicleView:
        """One vehicle."""
        known = next((v for v in service.state().vehicles if v.serial == serial), None)
        return found(known, f"No vehicle with serial {serial!r}")

    @app.get("/api/commands")
    async def commands() -> list[schema.CommandView]:
        """The latest commands with their history, the newest first."""
        return service.state().commands

    @app.get("/api/commands/{command_id}", responses=PROBLEMS)
    async def command(command_id: int) -> schema.CommandView:
        """One command with its history."""
        known = next((c for c in service.state().commands if c.id == command_id), None)
        return found(known, f"Command {command_id} is not among the latest")


def _add_audit(app: FastAPI, service: Service) -> None:
    @app.get("/api/audit")
    async def audit(
        after: Annotated[int, Query(ge=0)] = 0,
        at_most: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
    ) -> schema.AuditPage:
        """Audit entries of this run after a number, the oldest first."""
        return audit_page(service.audit_log, after, at_most)

    @app.get("/api/timeline")
    async def timeline(
        serial: Annotated[str | None, Query(max_length=64)] = None,
        about: TimelineSubject | None = None,
        before: Annotated[int | None, Query(ge=1)] = None,
        at_most: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
    ) -> schema.TimelineView:
        """What happened in this run, the newest first: of all vehicles or one, before a number.

        Positions and details are excluded; the audit has them.
        """
        return timeline_of(service.audit_log, serial, about, before, at_most)


def _add_streams(app: FastAPI, service: Service) -> None:
    states = StateStream(service.state, service.driver.handle)
    changes = AuditStream(lambda after, at_most: audit_page(service.audit_log, after, at_most))

    @app.websocket("/api/audit/stream")
    async def audit_stream(socket: WebSocket, after: Annotated[int, Query(ge=0)] = 0) -> None:
        await changes.serve(socket, after)

    @app.websocket("/api/stream")
    async def state_stream(socket: WebSocket) -> None:
        await states.serve(socket)

    @app.websocket("/{path:path}")
    async def no_stream(socket: WebSocket, path: str) -> None:
        sentence = "No such stream; available: /api/stream, /api/audit/stream"
        await refuse_stream(socket, POLICY_VIOLATION, sentence)
