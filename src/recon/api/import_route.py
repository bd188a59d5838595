"""The route that reads a file with shapes, of a station and of the page for a new site."""

from collections.abc import Callable
from typing import Annotated, Protocol

from fastapi import FastAPI, Query, Request

from recon.api import schema


class Importing(Protocol):
    """What reads files with shapes."""

    async def import_features(
        self, name: str, data: bytes, *, close_paths: bool
    ) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        ...


def add_import(app: FastAPI, importing: Callable[[], Importing]) -> None:
    """Add the route that reads a file."""

    @app.post("/api/site/import")
    async def import_file(
        request: Request,
        name: Annotated[str, Query(max_length=200)],
        close_paths: Annotated[bool, Query(description="take paths as areas")] = False,
    ) -> schema.ImportedView:
        """Read the polygons and points of a file with fields, of any format that is known.

        The body is the file. Nothing is saved.
        """
        data = await request.body()
        return await importing().import_features(name, data, close_paths=close_paths)
