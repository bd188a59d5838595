"""Routes for recorded flights: list them, read figures, download files.

Names are looked up among the files of one folder; no path is made of what a request states.
"""

from collections.abc import Awaitable
from pathlib import Path
from typing import Annotated, Protocol, TypeVar

from fastapi import FastAPI, HTTPException
from fastapi import Path as InPath
from starlette.responses import FileResponse

from recon.api import schema
from recon.api.responses import PROBLEMS, found

Made = TypeVar("Made")

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$"
FlightName = Annotated[str, InPath(pattern=NAME)]
MEDIA_TYPES = {
    "tracks.gpx": "application/gpx+xml",
    "tracks.geojson": "application/geo+json",
    "tracks.csv": "text/csv; charset=utf-8",
    "surveys.kml": "application/vnd.google-earth.kml+xml",
    "sun.tif": "image/tiff",
    "coverage.png": "image/png",
    "report.html": "text/html; charset=utf-8",
}
PAGE_POLICY = "sandbox; default-src 'none'; img-src data:; style-src 'unsafe-inline'"
"""A page made of a record runs nothing, whatever the record holds."""


class FlightBusyError(Exception):
    """Too many files are being made; the text states what to do."""


class FlightFileError(Exception):
    """A file cannot be made of a record; the text is for a person."""


class FlightArchive(Protocol):
    """The flight records of a station."""

    def flights(self) -> list[schema.FlightView]:
        """Return the records, the newest first."""

    def record(self, name: str) -> Path | None:
        """Return a record's file; None for an unknown name."""

    async def figures(self, name: str) -> schema.FlightFiguresView | None:
        """Return a flight's figures; None if there is no such record.

        Raises `FlightBusyError` and `FlightFileError`.
        """

    async def file(self, name: str, file: schema.FlightFileName) -> Path | None:
        """Return a file made of a record; None if there is no such record. Raises as `figures`."""


class NoFlights:
    """A station without records."""

    def flights(self) -> list[schema.FlightView]:
        """Return none."""
        return []

    def record(self, name: str) -> Path | None:
        """Return none."""
        return None

    async def figures(self, name: str) -> schema.FlightFiguresView | None:
        """Return none."""
        return None

    async def file(self, name: str, file: schema.FlightFileName) -> Path | None:
        """Return none."""
        return None


def add_flight_routes(app: FastAPI, archive: FlightArchive) -> None:
    """Add all routes of this module."""
    files: dict[int | str, dict[str, object]] = {
        200: {"content": {media.partition(";")[0]: {} for media in MEDIA_TYPES.values()}}
    }
    mcap: dict[int | str, dict[str, object]] = {200: {"content": {"application/octet-stream": {}}}}

    @app.get("/api/flights")
    def flights() -> list[schema.FlightView]:
        """The flight records of the station's folder, the newest first."""
        return archive.flights()

    @app.get("/api/flights/{name}", responses=PROBLEMS)
    async def figures(name: FlightName) -> schema.FlightFiguresView:
        """A flight's figures, of its record alone. Takes seconds for a long flight."""
        return found(await _made(archive.figures(name)), _unknown(name))

    @app.get("/api/flights/{name}/record.mcap", response_class=FileResponse,
             responses=PROBLEMS | mcap)  # fmt: skip
    def record(name: FlightName) -> FileResponse:
        """A flight record as it is; this run's when the run has ended."""
        path = found(archive.record(name), _unknown(name))
        if any(each.is_recording for each in archive.flights() if each.name == name):
            raise HTTPException(409, f"{name} is being recorded: download it after the run")
        return FileResponse(path, media_type="application/octet-stream", filename=f"{name}.mcap")

    @app.get("/api/flights/{name}/files/{file}", response_class=FileResponse,
             responses=PROBLEMS | files)  # fmt: skip
    async def file(name: FlightName, file: schema.FlightFileName) -> FileResponse:
        """A file made of a flight record: tracks, surveys, the sun by cell, the report."""
        path = found(await _made(archive.file(name, file)), _unknown(name))
        is_page = file == "report.html"
        return FileResponse(
            path,
            media_type=MEDIA_TYPES[file],
            filename=f"{name}-{file}",
            content_disposition_type="inline" if is_page else "attachment",
            headers={"Content-Security-Policy": PAGE_POLICY} if is_page else None,
        )


def _unknown(name: str) -> str:
    return f"No flight record {name!r} in the station's folder"


async def _made(making: Awaitable[Made]) -> Made:
    try:
        return await making
    except FlightBusyError as problem:
        raise HTTPException(503, str(problem)) from problem
    except FlightFileError as problem:
        raise HTTPException(422, str(problem)) from problem
