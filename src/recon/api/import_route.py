"""The route that reads a file with shapes, of a station and of the page for a new site."""

from collections.abc import Callable
from typing import Annotated, Protocol

from fastapi import FastAPI, Query, Request

from recon.api import schema


class Importing(Protocol):
    """What reads files with shapes."""

    async def import_features(self, name: str, data: bytes) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        ...


def add_import(app: FastAPI, importing: Callable[[], Importing]) -> None:
    """Add the route that reads a file."""

    @app.post("/api/site/import")
    async def import_file(
        request: Request, name: Annotated[str, Query(max_length=200)]
    ) -> schema.ImportedView:
        """Read polygons and points of a KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON file.

        The body is the file. Nothing is saved.
        """
        return await importing().import_features(name, await request.body())
