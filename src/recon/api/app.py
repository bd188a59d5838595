"""What is common to the HTTP applications: errors, headers, roles, the console's files."""

from pathlib import Path
from typing import Any

from fastapi import Depends, FastAPI, Request, WebSocket
from fastapi.exceptions import RequestValidationError, WebSocketRequestValidationError
from fastapi.responses import HTMLResponse, JSONResponse
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException as AnyHTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from recon.api.console_files import ConsoleFiles
from recon.api.permissions import require_listed_role
from recon.api.security import POLICY_VIOLATION, refuse_stream

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


def new_app(title: str, version: str, openapi_url: str | None = "/openapi.json") -> FastAPI:
    """Return an application without routes that checks the role of each request."""
    return FastAPI(
        title=title,
        version=version,
        openapi_url=openapi_url,
        docs_url=None,
        redoc_url=None,
        dependencies=[Depends(require_listed_role)],
    )


def add_console(app: FastAPI, console: Path | None) -> None:
    """Add the pages of the built console; without them, one that describes how to build it."""
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
