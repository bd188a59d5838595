"""Routes for base maps: list them, with what they cover of the site, and their tiles.

Names are looked up among the files of one folder; no path is made of what a request states.
"""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Annotated, Protocol

from fastapi import FastAPI, HTTPException, Query, Request
from fastapi import Path as InPath
from starlette.responses import Response

from recon.api import schema
from recon.api.responses import PROBLEMS, found

MapName = Annotated[str, InPath(min_length=1, max_length=255)]
Zoom = Annotated[int, InPath(ge=0, le=24)]
Place = Annotated[int, InPath(ge=0, lt=2**24)]
Version = Annotated[str | None, Query(max_length=64, description="the map's, as listed")]
FOR_EVER = "private, max-age=31536000, immutable"
ASK_AGAIN = "private, no-cache"
NO_MAPS = "The station has no folder for base maps"
NOT_MODIFIED = 304

IsGone = Callable[[], Awaitable[bool]]


class MapsBusyError(Exception):
    """Too many tiles are asked for at once; the text states what to do."""


class MapFileError(Exception):
    """A map cannot be read; the text is for a person."""


@dataclass(frozen=True, slots=True)
class TileRead:
    """A tile's picture, and the version of the file it is from."""

    media_type: str
    data: bytes
    version: str


class MapFolder(Protocol):
    """The base maps of a site."""

    async def maps(self) -> schema.BaseMapsView:
        """Return the maps with their coverage; takes seconds for a new file."""

    async def tile(
        self, name: str, zoom: int, col: int, row: int, is_gone: IsGone
    ) -> TileRead | None:
        """Return a tile; None where the map has none, or there is no such map.

        Nothing is read once `is_gone` finds that the request was given up: a console does that with
        what its map has left. Raises `MapsBusyError` and `MapFileError`.
        """

    def close(self) -> None:
        """End what reads the maps."""


class NoMaps:
    """A station without maps, for a reason."""

    def __init__(self, reason: str = NO_MAPS) -> None:
        """Take the sentence that is shown in their place."""
        self._reason = reason

    async def maps(self) -> schema.BaseMapsView:
        """Return none."""
        return schema.BaseMapsView(maps=[], note=self._reason)

    async def tile(
        self, name: str, zoom: int, col: int, row: int, is_gone: IsGone
    ) -> TileRead | None:
        """Return none."""
        return None

    def close(self) -> None:
        """Nothing is open."""


def add_map_routes(app: FastAPI, folder: MapFolder) -> None:
    """Add all routes of this module."""
    pictures: dict[int | str, dict[str, object]] = {
        200: {"content": {media: {} for media in ("image/png", "image/jpeg", "image/webp")}}
    }

    @app.get("/api/maps")
    async def maps() -> schema.BaseMapsView:
        """The base maps of the site's folder, with what each covers of the site."""
        return await folder.maps()

    @app.get("/api/maps/{name}/{zoom}/{col}/{row}", response_class=Response,
             responses=PROBLEMS | pictures)  # fmt: skip
    async def tile(
        name: MapName, zoom: Zoom, col: Place, row: Place, request: Request, v: Version = None
    ) -> Response:
        """A tile of a map in Web Mercator, rows from the north; 404 where the map has none."""
        try:
            read = await folder.tile(name, zoom, col, row, request.is_disconnected)
        except MapsBusyError as problem:
            raise HTTPException(503, str(problem)) from problem
        except MapFileError as problem:
            raise HTTPException(422, str(problem)) from problem
        tile = found(read, f"No tile {zoom}/{col}/{row} of a map {name!a}")
        headers = {
            "ETag": f'"{tile.version}"',
            "Cache-Control": FOR_EVER if v == tile.version else ASK_AGAIN,
        }
        if request.headers.get("if-none-match") == headers["ETag"]:
            return Response(status_code=NOT_MODIFIED, headers=headers)
        return Response(tile.data, media_type=tile.media_type, headers=headers)
