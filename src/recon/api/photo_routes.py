"""Routes for the photos of a flight: one job tags them, and its results are read."""

from collections.abc import Awaitable
from pathlib import Path
from typing import Protocol

from fastapi import FastAPI, HTTPException
from starlette.responses import FileResponse

from recon.api import schema
from recon.api.flight_routes import PAGE_POLICY
from recon.api.responses import PROBLEMS, found

MEDIA_TYPES = {
    "mosaic.png": "image/png",
    "report.html": "text/html; charset=utf-8",
    "tags.csv": "text/csv; charset=utf-8",
    "fly-again.geojson": "application/geo+json",
}
CONFLICT, UNPROCESSABLE = 409, 422


class PhotoBusyError(Exception):
    """A job is running; the text states what to do."""


class PhotoRequestError(Exception):
    """No job can begin as asked; the text is for a person."""


class PhotoWork(Protocol):
    """The station's one job on photos."""

    def view(self) -> schema.PhotosView:
        """Return how far the job is, or what the last one found."""

    def start(self, asked: schema.PhotoRequest) -> Awaitable[schema.PhotosView]:
        """Begin a job; raises `PhotoBusyError` and `PhotoRequestError`."""

    def cancel(self) -> schema.PhotosView:
        """End a running job; what it has found stays."""

    def file(self, name: schema.PhotoFileName) -> Path | None:
        """Return a file of the job; None before there is one."""


class NoPhotos:
    """A station without flight records."""

    def view(self) -> schema.PhotosView:
        """Return that there is no job."""
        return schema.PhotosView(job=None)

    async def start(self, _asked: schema.PhotoRequest) -> schema.PhotosView:
        """Refuse."""
        raise PhotoRequestError("This station records no flights: photos are tagged by a record")

    def cancel(self) -> schema.PhotosView:
        """Return that there is no job."""
        return self.view()

    def file(self, _name: schema.PhotoFileName) -> Path | None:
        """Return none."""
        return None


def add_photo_routes(app: FastAPI, work: PhotoWork) -> None:
    """Add all routes of this module."""
    files: dict[int | str, dict[str, object]] = {
        200: {"content": {media.partition(";")[0]: {} for media in MEDIA_TYPES.values()}}
    }

    @app.get("/api/photos")
    def photos() -> schema.PhotosView:
        """The job on photos: its steps, and what it has found so far."""
        return work.view()

    @app.post("/api/photos", responses=PROBLEMS)
    async def start(asked: schema.PhotoRequest) -> schema.PhotosView:
        """Tag the photos of a flight, and make mosaic and report; one job at a time."""
        try:
            return await work.start(asked)
        except PhotoBusyError as problem:
            raise HTTPException(CONFLICT, str(problem)) from problem
        except PhotoRequestError as problem:
            raise HTTPException(UNPROCESSABLE, str(problem)) from problem

    @app.delete("/api/photos")
    def cancel() -> schema.PhotosView:
        """End the running job. The same request continues from what it has made."""
        return work.cancel()

    @app.get("/api/photos/files/{file}", response_class=FileResponse, responses=PROBLEMS | files)
    def file(file: schema.PhotoFileName) -> FileResponse:
        """A file that the job has made."""
        path = found(work.file(file), f"{file} is not made yet: start the job on the photos")
        is_page = file == "report.html"
        return FileResponse(
            path,
            media_type=MEDIA_TYPES[file],
            filename=file,
            content_disposition_type="inline" if is_page else "attachment",
            headers={"Content-Security-Policy": PAGE_POLICY} if is_page else None,
        )
